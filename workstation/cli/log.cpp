// bess-train log: analysis of a controller's log.
#include <fmt/format.h>

#include <memory>
#include <optional>

#include "shared/host/file.h"
#include "shared/host/user_error.h"
#include "shared/nn/student_net.h"
#include "workstation/base/answer.h"
#include "workstation/cli/commands.h"
#include "workstation/runs/log/log_input.h"

namespace bess {
namespace {

// bess-train log compare: profit of other policies in the control cycles of a log.

struct CompareArguments {
  LogInput input;
  std::vector<std::string> policies;
  bool json = false;
};

/// Default policies: a rule at the quartiles of the compiled student's training prices, and it.
std::vector<std::string> usual_policies() {
  const StudentNet net = compiled_student().net;
  return {fmt::format("rbc:{}:{}", learnt_price_quartile(net, 1), learnt_price_quartile(net, 3)),
          "compiled"};
}

void print_json(const std::vector<NamedEvaluation>& all) {
  const auto rows = comparison_rows(all, &NamedEvaluation::carried_over);
  for (std::size_t i = 0; i < all.size(); ++i) {
    const NetEarnings paid = net_earnings_of(all[i].carried_over);
    Json json = answer("log_comparison");
    json.set("policy", all[i].name);
    json.set("paid_eur", Decimals{paid.paid_eur, 4});
    json.set("charge_eur", Decimals{paid.charge_eur, 4});
    add_figures(rows[i], json);
    fmt::print("{}\n", json.line());
  }
}

void run_compare(const CompareArguments& options) {
  const ReadLog read = options.input.read();
  const auto all =
      compare_log(read, options.policies.empty() ? usual_policies() : options.policies);
  if (options.json) return print_json(all);
  fmt::print("{} to {}\n{:<20} {:>10} {:>10} {:>10}\n", read.days.front().date,
             read.days.back().date, "EUR, whole battery", "paid", "charge", "together");
  for (const NamedEvaluation& one : all) {
    const auto [paid_eur, charge_eur] = net_earnings_of(one.carried_over);
    fmt::print("{:<20} {:>+10.2f} {:>+10.2f} {:>+10.2f}\n", one.name, paid_eur, charge_eur,
               paid_eur + charge_eur);
  }
  fmt::print("\n{}", format_comparison_table(all));
}

void add_log_compare(ProgramCommand& log) {
  auto options = std::make_shared<CompareArguments>();
  ProgramCommand command =
      log.subcommand("compare", "compare the log with other policies in the same control cycles");
  options->input.add(command, true);
  command.option(
      "--policy", options->policies,
      "rbc, rbc:LOW:HIGH, compiled, a student file or run folder (default: a rule at the "
      "quartiles of the compiled student's training prices, and compiled); foresight is "
      "always added");
  command.flag("--json", options->json, "JSON, one line per policy, this battery first");
  command.footer(
      "This battery is accounted as by bess-edge earned, less [costs] and wear. The others are\n"
      "accounted as by evaluate, from the same charge, on the controller's prices with their\n"
      "delay; they are idle where the log has no usable price.\n"
      "Examples:\n"
      "  bess-edge log --csv > october.csv          # on the controller\n"
      "  bess-train log compare october.csv --settled settled.csv --config house.toml\n"
      "  bess-train log compare october.csv --config house.toml --policy rbc:20:120 runs/new "
      "--json");
  command.runs([options] { run_compare(*options); });
}

// bess-train log replay: decisions of another student in the control cycles of a log.

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

// bess-train log statement: earnings of a battery by day, to compare with the bill.

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

}  // namespace

void add_log_commands(ProgramCommand& app) {
  ProgramCommand log =
      app.subcommand("log", "analyse a controller's log: compare, replay, statement");
  log.requires_subcommand();
  add_log_compare(log);
  add_log_replay(log);
  add_log_statement(log);
}

}  // namespace bess
