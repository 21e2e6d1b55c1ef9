// bess-train prices: sources of minute files.
#include <fmt/core.h>

#include <ctime>
#include <memory>

#include "shared/host/file.h"
#include "shared/host/minute_file.h"
#include "shared/host/text.h"
#include "shared/host/user_error.h"
#include "workstation/cli/commands.h"
#include "workstation/data/market/feed/elia_fetch.h"
#include "workstation/data/market/feed/market_files.h"
#include "workstation/data/market/model/simulated_market.h"
#include "workstation/data/market/series/local_date.h"
#include "workstation/data/market/series/plausibility.h"
#include "workstation/data/market/statistics/market_statistics.h"
#include "workstation/runs/chain/common_options.h"
#include "workstation/runs/chain/folder_lock.h"
#include "workstation/runs/chain/price_input.h"

namespace bess {
namespace {

// bess-train prices simulate: simulated market, without a download.

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

// bess-train prices reconstruct: simulated minute prices on real settled quarter-hours.

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

void add_prices_reconstruct(ProgramCommand& prices) {
  auto options = std::make_shared<PricesReconstructArguments>();
  ProgramCommand command =
      prices.subcommand("reconstruct", "reconstruct minute prices from settled quarter-hours");
  command
      .option("--quarter-hours", options->files,
              "settled quarter-hours: ods047 or ods134 (CSV or JSON), tidy CSV, ENTSO-E A85 "
              "(XML), or output of 'prices import'; plain or .gz")
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

// bess-train prices import: conversion of downloaded CSV, JSON and XML to one minute file.

struct PricesImportArguments {
  PriceInput price_input;
  std::vector<std::string> files;
  std::string out;
  bool day_ahead = false;
  CustomCsvFormat own;
};

void import_day_ahead(const PricesImportArguments& options) {
  std::vector<std::string> notes;
  std::vector<DayAheadRow> rows = rows_of_one_zone(options.files, notes);
  for (const std::string& note : notes) fmt::print(stderr, "note: {}\n", note);
  write_judged_day_ahead(join_day_ahead(std::move(rows), options.files.front()),
                         options.price_input.accepted(), options.files,
                         fmt::format("Day-ahead prices imported by bess-train {} from {}",
                                     BESS_VERSION, file_names(options.files)),
                         options.out);
}

void run_prices_import(const PricesImportArguments& options) {
  require_distinct({{"--out", options.out}}, named_paths("files", options.files));
  require_writable(options.out);
  if (options.day_ahead) return import_day_ahead(options);
  std::set<MarketSource> sources;
  const JoinedMarket market = options.price_input.read_joined(options.files, &sources, options.own);
  const std::string attribution = attribution_of(sources);
  const std::string description = describe_join(market);
  write_minute_file(options.out, market.series,
                    fmt::format("Imported by bess-train {} from {}\n{}\n{}", BESS_VERSION,
                                file_names(options.files), attribution, description));
  fmt::print("{}written to {}. {}\n", description, options.out, attribution);
  if (market.report.minutes == 0) {
    fmt::print("next: bess-train prices reconstruct --quarter-hours {} --out minutes.csv.gz\n",
               options.out);
  }
}

void add_prices_import(ProgramCommand& prices) {
  auto options = std::make_shared<PricesImportArguments>();
  ProgramCommand command =
      prices.subcommand("import", "convert downloaded or own price files to a minute file");
  command
      .option("files", options->files,
              "downloads of ods046, ods047, ods133, ods134, ods161, ods162, ENTSO-E A85 (XML), "
              "minute files, or your own CSV; plain or .gz")
      .value_name("FILE")
      .required();
  command.flag(
      "--day-ahead", options->day_ahead,
      "the files contain day-ahead prices: ENTSO-E A44 (XML), energy-charts JSON, CSV with "
      "datetime_utc and price_eur_mwh, or day-ahead files");
  command
      .option("--time-column", options->own.time_column,
              "time column of your CSV: start of each minute or quarter-hour")
      .value_name("NAME");
  command.option("--price-column", options->own.price_column, "price column of your CSV, EUR/MWh")
      .value_name("NAME");
  command.option("--date-format", options->own.times.date_format, "date format of your CSV")
      .one_of({"yyyy-mm-dd", "yyyy/mm/dd", "dd/mm/yyyy", "dd-mm-yyyy", "dd.mm.yyyy", "mm/dd/yyyy"})
      .with_default();
  command.choice<std::optional<WallClock>>("--time-zone", options->own.times.clock,
                                           {{"utc", WallClock::kUtc}, {"local", WallClock::kLocal}},
                                           "time zone of times without an offset; local: Belgium");
  options->price_input.add(command);
  command.option("--out", options->out, "minute file to write (.csv or .csv.gz)").required();
  command.footer(
      "Where two downloads have the same minute, the later file wins; minute files must agree "
      "(--accept overlap: the later file wins). Semicolons with decimal commas are accepted. "
      "ENTSO-E sends a ZIP archive: unzip it first. Your own CSV needs a header with a time and a "
      "price (datetime_utc,price_eur_mwh), separated by commas, semicolons or tabs; for other "
      "formats use the options.\n"
      "Examples:\n"
      "  bess-train prices import ods133.csv ods134.csv --out prices.csv.gz\n"
      "  bess-train prices import today/*.json --out today.csv\n"
      "  bess-train prices import 2023.csv.gz 2024.csv.gz --out both.csv.gz\n"
      "  bess-train prices import --day-ahead a44_2024.xml a44_2025.xml --out day_ahead.csv.gz\n"
      "  bess-train prices import own.csv --date-format dd/mm/yyyy --time-zone local --out "
      "own.csv.gz");
  command.runs([options] { run_prices_import(*options); });
}

// bess-train prices fetch: download of prices from Elia's open data.

struct PricesFetchArguments {
  PriceInput price_input;
  std::string from, to, out;
  std::string base_url;
  std::string zone;
  bool day_ahead = false;
  bool allow_gaps = false;
};

std::string base_url_of(const PricesFetchArguments& options, const char* usual) {
  return checked_base_url(options.base_url.empty() ? usual : options.base_url, "--base-url");
}

void fetch_day_ahead_prices(const PricesFetchArguments& options) {
  const DayAheadRequest request{
      .span = {parse_local_date(options.from, "--from"), parse_local_date(options.to, "--to")},
      .zone = options.zone.empty() ? "BE" : options.zone,
      .base_url = base_url_of(options, kEnergyChartsBaseUrl),
      .now_utc_s = std::time(nullptr),
      .retry = {},
      .allow_gaps = options.allow_gaps,
      .sleep = sleep_unless};
  const std::optional<JoinedDayAhead> fetched = fetch_day_ahead(request, interruption());
  if (!fetched) throw Interrupted{};
  write_judged_day_ahead(*fetched, options.price_input.accepted(), {request.base_url},
                         fmt::format("Day-ahead prices of {} fetched from {} (Fraunhofer ISE; the "
                                     "licence is in its answer) by bess-train {}",
                                     request.zone, request.base_url, BESS_VERSION),
                         options.out);
}

void run_prices_fetch(const PricesFetchArguments& options) {
  watch_interruption();
  require_writable(options.out);
  if (options.day_ahead) return fetch_day_ahead_prices(options);
  const std::optional<FetchedPrices> fetched = fetch_prices(
      {.span = {parse_local_date(options.from, "--from"), parse_local_date(options.to, "--to")},
       .out = options.out,
       .base_url = base_url_of(options, kEliaBaseUrl),
       .now_utc_s = std::time(nullptr),
       .retry = {},
       .allow_gaps = options.allow_gaps,
       .accepted = options.price_input.accepted(),
       .sleep = sleep_unless},
      interruption());
  if (!fetched) {
    fmt::print(stderr, "finished windows are kept: repeat the command to continue\n");
    throw Interrupted{};
  }
  fmt::print("{}written to {}. {}\n", fetched->description, options.out,
             attribution_of({MarketSource::kElia}));
}

void add_prices_fetch(ProgramCommand& prices) {
  auto options = std::make_shared<PricesFetchArguments>();
  ProgramCommand command =
      prices.subcommand("fetch", "download minute and settled prices from Elia's open data");
  command.option("--from", options->from, "first local day, YYYY-MM-DD").required();
  command.option("--to", options->to, "last local day, YYYY-MM-DD, included").required();
  command.option("--out", options->out, "minute file to write (.csv or .csv.gz)").required();
  command.flag("--allow-gaps", options->allow_gaps,
               "accept missing rows and list them (default: error)");
  options->price_input.add(command);
  command.flag("--day-ahead", options->day_ahead,
               "download day-ahead prices from energy-charts instead; writes a day-ahead file");
  command.option("--zone", options->zone, "bidding zone of --day-ahead (default BE)")
      .value_name("ZONE")
      .needs("--day-ahead");
  command.option(
      "--base-url", options->base_url,
      fmt::format("API root (default {}; of --day-ahead {})", kEliaBaseUrl, kEnergyChartsBaseUrl));
  command.footer(
      "After an interruption, repeat the command: finished months are kept in OUT.fetch.\n"
      "Rows are counted against the calendar and the server's total. Elia's minutes have gaps in\n"
      "some months: --allow-gaps accepts them, and quarter-hours without a price.\n"
      "A request is repeated if it is incomplete after 20 minutes, or slower than 1,000 bytes/s\n"
      "for a minute. Behind a proxy set https_proxy. No key is needed.\n"
      "Examples:\n"
      "  bess-train prices fetch --from 2023-01-01 --to 2023-12-31 --out 2023.csv.gz\n"
      "  bess-train prices fetch --from 2025-06-01 --to 2025-06-07 --out week.csv\n"
      "  bess-train prices fetch --day-ahead --from 2024-05-22 --to 2025-06-30 --out "
      "day_ahead.csv.gz");
  command.runs([options] { run_prices_fetch(*options); });
}

// bess-train prices stats: statistics of a price file.

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

}  // namespace

void add_prices_commands(ProgramCommand& app) {
  ProgramCommand prices =
      app.subcommand("prices", "price files: fetch, import, reconstruct, simulate, stats");
  prices.requires_subcommand();
  add_prices_simulate(prices);
  add_prices_reconstruct(prices);
  add_prices_import(prices);
  add_prices_fetch(prices);
  add_prices_stats(prices);
}

}  // namespace bess
