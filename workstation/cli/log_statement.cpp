// bess-train log statement: what a battery earned in some days, to hold beside the bill.
#include <fmt/format.h>

#include <memory>

#include "shared/host/file.h"
#include "workstation/cli/commands.h"
#include "workstation/runs/log/log_input.h"
#include "workstation/runs/log/statement_page.h"

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
      log.subcommand("statement", "A page to print: money and energy by days, beside the bill");
  options->input.add(command, true);
  command.option("--output", options->output, "The page (HTML)").required();
  command.footer(
      "By quarter-hours, at the settled price where --settled has it, less what [costs] of "
      "--config\n"
      "takes and [battery] wear_eur_per_mwh. The log must hold the first cycle behind the last "
      "day,\n"
      "which tells the power of the last.\n"
      "Examples:\n"
      "  bess-edge log --csv > log.csv              # on the controller\n"
      "  bess-train log statement log.csv --settled settled.csv --config house.toml \\\n"
      "    --from 2026-10-01 --to 2026-10-31 --output october.html");
  command.runs([options] { run_statement(*options); });
}

}  // namespace bess
