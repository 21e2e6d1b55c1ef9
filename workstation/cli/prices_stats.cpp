// bess-train prices stats: statistics of a price file.
#include <fmt/core.h>

#include <memory>

#include "shared/host/file.h"
#include "workstation/cli/commands.h"
#include "workstation/data/market/feed/market_files.h"
#include "workstation/data/market/series/checked_prices.h"
#include "workstation/data/market/series/plausibility.h"
#include "workstation/data/market/statistics/market_statistics.h"
#include "workstation/runs/chain/price_input.h"

namespace bess {
namespace {

struct PricesStatsArguments {
  std::string file;
  bool json = false;
};

MarketStatistics describe_minute_file(std::string_view text, const std::string& name) {
  const MinuteSeries series = parse_minute_csv(text, name);
  judge_minutes(series, {name, text}, AcceptedFindings::all());
  return statistics_of_minutes(series);
}

MarketStatistics describe_download(std::string_view text, const std::string& name) {
  MarketRows rows = parse_market_text(text, name);
  const bool minutes = !rows.minutes.empty();
  JoinReport report;
  const std::vector<QuarterHour> quarter_hours = sorted_quarter_hours(rows.quarter_hours, report);
  const JoinedMarket market = join_market(std::move(rows), name);
  judge_market(market.series, {}, {name}, AcceptedFindings::all());
  return minutes ? statistics_of_minutes(market.series)
                 : statistics_of_quarter_hours(quarter_hours);
}

/// Statistics as of settled quarter-hours; findings are warnings.
MarketStatistics describe_day_ahead_file(std::string_view text, const std::string& name) {
  const DayAheadSeries series = parse_day_ahead_csv(text, name);
  judge(implausible_day_ahead(series), AcceptedFindings::all(), {{name, text}});
  std::vector<QuarterHour> quarter_hours;
  for (std::size_t q = 0; q < series.size(); ++q) {
    if (!is_published(series.eur_per_mwh[q])) continue;
    quarter_hours.push_back({.utc_s = series.utc_s(q), .price_eur_per_mwh = series.eur_per_mwh[q]});
  }
  return statistics_of_quarter_hours(quarter_hours);
}

void run_prices_stats(const PricesStatsArguments& options) {
  const std::string text = read_file(options.file);
  const bool is_day_ahead = is_day_ahead_csv(text);
  const MarketStatistics statistics = is_minute_csv(text) ? describe_minute_file(text, options.file)
                                      : is_day_ahead ? describe_day_ahead_file(text, options.file)
                                                     : describe_download(text, options.file);
  if (options.json) {
    fmt::print("{}\n", format_statistics_json(statistics));
  } else {
    fmt::print("{}", format_statistics_text(statistics,
                                            is_day_ahead ? "day-ahead price" : "settled price"));
  }
}

}  // namespace

void add_prices_stats(ProgramCommand& prices) {
  auto options = std::make_shared<PricesStatsArguments>();
  ProgramCommand command = prices.subcommand(
      "stats", "statistics of a price file: quartiles, tails, autocorrelation, gaps");
  command
      .option("file", options->file,
              "minute file, day-ahead file, or a download of Elia (CSV, JSON); plain or .gz")
      .value_name("FILE")
      .required();
  command.flag("--json", options->json, "one JSON object");
  command.footer(
      "Sign changes of the system imbalance need a quarter-hour download, convergence by minute "
      "needs minute prices.\n"
      "Examples:\n"
      "  bess-train prices stats prices.csv.gz\n"
      "  bess-train prices stats ods047.csv --json");
  command.runs([options] { run_prices_stats(*options); });
}

}  // namespace bess
