#include <cstdio>

#include "edge/app/commands/command.h"
#include "edge/app/program/startup.h"

namespace bess {
namespace {

constexpr const char* kFooter =
    R"(Student and guard replay two recorded days of prices in each month of a year, those of the
clock changes among them, in integers. The signature covers every order: builds with the same
student that print different ones do not decide the same. edge/generated/decision_signature.txt
holds the expected line.
Exit codes:
  0 done
  2 the command line is wrong)";

}  // namespace

void add_signature(EdgeCommand root) {
  EdgeCommand command = root.subcommand("signature", "one number for what this build decides");
  command.footer(kFooter);
  command.does_without_settings([](SettingsFile&) {
    std::puts(decision_signature_line().c_str());
    return 0;
  });
}

}  // namespace bess
