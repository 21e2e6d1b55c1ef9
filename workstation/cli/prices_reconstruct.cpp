// bess-train prices reconstruct: simulated minute prices on real settled quarter-hours.
#include <fmt/core.h>

#include <memory>

#include "shared/host/file.h"
#include "shared/host/text.h"
#include "workstation/cli/commands.h"
#include "workstation/data/market/feed/market_files.h"
#include "workstation/data/market/model/simulated_market.h"
#include "workstation/data/market/series/gaps.h"
#include "workstation/runs/chain/price_input.h"

namespace bess {
namespace {

struct PricesReconstructArguments {
  PriceInput price_input;
  std::vector<std::string> files;
  std::uint64_t seed = 1;
  std::string out;
};

void run_prices_reconstruct(const PricesReconstructArguments& options) {
  require_distinct({{"--out", options.out}}, named_paths("--quarter-hours", options.files));
  require_writable(options.out);
  SettledQuarterHours settled = read_quarter_hour_files(options.files);
  std::vector<QuarterHour>& quarter_hours = settled.quarter_hours;
  judge_market(join_market({{}, quarter_hours}, options.files.front()).series,
               settled.report.findings, options.files, options.price_input.accepted());
  const std::size_t inferred = infer_missing_imbalances(quarter_hours);
  const std::string attribution = attribution_of(settled.sources);
  const MinuteSeries series = minutes_on_quarter_hours(quarter_hours, options.seed);
  write_minute_file(
      options.out, series,
      fmt::format("Settled prices: from {}\n{}\nIndicative prices: drawn, not real: "
                  "bess-train {} prices reconstruct --seed {}",
                  file_names(options.files), attribution, BESS_VERSION, options.seed));
  if (settled.minutes_unused > 0) {
    fmt::print("{} of the files not used: replaced by drawn ones\n",
               counted(settled.minutes_unused, "indicative price"));
  }
  if (inferred > 0) {
    fmt::print("{} without a system imbalance: its side was inferred from the price\n",
               counted(inferred, "quarter-hour"));
  }
  fmt::print("{}: minutes drawn on {}, seed {}\n{}{}{}\n", options.out,
             counted(quarter_hours.size(), "settled quarter-hour"), options.seed,
             describe_dual_priced(settled.report),
             describe_gaps("settled price", gaps_in(series.settled, series.start_utc_s, 60)),
             attribution);
}

}  // namespace

void add_prices_reconstruct(ProgramCommand& prices) {
  auto options = std::make_shared<PricesReconstructArguments>();
  ProgramCommand command =
      prices.subcommand("reconstruct", "reconstruct minute prices from settled quarter-hours");
  command
      .option("--quarter-hours", options->files,
              "settled quarter-hours: ods047 or ods134 (CSV or JSON), tidy CSV, ENTSO-E A85 "
              "(XML), or output of 'prices import'; plain or .gz")
      .value_name("FILE")
      .required();
  options->price_input.add(command);
  command.option("--seed", options->seed, "random seed").non_negative().with_default();
  command.option("--out", options->out, "minute file to write (.csv or .csv.gz)").required();
  command.footer(
      "For sources without a system imbalance (ENTSO-E A85, minute files) its sign is inferred\n"
      "from the price. ENTSO-E sends a ZIP archive: unzip it first.\n"
      "Examples:\n"
      "  bess-train prices reconstruct --quarter-hours A85_AT.xml --out austria.csv.gz\n"
      "  bess-train prices reconstruct --quarter-hours ods047.csv --seed 3 --out prices.csv.gz\n"
      "  bess-train prices reconstruct --quarter-hours imported.csv.gz --out drawn.csv.gz");
  command.runs([options] { run_prices_reconstruct(*options); });
}

}  // namespace bess
