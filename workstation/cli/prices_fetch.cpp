// bess-train prices fetch: download of prices from Elia's open data.
#include <fmt/core.h>

#include <ctime>
#include <memory>

#include "shared/host/file.h"
#include "workstation/cli/commands.h"
#include "workstation/data/market/feed/day_ahead_fetch.h"
#include "workstation/data/market/feed/elia_fetch.h"
#include "workstation/data/market/feed/market_files.h"
#include "workstation/runs/chain/common_options.h"
#include "workstation/runs/chain/folder_lock.h"
#include "workstation/runs/chain/price_input.h"

namespace bess {
namespace {

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

}  // namespace

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
  command
      .option("--base-url", options->base_url,
              fmt::format("API root (default {}; of --day-ahead {})", kEliaBaseUrl,
                          kEnergyChartsBaseUrl))
      .value_name("URL");
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

}  // namespace bess
