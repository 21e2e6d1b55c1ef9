// bess-train refresh: retraining of a run on the latest prices; adopts the candidate unless it is
// worse.
#include "workstation/runs/run/refresh.h"

#include <memory>

#include "workstation/cli/commands.h"

namespace bess {

void add_refresh_command(ProgramCommand& app) {
  auto options = std::make_shared<RefreshRequest>();
  ProgramCommand command = app.subcommand(
      "refresh", "retrain on the latest prices; writes a candidate run next to the run");
  command.option("--run", options->run, "run folder").required();
  command.flag("--adopt", options->adopt,
               "replace the run with the candidate unless it is significantly worse");
  command
      .option("--window-days", options->window_days,
              "training window, days; at least half must have prices")
      .range(30, 3650)
      .with_default();
  command.option("--prices", options->prices,
                 "minute files or downloads (default: download the latest prices)");
  options->price_input.add(command);
  options->day_ahead.add(command);
  command.option("--base-url", options->source, "API root of the imbalance prices").with_default();
  command.option("--day-ahead-base-url", options->day_ahead_source, "API root of day-ahead prices")
      .with_default();
  command.footer(
      "The latest 30 days evaluate the candidate; training uses the days before them. The\n"
      "candidate RUN.proposal is a complete run. Adopted, it becomes RUN, and the previous run\n"
      "RUN.before-DATE; rejected, it becomes RUN.refused-DATE. After an interruption, repeat the\n"
      "command to continue.\n"
      "Examples:\n"
      "  bess-train refresh --run runs/site\n"
      "  bess-train refresh --run runs/site --prices 2024.csv.gz 2025.csv.gz --adopt");
  command.runs([options] { refresh(*options); });
}

}  // namespace bess
