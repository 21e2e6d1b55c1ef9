// bess-sim market: options and composition.
#include <cstdio>
#include <thread>

#include "shared/host/user_error.h"
#include "shared/utc_text.h"
#include "tools/market_sim/market_server.h"
#include "tools/sim/clock_options.h"
#include "tools/sim/commands.h"
#include "tools/sim/stop_signal.h"

namespace bess {
namespace {

struct MarketOptions {
  MarketServerSettings server;
  ClockOptions clock;
  std::string prices_path;
  double latency_s = 0;
};

void check_coverage(const MarketView& view, std::int64_t now_utc_s) {
  if (now_utc_s >= view.first_utc_s() && now_utc_s <= view.last_utc_s()) return;
  std::fprintf(stderr, "bess-sim market: note: %s is outside the file (%s to %s): no new rows\n",
               utc_text(now_utc_s).c_str(), utc_text(view.first_utc_s()).c_str(),
               utc_text(view.last_utc_s()).c_str());
}

void run_market(const MarketOptions& options) {
  const StopSignal stop;
  const MarketView view(read_minute_file(options.prices_path), options.latency_s);
  const ScaledClock clock = options.clock.clock();
  MarketServer server(options.server, view, clock);
  const std::int64_t now_utc_s = clock.now_utc_ns() / kNanosecondsPerSecond;
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

}  // namespace

void add_market_command(ProgramCommand& app) {
  auto options = std::make_shared<MarketOptions>();
  ProgramCommand command =
      app.subcommand("market", "A price server with Elia's API (ods161, ods162, ods133)");
  command.footer(
      "Examples:\n"
      "  bess-sim market --prices minutes.csv.gz --port 8080 --utc-start 2023-03-26T00:00:00Z "
      "--time-scale 900 --anchor-monotonic-ns $(bess-sim clock)\n"
      "  curl 'http://127.0.0.1:8080/api/explore/v2.1/catalog/datasets/ods161/records"
      "?order_by=datetime%20desc&limit=3'");
  command.option("--prices", options->prices_path, "Minute file, CSV or .csv.gz").required();
  command.option("--host", options->server.host, "Address to listen on").with_default();
  command.option("--port", options->server.port, "TCP port, 0 = any free one")
      .range(0, 65'535)
      .with_default();
  options->clock.add_to(command);
  command
      .option("--latency-s", options->latency_s,
              "Simulated seconds from the end of a minute until its row is readable")
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
                              "Misbehave now and then");
  command.option("--fault-every", options->server.faults.every, "At every Nth request")
      .range(1, 1'000'000)
      .with_default()
      .needs("--fault");
  command
      .option("--fault-from-s", options->server.faults.from_s, "Simulated seconds after the start")
      .non_negative()
      .needs("--fault");
  command.option("--fault-to-s", options->server.faults.to_s, "And until when")
      .non_negative()
      .needs("--fault");
  ProgramOption certificate = command.option("--tls-cert", options->server.tls_certificate,
                                             "PEM certificate: serves HTTPS");
  command.option("--tls-key", options->server.tls_key, "Its PEM key").needs("--tls-cert");
  certificate.needs("--tls-key");
  command.flag("--close-each", options->server.close_each,
               "Close the connection after each answer");
  command.runs([options] { run_market(*options); });
}

}  // namespace bess
