#include "edge/command_line.h"

#include <charconv>
#include <cstdio>
#include <string_view>

#include "edge/policy.h"

namespace bess {
namespace {

constexpr const char* kHelp =
    R"(bess-edge: drives a battery on the imbalance price, every two minutes

  bess-edge --config FILE [--dry-run] [--check] [--cycles N]

  --config FILE  settings in TOML; edge/bess-edge.toml documents every key
  --check        check settings, map and student, print the registers that would be written, read the
                 battery and the newest price once, write nothing, exit
  --dry-run      run, but write nothing, whatever the file says (control = false does the same)
  --cycles N     stop cleanly after N cycles
  --help         this text
  --version      version and the student that is built in

Nothing is written to the battery unless the file says control = true.
SIGTERM or Ctrl-C: 0 W is ordered, the battery is released, exit 0.
Exit codes: 0 done   1 settings, battery or price server are bad   2 the command line is bad

  bess-edge --config /etc/bess/edge.toml --check
  bess-edge --config /etc/bess/edge.toml --dry-run --cycles 5
)";

CommandLineResult usage_error(std::string_view message, std::string_view argument) {
  std::fprintf(stderr, "bess-edge: %.*s%.*s (see bess-edge --help)\n",
               static_cast<int>(message.size()), message.data(), static_cast<int>(argument.size()),
               argument.data());
  return CommandLineResult::kExitUsage;
}

bool parse_count(std::string_view text, std::int64_t& value) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc{} && end == text.data() + text.size() && value > 0;
}

}  // namespace

CommandLineResult parse_command_line(int argc, char** argv, CommandLine& command_line) {
  for (int i = 1; i < argc; ++i) {
    const std::string_view option = argv[i];
    const bool has_value = i + 1 < argc;
    if (option == "--help" || option == "-h") {
      std::fputs(kHelp, stdout);
      return CommandLineResult::kExitOk;
    }
    if (option == "--version") {
      std::printf("bess-edge %s, student %08x: %s\n", BESS_VERSION, student_hash(),
                  student_provenance());
      return CommandLineResult::kExitOk;
    }
    if (option == "--dry-run") {
      command_line.dry_run = true;
    } else if (option == "--check") {
      command_line.check = true;
    } else if (option == "--config" && has_value) {
      command_line.config_path = argv[++i];
    } else if (option == "--cycles" && has_value) {
      if (!parse_count(argv[++i], command_line.cycles)) {
        return usage_error("--cycles needs a whole number above 0, not ", argv[i]);
      }
    } else if (option == "--config" || option == "--cycles") {
      return usage_error("a value is missing after ", option);
    } else {
      return usage_error("unknown option ", option);
    }
  }
  if (command_line.config_path.empty()) return usage_error("--config FILE is required", "");
  return CommandLineResult::kRun;
}

}  // namespace bess
