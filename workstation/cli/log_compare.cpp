// bess-train log compare: profit of other policies in the control cycles of a log.
#include <fmt/format.h>

#include <memory>

#include "shared/nn/student_net.h"
#include "workstation/base/answer.h"
#include "workstation/cli/commands.h"
#include "workstation/runs/log/log_comparison.h"

namespace bess {
namespace {

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

}  // namespace

void add_log_compare(ProgramCommand& log) {
  auto options = std::make_shared<CompareArguments>();
  ProgramCommand command =
      log.subcommand("compare", "compare the log with other policies in the same control cycles");
  options->input.add(command, true);
  command
      .option("--policy", options->policies,
              "rbc, rbc:LOW:HIGH, compiled, a student file or run folder (default: a rule at the "
              "quartiles of the compiled student's training prices, and compiled); foresight is "
              "always added")
      .value_name("POLICY");
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

}  // namespace bess
