// The page over HTTP: reads by anybody who reaches it, orders by who knows a token.
//
//   /             the page                    /api/status /api/why /api/month /api/today /api/map
//   its numbers /statement    the month, to print         /metrics      for Prometheus POST /orders
//   a form, or the same fields as JSON's poor cousin from curl: -d order=hold -d power_w=0 ...
//
// Small requests only, one a connection; a slow client makes nobody else wait.
#pragma once

#include <memory>

#include "edge/page/controller_view.h"
#include "edge/page/page_settings.h"
#include "edge/page/request_guard.h"

namespace httplib {
class Server;
struct Request;
struct Response;
}  // namespace httplib

namespace bess {

class PageServer {
 public:
  explicit PageServer(const PageSettings& settings);
  PageServer(const PageServer&) = delete;
  PageServer& operator=(const PageServer&) = delete;
  ~PageServer();

  /// False with one line. Port 0 of the settings: any free one.
  bool bind(std::string& error);
  [[nodiscard]] int port() const { return port_; }
  /// Until `stop`, from another thread.
  void serve();
  void stop();

 private:
  void add_pages();
  void add_answers();
  void take_order(const httplib::Request& request, httplib::Response& response);

  const PageSettings& settings_;
  ControllerViews views_;
  WrongTokens wrong_tokens_;
  std::unique_ptr<httplib::Server> server_;
  int listening_socket_ = -1;
  int port_ = 0;
};

}  // namespace bess
