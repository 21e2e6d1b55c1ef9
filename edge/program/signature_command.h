// `bess-edge signature`: prints the signature of what this build decides, to compare machines,
// compilers and versions with each other.
#pragma once

namespace bess {

/// One line on stdout: the student's hash, what it decided, the signature. Exit code 0.
int run_signature_command();

}  // namespace bess
