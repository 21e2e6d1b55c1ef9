// bess-train log compare: what other policies would have earned in the cycles of a log.
#include <fmt/format.h>

#include <memory>

#include "shared/nn/learnt_prices.h"
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

/// A rule by the quartiles of the prices that the compiled student learnt on, and that student.
std::vector<std::string> usual_policies() {
  const StudentNet net = compiled_student().net;
  return {fmt::format("rbc:{}:{}", learnt_price_quartile(net, 1), learnt_price_quartile(net, 3)),
          "compiled"};
}

void print_json(const std::vector<NamedEvaluation>& all) {
  const auto rows = comparison_rows(all, &NamedEvaluation::carried_over);
  for (std::size_t i = 0; i < all.size(); ++i) {
    const Paid paid = paid_of(all[i].carried_over);
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
    const auto [paid_eur, charge_eur] = paid_of(one.carried_over);
    fmt::print("{:<20} {:>+10.2f} {:>+10.2f} {:>+10.2f}\n", one.name, paid_eur, charge_eur,
               paid_eur + charge_eur);
  }
  fmt::print("\n{}", format_comparison_table(all));
}

}  // namespace

void add_log_compare(ProgramCommand& log) {
  auto options = std::make_shared<CompareArguments>();
  ProgramCommand command =
      log.subcommand("compare", "What other policies would have earned in the same cycles");
  options->input.add(command, true);
  command.option("--policy", options->policies,
                 "rbc, rbc:LOW:HIGH, compiled, a student's file or a run's folder (default: a rule "
                 "by the quartiles of the prices that the compiled student learnt on, compiled); "
                 "foresight always");
  command.flag("--json", options->json, "One JSON object a line and policy, this battery first");
  command.footer(
      "This battery is counted as bess-edge earned counts it, less [costs] and wear; the others "
      "as\n"
      "evaluate counts them, from the same charge on, on the price that the controller had, with\n"
      "its delay. Where the log has no price that can be decided on, they rest.\n"
      "Examples:\n"
      "  bess-edge log --csv > october.csv          # on the controller\n"
      "  bess-train log compare october.csv --settled settled.csv --config house.toml\n"
      "  bess-train log compare october.csv --config house.toml --policy rbc:20:120 runs/new "
      "--json");
  command.runs([options] { run_compare(*options); });
}

}  // namespace bess
