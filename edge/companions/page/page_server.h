// Page server over HTTP, unauthenticated and read-only: static files, and output of bess-edge for
// the page's script.
//
//   /                                        page.html, page.css, page.js, chart.min.js
//   /api/status /api/why /api/month          output of bess-edge with --json
//   /api/log                                 last 24 hours, as CSV
//   /api/map                                 decisions of the student at this minute
//   /metrics                                 for Prometheus
//
// Only GET and HEAD, one request per connection; a slow client does not delay others.
#pragma once

#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

#include "edge/companions/page/controller_answers.h"
#include "edge/companions/page/page_settings.h"

namespace httplib {
class Server;
}  // namespace httplib

namespace bess {

/// Embedded static file: "page.html", "document.css", "chart.min.js" and the like.
std::string_view page_file(std::string_view name);

/// Check of the Host header, with or without a port: this server's address, localhost on loopback,
/// or one of `hosts`. Prevents DNS rebinding by web sites in a browser on this machine.
bool is_our_host(std::string_view host, const PageSettings& settings);

class PageServer {
 public:
  explicit PageServer(const PageSettings& settings);
  PageServer(const PageServer&) = delete;
  PageServer& operator=(const PageServer&) = delete;
  ~PageServer();

  /// False with one line. Port 0 of the settings: any free port.
  bool bind(std::string& error);
  [[nodiscard]] int port() const { return port_; }
  /// Serves until `stop` from another thread.
  void serve();
  void stop();

 private:
  void add_files();
  void add_answers();
  CachedAnswer& add_answer(const char* path, const char* type, CachedAnswer::Make make);

  const PageSettings& settings_;
  std::vector<std::unique_ptr<CachedAnswer>> answers_;
  std::mutex day_lock_;  ///< one log of an earlier day at a time
  std::unique_ptr<httplib::Server> server_;
  int listening_socket_ = -1;
  int port_ = 0;
};

}  // namespace bess
