// bess-train prices import: conversion of downloaded CSV, JSON and XML to one minute file.
#include <fmt/core.h>

#include <memory>

#include "shared/host/file.h"
#include "workstation/cli/commands.h"
#include "workstation/runs/chain/price_input.h"

namespace bess {
namespace {

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

}  // namespace

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

}  // namespace bess
