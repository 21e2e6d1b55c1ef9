// `bess-edge signature`: prints the signature of what this build decides, to compare machines,
// compilers and versions with each other.
#pragma once

#include <string>

namespace bess {

/// The student's hash, what it decided, the signature. Sets the market's time zone.
std::string decision_signature_line();

/// That line on stdout. Exit code 0.
int run_signature_command();

}  // namespace bess
