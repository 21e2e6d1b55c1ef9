// bess-sim market: options and composition.
#include <cstdio>
#include <thread>

#include "shared/host/file.h"
#include "shared/host/user_error.h"
#include "shared/utc_text.h"
#include "tools/simulators/market_sim/market_server.h"
#include "tools/simulators/sim/clock_options.h"
#include "tools/simulators/sim/commands.h"
#include "tools/simulators/sim/stop_signal.h"

namespace bess {
namespace {

struct MarketOptions {
  MarketServerSettings server;
  ClockOptions clock;
  std::string prices_path;
  double latency_s = 0;
  std::string day_ahead_path;  ///< empty: none are published
  std::string day_ahead_at = "12:57";
  AuctionSettings auction;
};

void check_coverage(const MarketView& view, std::int64_t now_utc_s) {
  if (now_utc_s >= view.first_utc_s() && now_utc_s <= view.last_utc_s()) return;
  std::fprintf(
      stderr,
      "bess-sim market: note: %s is outside the file (%s to %s): no rows will be published\n",
      utc_text(now_utc_s).c_str(), utc_text(view.first_utc_s()).c_str(),
      utc_text(view.last_utc_s()).c_str());
}

std::optional<AuctionView> auction_of(const MarketOptions& options, const ScaledClock& clock) {
  if (options.day_ahead_path.empty()) return std::nullopt;
  AuctionSettings settings = options.auction;
  std::int64_t at_s = 0;
  if (!parse_utc("1970-01-01T" + options.day_ahead_at + "Z", at_s)) {
    fail("--day-ahead-at {}: is not a local time such as 12:57", options.day_ahead_at);
  }
  settings.published_min = static_cast<std::int32_t>(at_s / 60);
  settings.start_utc_s = clock.start_utc_ns() / kNanosecondsPerSecond;
  const std::string& path = options.day_ahead_path;
  return AuctionView(parse_auction_rows(read_file(path), path), settings);
}

void run_market(const MarketOptions& options) {
  const StopSignal stop;
  const MarketView view(read_minute_file(options.prices_path), options.latency_s);
  const ScaledClock clock = options.clock.clock();
  const std::optional<AuctionView> auction = auction_of(options, clock);
  MarketServer server(options.server, view, clock, auction ? &*auction : nullptr);
  const std::int64_t now_utc_s = utc_seconds(clock);
  check_coverage(view, now_utc_s);
  std::printf("bess-sim market: listening on %s://%s:%d, %s at time scale %d\n",
              options.server.tls_certificate.empty() ? "http" : "https",
              options.server.host.c_str(), server.port(), utc_text(now_utc_s).c_str(), clock.scale);
  std::fflush(stdout);
  std::thread serving([&server] { server.run(); });
  stop.wait();
  server.stop();
  serving.join();
  std::printf("bess-sim market: stopped after %lld faults\n",
              static_cast<long long>(server.faults()));
}

/// A time of a fault.
void add_seconds(ProgramCommand& command, const char* name, auto& value, const char* fault,
                 const char* help) {
  command.option(name, value, help).non_negative().needs(fault);
}

void add_day_ahead_options(ProgramCommand& command, MarketOptions& options) {
  constexpr const char *kFault = "--day-ahead-fault", *kFile = "--day-ahead";
  AuctionSettings& auction = options.auction;
  command.option(kFile, options.day_ahead_path,
                 "Day-ahead file, published as energy-charts does (/price)");
  command
      .option("--day-ahead-at", options.day_ahead_at,
              "local time of publication on the previous day, unless given in the file")
      .with_default()
      .needs(kFile);
  std::vector<std::pair<std::string, AuctionFault>> faults;
  for (std::size_t f = 1; f < std::size(kAuctionFaultNames); ++f) {
    faults.emplace_back(kAuctionFaultNames[f], static_cast<AuctionFault>(f));
  }
  command
      .choice(kFault, auction.fault, faults, "Fault of the day-ahead prices published from now on")
      .needs(kFile);
  command.option("--day-ahead-fault-every", auction.every, "inject on every Nth day")
      .range(1, 1'000)
      .with_default()
      .needs(kFault);
  add_seconds(command, "--day-ahead-fault-from-s", auction.from_s, kFault,
              "start of the day-ahead fault, simulated s after the start");
  add_seconds(command, "--day-ahead-fault-to-s", auction.to_s, kFault,
              "end of the day-ahead fault, simulated s after the start");
  add_seconds(command, "--day-ahead-repair-s", auction.repair_s, kFault,
              "delay until a faulty day is corrected, simulated s (default: never; late: 21600)");
}

}  // namespace

void add_market_command(ProgramCommand& app) {
  auto options = std::make_shared<MarketOptions>();
  ProgramCommand command =
      app.subcommand("market",
                     "simulate a price server with the APIs of Elia (ods161, ods162, ods133) and "
                     "energy-charts (day-ahead)");
  command.footer(
      "Examples:\n"
      "  bess-sim market --prices minutes.csv.gz --port 8080 --utc-start 2023-03-26T00:00:00Z "
      "--time-scale 900 --anchor-monotonic-ns $(bess-sim clock)\n"
      "  curl 'http://127.0.0.1:8080/api/explore/v2.1/catalog/datasets/ods161/records"
      "?order_by=datetime%20desc&limit=3'\n"
      "  bess-sim market --prices minutes.csv.gz --day-ahead day_ahead.csv.gz --port 8080 "
      "--utc-start 2025-03-28T12:00:00Z --day-ahead-fault half --day-ahead-repair-s 3600\n"
      "  curl 'http://127.0.0.1:8080/price?bzn=BE&start=2025-03-28&end=2025-03-29'");
  command.option("--prices", options->prices_path, "minute file with the prices, CSV or .csv.gz")
      .required();
  command.option("--host", options->server.host, "numeric IPv4 address to listen on")
      .with_default();
  command.option("--port", options->server.port, "TCP port; 0: any free port")
      .range(0, 65'535)
      .with_default();
  options->clock.add_to(command);
  command
      .option("--latency-s", options->latency_s,
              "delay from the end of a minute to its publication, simulated s")
      .range(0.0, 3'600.0)
      .with_default();
  command.choice<MarketFault>("--fault", options->server.faults.fault,
                              {{"null", MarketFault::kNull},
                               {"http-500", MarketFault::kHttp500},
                               {"stale", MarketFault::kStale},
                               {"garbage", MarketFault::kGarbage},
                               {"trailing", MarketFault::kTrailing},
                               {"twice", MarketFault::kTwice},
                               {"frozen", MarketFault::kFrozen},
                               {"all", MarketFault::kAll}},
                              "fault to inject");
  command.option("--fault-every", options->server.faults.every, "inject at every Nth request")
      .range(1, 1'000'000)
      .with_default()
      .needs("--fault");
  add_seconds(command, "--fault-from-s", options->server.faults.from_s, "--fault",
              "start of the fault, simulated s after the start");
  add_seconds(command, "--fault-to-s", options->server.faults.to_s, "--fault",
              "end of the fault, simulated s after the start");
  add_day_ahead_options(command, *options);
  ProgramOption certificate = command.option("--tls-cert", options->server.tls_certificate,
                                             "PEM certificate; enables HTTPS");
  command.option("--tls-key", options->server.tls_key, "PEM private key of the certificate")
      .needs("--tls-cert");
  certificate.needs("--tls-key");
  command.flag("--close-each", options->server.close_each,
               "close the connection after each response");
  command.runs([options] { run_market(*options); });
}

}  // namespace bess
