// bess-train prices simulate: simulated market, without a download.
#include <fmt/core.h>

#include <memory>

#include "shared/host/file.h"
#include "shared/host/minute_file.h"
#include "shared/host/text.h"
#include "shared/host/user_error.h"
#include "workstation/cli/commands.h"
#include "workstation/data/market/model/simulated_market.h"
#include "workstation/data/market/series/local_date.h"
#include "workstation/runs/chain/price_input.h"

namespace bess {
namespace {

struct PricesSimulateArguments {
  int days = 365;  // every month once
  std::uint64_t seed = 1;
  std::string start = "2023-01-01";
  std::string out;
  std::string day_ahead_out;
};

void run_prices_simulate(const PricesSimulateArguments& options) {
  const LocalDate start = parse_local_date(options.start, "--start");
  require_distinct({{"--out", options.out}, {"--day-ahead-out", options.day_ahead_out}}, {});
  require_writable(options.out);
  if (!options.day_ahead_out.empty()) require_writable(options.day_ahead_out);
  const UtcSpan period{local_midnight_utc_s(start),
                       local_midnight_utc_s(add_days(start, options.days))};
  const std::vector<QuarterHour> quarter_hours = simulate_quarter_hours(period, options.seed);
  const MinuteSeries series = minutes_on_quarter_hours(quarter_hours, options.seed);
  write_minute_file(
      options.out, series,
      fmt::format("{}: bess-train {} prices simulate --days {} --seed {} --start "
                  "{}\nParameters fitted to Elia open data (CC BY 4.0): ods047 2023-01-01 to "
                  "2023-05-23, ods045, ods161",
                  kSimulatedProvenance, BESS_VERSION, options.days, options.seed,
                  format_local_date(start)));
  if (!options.day_ahead_out.empty()) {
    write_day_ahead_file(options.day_ahead_out, simulate_day_ahead(quarter_hours, options.seed),
                         fmt::format("{}: day-ahead prices of bess-train {} prices simulate --days "
                                     "{} --seed {} --start {}",
                                     kSimulatedProvenance, BESS_VERSION, options.days, options.seed,
                                     format_local_date(start)));
  }
  fmt::print("{}: {} from {}, seed {}, {} minutes\n", options.out,
             counted(static_cast<std::size_t>(options.days), "simulated day"),
             format_local_date(start), options.seed, series.size());
}

}  // namespace

void add_prices_simulate(ProgramCommand& prices) {
  auto options = std::make_shared<PricesSimulateArguments>();
  ProgramCommand command = prices.subcommand(
      "simulate", "simulate a market with the statistics of Belgium in early 2023");
  command.option("--days", options->days, "local days").range(1, 7320).with_default();
  command.option("--seed", options->seed, "random seed").non_negative().with_default();
  command.option("--start", options->start, "first local day, YYYY-MM-DD").with_default();
  command.option("--out", options->out, "minute file to write (.csv or .csv.gz)").required();
  command.option("--day-ahead-out", options->day_ahead_out,
                 "output file for day-ahead prices of the same market, for sdp-outlook");
  command.footer(
      "Examples:\n"
      "  bess-train prices simulate --out market.csv.gz\n"
      "  bess-train prices simulate --days 30 --seed 7 --start 2024-03-15 --out spring.csv\n"
      "  bess-train prices simulate --out market.csv.gz --day-ahead-out day_ahead.csv.gz");
  command.runs([options] { run_prices_simulate(*options); });
}

}  // namespace bess
