// bess-prices: fetches and publishes the prices on which the controller decides. A separate
// process, free to use heap and libraries: if it is killed, blocked or absent, prices are missing,
// but no control cycle.
#include <sys/stat.h>
#include <unistd.h>

#include <cstdio>
#include <cstring>
#include <string>
#include <thread>

#include "edge/app/storage/instance_lock.h"
#include "edge/companions/common/stop_signals.h"
#include "edge/core/control/level_start.h"
#include "edge/core/control/policy.h"
#include "edge/prices/fetch/fetch.h"
#include "edge/prices/fetch/outlook_fetcher.h"
#include "edge/prices/fetch/price_fetcher.h"
#include "edge/prices/fetch/settled_fetch.h"
#include "edge/prices/record/transport_security.h"
#include "edge/records/log/log_reader.h"
#include "shared/host/command_line.h"
#include "shared/local_time.h"
#include "shared/utc_text.h"

namespace bess {
namespace {

constexpr const char* kFooter =
    R"(Writes the newest price, the price level of the last hours and, for a student by outlook, the
plan on day-ahead prices to one file in [state] run_folder (or folder), which bess-edge reads. Can
be started before or after bess-edge and restarted at any time. One bess-prices per file. Once a day
it fetches the settled prices of past quarter-hours for bess-edge earned, if [settled] url is set.
Exit codes:
  0 done
  1 invalid settings, or another bess-prices is running; with --check also: no usable price; with
    --settle: no settled price
  2 invalid command line)";

struct Options {
  std::string config_path = "/etc/bess/edge.toml";
  bool check = false;
  bool settle = false;
  const char* started_as = "";
};

/// Prints the error; returns the exit code.
int complain(const std::string& text) {
  std::fprintf(stderr, "bess-prices: %s\n", text.c_str());
  return 1;
}

bool check_price(const EdgeConfig& config) {
  UnitWatch unit;
  const PriceReply answer = ask_first_price(config, unit);
  const Status status = unit.is_doubtful() ? Status::kDoubtfulUnit : answer.status;
  if (status != Status::kOk) {
    complain("price from " + std::string(loggable_url(config.price.feed.http.url.view()).view()) +
             ": " +
             (answer.reason.empty() ? std::string(price_status_text(status)) : answer.reason));
    return false;
  }
  std::printf("price      %.2f EUR/MWh of minute %s\n",
              answer.newest.price_centi_eur_per_mwh / 100.0,
              utc_text(answer.newest.minute_utc_s).c_str());
  if (answer.passed_over > 0) {
    std::printf("rows       %d skipped: no valid price\n", answer.passed_over);
  }
  return true;
}

/// Missing day-ahead prices stop nothing.
void check_day_ahead(const EdgeConfig& config) {
  const OutlookSettings& outlook = config.outlook;
  const std::string source =
      outlook.file.empty() ? loggable_url(outlook.http.url.view()).c_str() : outlook.file.c_str();
  const std::int64_t now_utc_s = utc_seconds(config.clock);
  DayAheadFetchState fetch_state;
  fetch_state.take(ask_day_ahead(outlook, now_utc_s, [] { return false; }), outlook, now_utc_s);
  if (fetch_state.status != Status::kOk) {
    complain("day-ahead prices from " + source + ": " + fetch_state.reason +
             "; planning on usual prices");
    return;
  }
  std::printf("day-ahead  %u quarter-hours from %s\n", fetch_state.store.changes(), source.c_str());
}

int settle_now(const EdgeConfig& config, const SettledSource& source) {
  if (source.url.empty()) return complain("nothing to fetch: set [settled] url");
  const SettledResult result = fetch_settled(source, utc_seconds(config.clock), {});
  if (!result.trouble.empty()) return complain("settled prices: " + result.trouble);
  std::printf("%d quarter-hours, %s, kept in %s\n", result.fetched,
              result.is_whole ? "complete up to yesterday" : "yesterday incomplete",
              source.file.c_str());
  return 0;
}

/// True if a controller that starts now would find the level in its log.
bool knows_level(const EdgeConfig& config) {
  LogReader log;
  FileMessage ignored;
  CycleRecord newest;
  const std::int64_t now_utc_s = utc_seconds(config.clock);
  return log.open(config.log, ignored) && log.newest(newest) &&
         level_from_log(newest.price_level, now_utc_s).is_known();
}

/// Determines the level of a first start, then plans.
void run_beside(const EdgeConfig& config, PricePublisher& publisher, const std::stop_token& stop) {
  const bool needs_level = student_context().kind != ContextKind::kMonth;
  PublishedHistory history{.is_done = true};
  if (needs_level && !knows_level(config)) {
    history = find_history(config, stop);
  }
  publisher.publish([&](PublishedPrices& prices) { prices.history = history; });
  const OutlookModel* const model = student_outlook();
  if (model == nullptr) return;
  const std::int32_t level_centi = history.level.is_known()
                                       ? history.level.centi_eur_per_mwh()
                                       : config.price.level_start_centi_eur_per_mwh.value_or(0);
  OutlookFetcher outlook(config, *model, publisher, stop);
  outlook.start(level_centi);
  const std::jthread planning([&] { outlook.plan_until_stopped(); });
  outlook.fetch_until_stopped();
}

/// True if another version was installed under the name of this program: systemd starts it when
/// this process ends.
bool is_replaced(const char* started_as) {
  struct stat now {};
  struct stat self {};
  return std::strchr(started_as, '/') != nullptr && stat(started_as, &now) == 0 &&
         stat("/proc/self/exe", &self) == 0 &&
         (now.st_ino != self.st_ino || now.st_dev != self.st_dev);
}

int publish(const EdgeConfig& config, const SettledSource& settled, const char* started_as) {
  const std::string path(prices_file(config).view());
  InstanceLock lock;
  FileMessage error;
  const bool is_folder = make_folder(folder_of(path.c_str()).c_str());
  if (!is_folder) return complain(path + ": cannot create its folder (check [state] run_folder)");
  if (!lock.take((path + ".lock").c_str(), "bess-prices", error)) {
    return complain(error.c_str());
  }
  std::stop_source stop;
  const StopSignals stop_signals([&] { stop.request_stop(); });
  say(JournalLevel::kNotice, "started");
  PricePublisher publisher(path);
  std::jthread beside([&] { run_beside(config, publisher, stop.get_token()); });
  std::jthread settling;
  if (!settled.url.empty()) {
    settling = std::jthread([&] { fetch_settled_daily(settled, config.clock, stop.get_token()); });
  }
  PriceFetcher(config, publisher, stop.get_token()).run([&] { return is_replaced(started_as); });
  stop.request_stop();
  beside.join();
  if (settling.joinable()) settling.join();
  static_cast<void>(unlink(path.c_str()));  // it would become outdated
  say(JournalLevel::kNotice, "stopped");
  return 0;
}

int run(const Options& options) {
  EdgeConfig config;
  std::string error;
  if (!load_edge_config(options.config_path, config, error)) return complain(error);
  config.outlook.ask_offset_s = day_ahead_offset_s(config);
  set_market_time_zone();
  SettledSource settled;
  settled.file = state_file(config, "settled.csv").c_str();
  if (!load_settled_source(options.config_path, settled, error)) {
    complain(error);  // must not stop the prices for trading
    if (options.check || options.settle) return 1;
    settled.url.clear();
  }
  if (options.settle) return settle_now(config, settled);
  if (!options.check) return publish(config, settled, options.started_as);
  const bool is_well = check_price(config);
  if (!settled.url.empty()) {
    std::printf("settled    prices of %d days, fetched once a day\n", settled.days);
  }
  if (student_outlook() != nullptr) check_day_ahead(config);
  return is_well ? 0 : 1;
}

}  // namespace
}  // namespace bess

int main(int argc, char** argv) {
  bess::CommandLine line("bess-prices", "imbalance and day-ahead price fetcher for bess-edge",
                         "bess-prices " BESS_VERSION);
  bess::Options options;
  if (argc > 0) options.started_as = argv[0];
  bess::ProgramCommand root = line.root();
  root.option("--config", options.config_path,
              "controller settings; sections [price], [outlook] and [settled]")
      .with_default()
      .value_name("FILE");
  root.flag("--check", options.check,
            "ask the servers of [price] and [outlook] once and print the answers");
  root.flag("--settle", options.settle, "fetch the settled prices of past days now")
      .excludes("--check");
  root.footer(bess::kFooter);
  root.exits_with([&] { return bess::run(options); });
  return line.run(argc, argv);
}
