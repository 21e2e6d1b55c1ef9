#include <cstdio>

#include "edge/app/commands/command.h"
#include "edge/app/program/startup.h"

namespace bess {
namespace {

constexpr const char* kSignatureFooter =
    R"(Student and guard replay recorded prices in integers: two days of each month of a year, with
the clock changes. The signature covers every order. Two builds with the same student and different
signatures decide differently. Expected line: edge/generated/decision_signature.txt.
Exit codes:
  0 done
  2 command line error)";

}  // namespace

void add_signature(EdgeCommand root) {
  EdgeCommand command = root.subcommand("signature", "checksum of all decisions of this build");
  command.footer(kSignatureFooter);
  command.does_without_settings([](SettingsFile&) {
    std::puts(decision_signature_line().c_str());
    return 0;
  });
}

}  // namespace bess
