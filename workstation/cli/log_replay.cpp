// bess-train log replay: decisions of another student in the control cycles of a log.
#include "workstation/runs/log/log_replay.h"

#include <fmt/format.h>

#include <memory>
#include <optional>

#include "shared/host/user_error.h"
#include "workstation/cli/commands.h"
#include "workstation/runs/log/log_input.h"

namespace bess {
namespace {

struct ReplayArguments {
  LogInput input;
  std::string student;
  std::optional<int> limit_percent;
  bool json = false;
};

void run_replay(const ReplayArguments& options) {
  const ReadLog read = options.input.read();
  const LogReplay replay = replay_log(read.log, read.span, student_for_log(options.student).net);
  fmt::print("{}", options.json ? replay.json().line() + "\n" : replay.text());
  if (!options.limit_percent || replay.differing_percent() <= *options.limit_percent) return;
  fail("{:.2f} % of the decisions would change, more than --limit {}", replay.differing_percent(),
       *options.limit_percent);
}

}  // namespace

void add_log_replay(ProgramCommand& log) {
  auto options = std::make_shared<ReplayArguments>();
  ProgramCommand command = log.subcommand("replay", "replay the log with another student");
  options->input.add(command, false);
  command
      .option("--student", options->student,
              "student file, run folder, or compiled (the array in this program)")
      .required();
  command
      .option("--limit", options->limit_percent,
              "maximum share of changed decisions, %; above it exit code 1 (default: no limit)")
      .range(0, 100);
  command.flag("--json", options->json, "JSON: total, days and changed decisions");
  command.footer(
      "Check a new student with this before it controls a battery. Each control cycle that the\n"
      "student decided is decided again with the same price, state of charge and context; stops,\n"
      "limits, holds and rules of the guard are not replayed.\n"
      "Examples:\n"
      "  bess-edge log --csv > october.csv          # on the controller\n"
      "  bess-train log replay october.csv --student runs/new --limit 10");
  command.runs([options] { run_replay(*options); });
}

}  // namespace bess
