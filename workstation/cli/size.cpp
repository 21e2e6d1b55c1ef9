// bess-train size: earnings and payback by battery size and contract, before purchase.
#include <fmt/ranges.h>

#include <memory>

#include "shared/host/file.h"
#include "workstation/cli/commands.h"
#include "workstation/runs/chain/chain_steps.h"
#include "workstation/runs/chain/common_options.h"
#include "workstation/runs/chain/folder_lock.h"
#include "workstation/runs/chain/policy_factory.h"
#include "workstation/runs/chain/price_input.h"
#include "workstation/runs/run/run_record.h"
#include "workstation/runs/size/size_cell.h"

namespace bess {
namespace {

namespace fs = std::filesystem;

struct SizeArguments {
  CommonOptions common;
  PriceInput price_input;
  DayAheadInput day_ahead;
  std::vector<std::string> prices;
  std::string plan;
  std::string out;
  bool json = false;
};

/// Writes the configuration of the best cell; returns the command that trains its student.
std::string how_to_learn_it(const SizeArguments& options, const RunConfig& base,
                            const SizeCell& best) {
  const fs::path config = fs::path(options.out) / "best.toml";
  write_file(config,
             format_run_config(cell_config(base, best.power_w, best.capacity_wh, *best.contract)));
  const std::string all = (fs::path(options.out) / "prices.csv.gz").string();
  const bool is_one = options.prices.size() == 1;
  const std::string join = is_one ? std::string()
                                  : fmt::format("bess-train prices import {} --out {} && ",
                                                fmt::join(options.prices, " "), all);
  const std::string day_ahead =
      options.day_ahead.path.empty() ? "" : " --day-ahead " + options.day_ahead.path;
  return fmt::format("its student: {}bess-train run --prices {}{} --config {} --out {}", join,
                     is_one ? options.prices.front() : all, day_ahead, config.string(),
                     (fs::path(options.out) / "student").string());
}

void run_size(const SizeArguments& options) {
  const fs::path folder = options.out;
  require_distinct(named_files("--out", folder, {"size.csv", "size.html", "best.toml"}),
                   named_paths("--prices", options.prices,
                               {{"--plan", options.plan},
                                {"--config", options.common.config_path},
                                {"--day-ahead", options.day_ahead.path}}));
  const RunConfig base = options.common.resolve(options.day_ahead.context_unless_said());
  const SizePlan plan = read_size_plan(options.plan, base);
  require_policies({plan.policy});
  require_outlook({plan.policy}, options.day_ahead.path);
  const MinuteSeries series = options.price_input.read_joined(options.prices).series;
  MarketSteps market = market_of(series, base.market, options.prices.front());
  options.day_ahead.attach_to(market, series, options.price_input.accepted(), base.market);
  const Folds folds = make_folds(market, {plan.window_days});
  require_writable(folder / "size.csv");
  end_when_interrupted();
  const SizeCells weighed =
      evaluate_cells(plan, base, {market, folds, plan.policy, base.train.threads});
  const SizeReport report{
      plan, weighed,
      fmt::format("{} cells of {} classes, {} on prices {:08x}, {} months, each fitted on the {} "
                  "days before it",
                  weighed.cells.size(), weighed.classes.size(), plan.policy,
                  prices_checksum(series), folds.traded.size(), plan.window_days)};
  write_file(folder / "size.csv", size_csv(report));
  write_size_page(report, folder);
  const std::string student = how_to_learn_it(options, base, best_of(weighed.cells));
  if (options.json) {
    fmt::print("{}\n", size_json(report).line());
  } else {
    fmt::print("{}{}\n{}: size.html and size.csv\n", format_size_table(report), student,
               options.out);
  }
}

}  // namespace

void add_size_command(ProgramCommand& app) {
  auto options = std::make_shared<SizeArguments>();
  ProgramCommand command =
      app.subcommand("size", "compare battery sizes and contracts: earnings and payback");
  command.option("--prices", options->prices, "minute files or downloads; periods may be separate")
      .required();
  options->price_input.add(command);
  command.option("--plan", options->plan, "TOML file (shared/manual/guides/which_battery.md)")
      .required();
  command.option("--out", options->out, "folder for table and page").value_name("DIR").required();
  options->day_ahead.add(command);
  command.flag("--json", options->json, "one JSON object");
  options->common.add_all(command);
  command.footer(
      "Minimum plan: [size], power_kw = [5, 10], capacity_kwh = [10, 20].\n"
      "Examples:\n"
      "  bess-train size --prices 2024.csv.gz 2025.csv.gz --plan plan.toml --out sizes\n"
      "  bess-train size --prices 2024.csv.gz --day-ahead day_ahead.csv --plan outlook.toml --out "
      "sizes");
  command.runs([options] { run_size(*options); });
}

}  // namespace bess
