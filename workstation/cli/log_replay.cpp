// bess-train log replay: what another student would have decided in the cycles of a log.
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
  fail("{:.2f} % of the decisions would be others, more than --limit {}",
       replay.differing_percent(), *options.limit_percent);
}

}  // namespace

void add_log_replay(ProgramCommand& log) {
  auto options = std::make_shared<ReplayArguments>();
  ProgramCommand command =
      log.subcommand("replay", "What another student would have decided in the same cycles");
  options->input.add(command, false);
  command
      .option("--student", options->student,
              "A student's file, a run's folder, or compiled (the array in this program)")
      .required();
  command
      .option("--limit", options->limit_percent,
              "Exit code 1 when more percent of the decisions would be others")
      .range(0, 100);
  command.flag("--json", options->json,
               "One JSON object: all days, each, and each decision that would be another one");
  command.footer(
      "Asked of a new student before it may drive. Each cycle in which the student was asked is\n"
      "decided again with the same price, state of charge and context; stops, limits, holds and\n"
      "rules of the guard are not replayed.\n"
      "Examples:\n"
      "  bess-edge log --csv > october.csv          # on the controller\n"
      "  bess-train log replay october.csv --student runs/new --limit 10");
  command.runs([options] { run_replay(*options); });
}

}  // namespace bess
