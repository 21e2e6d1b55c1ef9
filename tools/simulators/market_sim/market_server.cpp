#include "tools/simulators/market_sim/market_server.h"

#include <httplib.h>

#include <algorithm>
#include <chrono>
#include <thread>

#include "shared/host/json.h"
#include "shared/host/text.h"
#include "shared/host/user_error.h"

namespace bess {
namespace {

constexpr const char* kJson = "application/json";

/// Limits of the API: limit 1 to 100, offset + limit at most 10,000.
bool parse_number(const httplib::Request& request, const char* name, int min, int max, int& value) {
  if (!request.has_param(name)) return true;
  return read_number(request.get_param_value(name), value) && value >= min && value <= max;
}

bool parse_query(const httplib::Request& request, RecordsQuery& query, std::string& problem) {
  const std::string order = request.get_param_value("order_by");
  query.newest_first = order == "datetime desc" || order == "-datetime";
  if (!query.newest_first && !order.empty() && order != "datetime" && order != "datetime asc") {
    problem = "order_by: unknown field or direction";
  } else if (!parse_number(request, "limit", 1, 100, query.limit)) {
    problem = "Invalid value for limit API parameter: must be between 1 and 100";
  } else if (!parse_number(request, "offset", 0, 10'000 - query.limit, query.offset)) {
    problem = "Invalid value for offset API parameter: offset + limit must be at most 10000";
  }
  return problem.empty();
}

std::unique_ptr<httplib::Server> make_server(const MarketServerSettings& settings) {
  if (settings.tls_certificate.empty()) return std::make_unique<httplib::Server>();
  auto server = std::make_unique<httplib::SSLServer>(settings.tls_certificate.c_str(),
                                                     settings.tls_key.c_str());
  if (!server->is_valid()) {
    fail("--tls-cert {} --tls-key {}: not a PEM certificate and its key", settings.tls_certificate,
         settings.tls_key);
  }
  return server;
}

}  // namespace

MarketServer::MarketServer(const MarketServerSettings& settings, const MarketView& view,
                           const ScaledClock& clock, const AuctionView* auction)
    : settings_(settings),
      view_(view),
      auction_(auction),
      clock_(clock),
      start_utc_ns_(clock.start_utc_ns()),
      server_(make_server(settings)),
      faults_(settings.faults) {
  // The library sets SO_REUSEPORT otherwise, and two servers could share a port.
  server_->set_socket_options([](socket_t socket) {
    const int yes = 1;
    setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
  });
  server_->set_tcp_nodelay(true);
  server_->set_keep_alive_max_count(settings.close_each ? 1 : 1'000'000'000);
  server_->set_keep_alive_timeout(600);
  server_->new_task_queue = [] { return new httplib::ThreadPool(4); };
  const std::string root = "/api/explore/v2.1/catalog/datasets/";
  const std::pair<const char*, Dataset> datasets[] = {{"ods161", Dataset::kMinutes},
                                                      {"ods162", Dataset::kQuarterHours},
                                                      {"ods133", Dataset::kMinutesOfPastDays}};
  for (const auto& [name, dataset] : datasets) {
    server_->Get(root + name + "/records",
                 [this, dataset = dataset](const auto& request, auto& response) {
                   answer(dataset, request, response);
                 });
  }
  if (auction != nullptr) {
    server_->Get("/price", [this](const auto& request, auto& response) {
      answer_day_ahead(request, response);
    });
  }
  if (settings.port == 0) {
    port_ = server_->bind_to_any_port(settings.host);
  } else if (server_->bind_to_port(settings.host, settings.port)) {
    port_ = settings.port;
  }
  if (port_ <= 0) {
    fail("cannot listen on {}:{}: the port is in use or not allowed; choose another with --port",
         settings.host, settings.port);
  }
}

MarketServer::~MarketServer() = default;

void MarketServer::run() { server_->listen_after_bind(); }

void MarketServer::stop() { server_->stop(); }

void MarketServer::answer(Dataset dataset, const httplib::Request& request,
                          httplib::Response& response) {
  const double at_s = static_cast<double>(clock_.now_utc_ns() - start_utc_ns_) / 1e9;
  const MarketFault fault = faults_.next(at_s);
  if (fault == MarketFault::kHttp500) {
    response.status = 500;
    return response.set_content(Json::object({{"message", "simulated fault"}}).line(), kJson);
  }
  RecordsQuery query{.dataset = dataset};
  std::string problem;
  if (!parse_query(request, query, problem)) {
    response.status = 400;
    const Json refusal =
        Json::object({{"error_code", "InvalidRESTParameterError"}, {"message", problem}});
    return response.set_content(refusal.line(), kJson);
  }
  const double fault_s = std::min(settings_.faults.from_s, at_s);  // its begin, once it has begun
  const std::int64_t fault_utc_s =
      start_utc_ns_ / kNanosecondsPerSecond + static_cast<std::int64_t>(fault_s);
  response.set_content(view_.records(query, clock_.now_utc_ns(), fault, fault_utc_s), kJson);
}

void MarketServer::answer_day_ahead(const httplib::Request& request, httplib::Response& response) {
  const AuctionAnswer answer = auction_->answer(
      request.get_param_value("start"), request.get_param_value("end"), utc_seconds(clock_));
  auction_faults_ += answer.fault != AuctionFault::kNone ? 1 : 0;
  response.status = answer.status;
  const char* type = answer.fault == AuctionFault::kHtml ? "text/html" : kJson;
  if (answer.fault != AuctionFault::kSlow) return response.set_content(answer.body, type);
  // One byte every 0.1 s of wall time.
  response.set_content_provider(
      answer.body.size(), type,
      [body = answer.body](std::size_t offset, std::size_t, httplib::DataSink& sink) {
        std::this_thread::sleep_for(std::chrono::milliseconds(100));
        return sink.write(&body[offset], 1);
      });
}

}  // namespace bess
