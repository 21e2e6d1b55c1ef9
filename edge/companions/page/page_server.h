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
#include <string_view>
#include <vector>

#include "edge/companions/page/controller_answers.h"
#include "edge/companions/page/page_settings.h"

namespace httplib {
class Server;
}  // namespace httplib

namespace bess {

// The static files of the page, embedded when it is built.

/// "page.html", "page.css", "page.js" or "chart.min.js".
std::string_view page_file(std::string_view name);

// Who may ask. A page on the loopback device is within reach of every browser on that machine, and
// so of every web site that it visits: the name that is asked for must be ours (no rebinding of a
// foreign name).

/// `host` of the request, with or without a port: this server's address, localhost on loopback, or
/// one of `hosts`.
bool is_our_host(std::string_view host, const PageSettings& settings);

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
