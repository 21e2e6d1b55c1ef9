// HTTP server of the simulated market: paths, query parameters and errors of Elia, and of
// energy-charts for day-ahead prices, with faults.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <string>

#include "shared/scaled_clock.h"
#include "tools/simulators/market_sim/auction_view.h"
#include "tools/simulators/market_sim/market_fault.h"
#include "tools/simulators/market_sim/market_view.h"

namespace httplib {
class Server;
struct Request;
struct Response;
}  // namespace httplib

namespace bess {

struct MarketServerSettings {
  std::string host = "127.0.0.1";
  std::int32_t port = 8080;  ///< 0: any free port
  MarketFaultSchedule faults;
  std::string tls_certificate;  ///< PEM files; empty: plain HTTP
  std::string tls_key;
  bool close_each = false;  ///< one request per connection: a handshake for every price
};

class MarketServer {
 public:
  /// Binds. Throws UserError if the port is in use or the certificate is invalid. Without an
  /// auction there are no day-ahead prices.
  MarketServer(const MarketServerSettings& settings, const MarketView& view,
               const ScaledClock& clock, const AuctionView* auction = nullptr);
  ~MarketServer();

  [[nodiscard]] int port() const { return port_; }
  void run();   ///< serves until `stop`
  void stop();  ///< from another thread
  /// Faulty answers so far.
  [[nodiscard]] std::int64_t faults() const { return faults_.faults() + auction_faults_; }

 private:
  void answer(Dataset dataset, const httplib::Request& request, httplib::Response& response);
  void answer_day_ahead(const httplib::Request& request, httplib::Response& response);

  MarketServerSettings settings_;
  const MarketView& view_;
  const AuctionView* auction_;
  ScaledClock clock_;
  std::int64_t start_utc_ns_;
  std::unique_ptr<httplib::Server> server_;
  int port_ = 0;
  MarketFaultPlan faults_;
  std::atomic<std::int64_t> auction_faults_ = 0;
};

}  // namespace bess
