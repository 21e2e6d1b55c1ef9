// bess-train refresh: retraining of a run on the latest prices; adopts the candidate unless it is
// worse.
#include "workstation/runs/run/refresh.h"

#include <fmt/core.h>

#include <ctime>
#include <memory>

#include "shared/host/file.h"
#include "shared/host/user_error.h"
#include "workstation/cli/commands.h"
#include "workstation/data/market/feed/day_ahead_fetch.h"
#include "workstation/data/market/feed/elia_fetch.h"
#include "workstation/data/market/feed/market_files.h"
#include "workstation/runs/chain/common_options.h"
#include "workstation/runs/chain/folder_lock.h"
#include "workstation/runs/chain/price_input.h"

namespace bess {
namespace {

namespace fs = std::filesystem;

struct RefreshArguments {
  std::string run;
  int window_days = 365;
  bool adopt = false;
  std::vector<std::string> prices;
  PriceInput price_input;
  DayAheadInput day_ahead;
  std::string source = kEliaBaseUrl;
  std::string day_ahead_source = kEnergyChartsBaseUrl;
};

/// Past days that a candidate may need, and ten for the price level to settle.
FetchSpan span_of(const RefreshArguments& options) {
  constexpr int kSettlingDays = 10;
  const LocalDate yesterday = add_days(local_date_of(std::time(nullptr)), -1);
  return {add_days(yesterday, -kJudgedDays - options.window_days - kSettlingDays), yesterday};
}

void provide_prices(const RefreshArguments& options, const fs::path& out) {
  if (!options.prices.empty()) {
    return write_minute_file(out, options.price_input.read_joined(options.prices).series,
                             "From " + file_names(options.prices));
  }
  watch_interruption();
  const auto fetched = fetch_prices({.span = span_of(options),
                                     .out = out,
                                     .base_url = checked_base_url(options.source, "--base-url"),
                                     .now_utc_s = std::time(nullptr),
                                     .retry = {},
                                     .allow_gaps = true,  // incomplete days are skipped
                                     .accepted = options.price_input.accepted(),
                                     .sleep = sleep_unless},
                                    interruption());
  if (!fetched) throw Interrupted{};
  fmt::print("{}", fetched->description);
}

void fetch_day_ahead_to(const RefreshArguments& options, const fs::path& out) {
  watch_interruption();
  const std::string url = checked_base_url(options.day_ahead_source, "--day-ahead-base-url");
  const auto fetched = fetch_day_ahead({.span = span_of(options),
                                        .base_url = url,
                                        .now_utc_s = std::time(nullptr),
                                        .retry = {},
                                        .allow_gaps = true,
                                        .sleep = sleep_unless},
                                       interruption());
  if (!fetched) throw Interrupted{};
  write_day_ahead_file(out, fetched->series, "Day-ahead prices fetched from " + url);
}

void provide_day_ahead(const RefreshArguments& options, const fs::path& out,
                       const MinuteSeries& settled) {
  if (!options.day_ahead.path.empty()) {
    write_file(out, read_file(options.day_ahead.path));
  } else if (options.prices.empty()) {
    fetch_day_ahead_to(options, out);
  } else {
    fail("the run plans on day-ahead prices: with --prices, also give their file with --day-ahead");
  }
  (void)read_day_ahead(out, settled, options.price_input.accepted(), kDayAheadPublishedMin);
}

}  // namespace

void add_refresh_command(ProgramCommand& app) {
  auto options = std::make_shared<RefreshArguments>();
  ProgramCommand command = app.subcommand(
      "refresh", "retrain on the latest prices; writes a candidate run next to the run");
  command.option("--run", options->run, "run folder").required();
  command.flag("--adopt", options->adopt,
               "replace the run with the candidate unless it is significantly worse");
  command
      .option("--window-days", options->window_days,
              "training window, days; at least half must have prices")
      .range(30, 3650)
      .with_default();
  command.option("--prices", options->prices,
                 "minute files or downloads (default: download the latest prices)");
  options->price_input.add(command);
  options->day_ahead.add(command);
  command.option("--base-url", options->source, "API root of the imbalance prices").with_default();
  command.option("--day-ahead-base-url", options->day_ahead_source, "API root of day-ahead prices")
      .with_default();
  command.footer(
      "The latest 30 days evaluate the candidate; training uses the days before them. The\n"
      "candidate RUN.proposal is a complete run. Adopted, it becomes RUN, and the previous run\n"
      "RUN.before-DATE; rejected, it becomes RUN.refused-DATE. After an interruption, repeat the\n"
      "command to continue.\n"
      "Examples:\n"
      "  bess-train refresh --run runs/site\n"
      "  bess-train refresh --run runs/site --prices 2024.csv.gz 2025.csv.gz --adopt");
  command.runs([options] {
    refresh({.run = options->run,
             .window_days = options->window_days,
             .adopt = options->adopt,
             .provide_prices = [&](const fs::path& out) { provide_prices(*options, out); },
             .provide_day_ahead =
                 [&](const fs::path& out, const MinuteSeries& settled) {
                   provide_day_ahead(*options, out, settled);
                 }},
            stdout);
  });
}

}  // namespace bess
