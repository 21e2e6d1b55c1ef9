#include <cstdio>

#include "edge/commands/command_list.h"
#include "edge/program/startup.h"

namespace bess {
namespace {

constexpr const char* kHelp =
    R"(bess-edge signature: one number for what this build decides

  bess-edge signature

Student and guard replay two recorded days of prices in each month of a year, those of the clock
changes among them, in integers. The signature is over every order: builds with the same student
that print different ones do not decide the same. edge/generated/decision_signature.txt holds the
expected line.
Exit codes: 0 done   2 the command line is bad
)";

struct NothingGiven {};

int print_signature(const NothingGiven&, SettingsFile&) {
  std::puts(decision_signature_line().c_str());
  return 0;
}

}  // namespace

const EdgeCommand kSignatureCommand = {.name = "signature",
                                       .usage = "signature",
                                       .does = "one number for what this build decides",
                                       .help = kHelp,
                                       .settings = EdgeCommand::Settings::kNone,
                                       .run = run_with<NothingGiven, print_signature>};

}  // namespace bess
