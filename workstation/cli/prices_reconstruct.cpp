// bess-train prices reconstruct: plausible minutes on real settled quarter-hours.
#include <fmt/format.h>

#include <algorithm>
#include <memory>

#include "workstation/cli/prices.h"
#include "workstation/io/user_error.h"
#include "workstation/market/gaps.h"
#include "workstation/market/market_files.h"
#include "workstation/market/quarter_hours_to_minutes.h"

namespace bess {
namespace {

struct Options {
  std::vector<std::string> files;
  std::uint64_t seed = 1;
  std::string out;
};

void run(const Options& options) {
  const std::vector<QuarterHour> quarter_hours = read_quarter_hour_files(options.files);
  if (std::none_of(quarter_hours.begin(), quarter_hours.end(),
                   [](const QuarterHour& row) { return is_published(row.system_imbalance_mw); })) {
    fail(
        "{}: no quarter-hour has a system imbalance, on which the minutes are drawn; use ods047 "
        "or ods134",
        options.files.front());
  }
  const MinuteSeries series = minutes_on_quarter_hours(quarter_hours, options.seed);
  write_minute_file(options.out, series,
                    fmt::format("Settled prices: Elia open data (CC BY 4.0), real\nIndicative "
                                "prices: drawn, not real: bess-train {} prices reconstruct --seed "
                                "{}",
                                BESS_VERSION, options.seed));
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
      ->add_option(
          "--quarter-hours", options->files,
          "Settled quarter-hours: ods047 or ods134 (CSV or JSON), or tidy CSV; plain or .gz")
      ->required();
  command->add_option("--seed", options->seed, "Same seed, same minutes")->capture_default_str();
  command->add_option("--out", options->out, "Minute file to write (.csv or .csv.gz)")->required();
  command->footer(
      "Example:\n"
      "  bess-train prices reconstruct --quarter-hours ods047.csv --seed 3 --out prices.csv.gz");
  command->callback([options] { run(*options); });
}

}  // namespace bess
