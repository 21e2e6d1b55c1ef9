// The page over HTTP, to be read by anybody who reaches it: static files, and the controller's
// answers, which the page's script shows.
//
//   /                                        page.html, page.css, page.js, chart.min.js
//   /api/status /api/why /api/month          what bess-edge prints with --json
//   /api/log                                 its last 24 hours, as CSV
//   /api/map                                 the student's decisions around the present
//   /metrics                                 for Prometheus
//
// GET and HEAD alone, one request a connection; a slow client makes nobody else wait.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "edge/page/controller_answers.h"
#include "edge/page/page_settings.h"

namespace httplib {
class Server;
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
  void add_files();
  void add_answers();
  KeptAnswer& add_answer(const char* path, const char* type, KeptAnswer::Make make);

  const PageSettings& settings_;
  std::vector<std::unique_ptr<KeptAnswer>> answers_;
  std::unique_ptr<httplib::Server> server_;
  int listening_socket_ = -1;
  int port_ = 0;
};

}  // namespace bess
