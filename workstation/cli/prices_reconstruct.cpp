// bess-train prices reconstruct: plausible minutes on real settled quarter-hours.
#include <fmt/format.h>

#include <filesystem>
#include <memory>

#include "workstation/cli/prices.h"
#include "workstation/market/gaps.h"
#include "workstation/market/market_files.h"
#include "workstation/market/quarter_hours_to_minutes.h"

namespace bess {
namespace {

namespace fs = std::filesystem;

struct Options {
  std::vector<std::string> files;
  std::uint64_t seed = 1;
  std::string out;
};

void run(const Options& options) {
  std::vector<QuarterHour> quarter_hours = read_quarter_hour_files(options.files);
  const std::size_t inferred = infer_missing_imbalances(quarter_hours);
  const MinuteSeries series = minutes_on_quarter_hours(quarter_hours, options.seed);
  write_minute_file(
      options.out, series,
      fmt::format("Settled prices: real, from {} (Elia: CC BY 4.0)\nIndicative "
                  "prices: drawn, not real: bess-train {} prices reconstruct --seed "
                  "{}",
                  fs::path(options.files.front()).filename().string(), BESS_VERSION, options.seed));
  if (inferred > 0) {
    fmt::print(
        "{} quarter-hours without a system imbalance: its side was inferred from the price\n",
        inferred);
  }
  fmt::print("{}: minutes drawn on {} settled quarter-hours, seed {}\n{}", options.out,
             quarter_hours.size(), options.seed,
             describe_gaps("settled price", gaps_in(series.settled, series.start_utc_s, 60)));
}

}  // namespace

void add_prices_reconstruct(CLI::App& prices) {
  auto options = std::make_shared<Options>();
  CLI::App* command = prices.add_subcommand(
      "reconstruct", "Draw minute prices that converge to real settled quarter-hours");
  command
      ->add_option("--quarter-hours", options->files,
                   "Settled quarter-hours: ods047 or ods134 (CSV or JSON), tidy CSV, or ENTSO-E "
                   "A85 (XML); plain or .gz")
      ->required();
  command->add_option("--seed", options->seed, "Same seed, same minutes")->capture_default_str();
  command->add_option("--out", options->out, "Minute file to write (.csv or .csv.gz)")->required();
  command->footer(
      "Sources without a system imbalance (ENTSO-E A85) get its side from the price.\n"
      "Examples:\n"
      "  bess-train prices reconstruct --quarter-hours A85_AT.xml --out austria.csv.gz\n"
      "  bess-train prices reconstruct --quarter-hours ods047.csv --seed 3 --out prices.csv.gz");
  command->callback([options] { run(*options); });
}

}  // namespace bess
