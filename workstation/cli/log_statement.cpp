// bess-train log statement: earnings of a battery by day, to compare with the bill.
#include <fmt/format.h>

#include <memory>

#include "shared/host/file.h"
#include "workstation/cli/commands.h"
#include "workstation/runs/log/log_input.h"

namespace bess {
namespace {

struct StatementArguments {
  LogInput input;
  std::string output;
};

void run_statement(const StatementArguments& options) {
  options.input.require_not_read("--output", options.output);
  require_writable(options.output);
  const ReadLog read = options.input.read();
  write_file(options.output, statement_page(read.days, read.battery));
  QuarterHourMoney money;
  for (const LoggedDay& day : read.days) money.add(day.exchanged.money);
  fmt::print("{}: {} to {}, {:+.2f} EUR net of {:.2f} EUR\n", options.output,
             read.days.front().date, read.days.back().date, money.net_eur(), money.contract_eur);
}

}  // namespace

void add_log_statement(ProgramCommand& log) {
  auto options = std::make_shared<StatementArguments>();
  ProgramCommand command =
      log.subcommand("statement", "write a printable statement of energy and money by day");
  options->input.add(command, true);
  command.option("--output", options->output, "output file (HTML)").required();
  command.footer(
      "By quarter-hour, at the settled price where --settled has it, less [costs] and [battery]\n"
      "wear_eur_per_mwh of --config. The log must include the first control cycle after the last\n"
      "day.\n"
      "Examples:\n"
      "  bess-edge log --csv > log.csv              # on the controller\n"
      "  bess-train log statement log.csv --settled settled.csv --config house.toml \\\n"
      "    --from 2026-10-01 --to 2026-10-31 --output october.html");
  command.runs([options] { run_statement(*options); });
}

}  // namespace bess
