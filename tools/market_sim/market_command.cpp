// bess-sim market: options and composition.
#include <cstdio>
#include <map>
#include <thread>

#include "shared/utc_text.h"
#include "tools/market_sim/market_server.h"
#include "tools/sim/clock_options.h"
#include "tools/sim/commands.h"
#include "tools/sim/sim_error.h"
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
  const MarketView view(read_minute_prices(options.prices_path), options.latency_s);
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

void add_market_command(CLI::App& app) {
  auto options = std::make_shared<MarketOptions>();
  CLI::App* command =
      app.add_subcommand("market", "A price server with Elia's API (ods161, ods162)");
  command->footer(
      "Examples:\n"
      "  bess-sim market --prices minutes.csv.gz --port 8080 --utc-start 2023-03-26T00:00:00Z "
      "--time-scale 900 --anchor-monotonic-ns $(bess-sim clock)\n"
      "  curl 'http://127.0.0.1:8080/api/explore/v2.1/catalog/datasets/ods161/records"
      "?order_by=datetime%20desc&limit=3'");
  command->add_option("--prices", options->prices_path, "Minute file, CSV or .csv.gz")->required();
  command->add_option("--host", options->server.host, "Address to listen on")
      ->capture_default_str();
  command->add_option("--port", options->server.port, "TCP port, 0 = any free one")
      ->check(CLI::Range(0, 65'535))
      ->capture_default_str();
  options->clock.add_to(*command);
  command
      ->add_option("--latency-s", options->latency_s,
                   "Simulated seconds from the end of a minute until its row is readable")
      ->check(CLI::Range(0.0, 3'600.0))
      ->capture_default_str();
  const std::map<std::string, MarketFault> faults = {{"null", MarketFault::kNull},
                                                     {"http-500", MarketFault::kHttp500},
                                                     {"stale", MarketFault::kStale},
                                                     {"garbage", MarketFault::kGarbage},
                                                     {"all", MarketFault::kAll}};
  command->add_option("--fault", options->server.fault, "Misbehave now and then")
      ->transform(CLI::Transformer(faults, CLI::ignore_case))
      ->type_name("null|http-500|stale|garbage|all");
  command->add_option("--fault-every", options->server.fault_every, "At every Nth request")
      ->check(CLI::Range(1, 1'000'000))
      ->capture_default_str();
  auto* certificate = command->add_option("--tls-cert", options->server.tls_certificate,
                                          "PEM certificate: serves HTTPS");
  command->add_option("--tls-key", options->server.tls_key, "Its PEM key")->needs(certificate);
  certificate->needs("--tls-key");
  command->add_flag("--close-each", options->server.close_each,
                    "Close the connection after each answer");
  command->callback([options] { run_market(*options); });
}

}  // namespace bess
