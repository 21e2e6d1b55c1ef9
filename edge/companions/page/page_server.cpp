#include "edge/companions/page/page_server.h"

#include <httplib.h>
#include <sys/socket.h>

#include "edge/companions/common/numeric_address.h"
#include "edge/companions/page/controller_answers.h"
#include "shared/host/json.h"
#include "shared/host/text.h"
#include "shared/scaled_clock.h"
#include "shared/units_and_limits.h"
#include "shared/utc_text.h"

namespace bess {

namespace {

/// Host without port; of "[::1]:80" the part in brackets.
std::string_view without_port(std::string_view host) {
  if (host.starts_with('[')) {
    const std::size_t end = host.find(']');
    return end == host.npos ? std::string_view() : host.substr(1, end - 1);
  }
  return host.substr(0, host.rfind(':'));
}

}  // namespace

bool is_our_host(std::string_view host, const PageSettings& settings) {
  const std::string_view name = without_port(host);
  if (name.empty()) return false;
  if (name == settings.host) return true;
  if (is_loopback_address(settings.host) && equals_ignoring_case(name, "localhost")) return true;
  for (const std::string& ours : settings.hosts) {
    if (equals_ignoring_case(name, ours)) return true;
  }
  // Listening on all addresses: any address is ours, but only names in `hosts`.
  return (settings.host == "0.0.0.0" || settings.host == "::") &&
         is_numeric_address(std::string(name));
}

namespace {

// A silent or slow connection occupies only its own thread.
constexpr int kThreads = 128;
constexpr int kQueued = 128;
constexpr time_t kReadS = 5;  ///< without a byte
constexpr time_t kWriteS = 5;
constexpr std::size_t kBodyBytesMax = 4'096;
constexpr const char* kJson = "application/json";
constexpr const char* kCsv = "text/csv; charset=utf-8";

/// Forbids content from other hosts, requests to other hosts, and embedding in other pages.
void set_headers(httplib::Server& server) {
  server.set_default_headers(
      {{"Content-Security-Policy",
        "default-src 'none'; style-src 'self'; script-src 'self'; connect-src 'self'; "
        "img-src data:; form-action 'none'; frame-ancestors 'none'; base-uri 'none'"},
       {"X-Content-Type-Options", "nosniff"},
       {"X-Frame-Options", "DENY"},
       {"Referrer-Policy", "no-referrer"},
       {"Cross-Origin-Resource-Policy", "same-origin"},
       {"Cache-Control", "no-store"}});
}

void refuse(httplib::Response& response, int status, const std::string& why) {
  response.status = status;
  response.set_content(why + "\n", "text/plain; charset=utf-8");
}

/// Refuses wrong hosts and methods before routing.
bool is_refused(const httplib::Request& request, httplib::Response& response,
                const PageSettings& settings) {
  if (!is_our_host(request.get_header_value("Host"), settings)) {
    refuse(response, 421, "unknown host name: add it to [page] hosts");
    return true;
  }
  if (request.method == "GET" || request.method == "HEAD") return false;
  response.set_header("Allow", "GET, HEAD");
  refuse(response, 405, "the page is read-only: use bess-edge for orders");
  return true;
}

}  // namespace

PageServer::PageServer(const PageSettings& settings)
    : settings_(settings), server_(std::make_unique<httplib::Server>()) {
  // The library's default (SO_REUSEPORT) would let two pages share a port.
  server_->set_socket_options([this](socket_t socket) {
    const int yes = 1;
    setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
    listening_socket_ = socket;
  });
  server_->new_task_queue = [] { return new httplib::ThreadPool(kThreads); };
  server_->set_keep_alive_max_count(1);
  server_->set_read_timeout(kReadS);
  server_->set_write_timeout(kWriteS);
  server_->set_payload_max_length(kBodyBytesMax);
  set_headers(*server_);
  server_->set_pre_routing_handler([this](const httplib::Request& request,
                                          httplib::Response& response) {
    return is_refused(request, response, settings_) ? httplib::Server::HandlerResponse::Handled
                                                    : httplib::Server::HandlerResponse::Unhandled;
  });
  server_->set_exception_handler(
      [](const httplib::Request&, httplib::Response& response, const std::exception_ptr&) {
        refuse(response, 500, "internal error: the page could not be generated");
      });
  add_files();
  add_answers();
}

PageServer::~PageServer() = default;

void PageServer::add_files() {
  const auto add = [this](const char* path, const char* name, const char* type) {
    server_->Get(path, [name, type](const httplib::Request&, httplib::Response& response) {
      const std::string_view file = page_file(name);
      response.set_content(file.data(), file.size(), type);
    });
  };
  add("/", "page.html", "text/html; charset=utf-8");
  add("/document.css", "document.css", "text/css; charset=utf-8");
  add("/page.css", "page.css", "text/css; charset=utf-8");
  add("/page.js", "page.js", "text/javascript; charset=utf-8");
  add("/chart.min.js", "chart.min.js", "text/javascript; charset=utf-8");
  add("/charts.js", "charts.js", "text/javascript; charset=utf-8");
}

namespace {

void send(const Answer& answer, const char* type, httplib::Response& response) {
  response.set_header("Age", std::to_string(answer.age_ns() / kNanosecondsPerSecond));
  if (answer.trouble.empty()) return response.set_content(answer.text, type);
  response.status = 503;
  response.set_content(Json::object({{"trouble", answer.trouble}}).text(), kJson);
}

/// "2026-11-23"; bess-edge checks that there is such a day.
bool looks_like_date(std::string_view text) {
  using detail::take, detail::take_digits;
  return take_digits(text, 4) >= 0 && take(text, '-') && take_digits(text, 2) >= 0 &&
         take(text, '-') && take_digits(text, 2) >= 0 && text.empty();
}

}  // namespace

CachedAnswer& PageServer::add_answer(const char* path, const char* type, CachedAnswer::Make make) {
  answers_.push_back(std::make_unique<CachedAnswer>(settings_.refresh_s, std::move(make)));
  CachedAnswer& kept = *answers_.back();
  server_->Get(path, [&kept, type](const httplib::Request&, httplib::Response& response) {
    send(*kept.newest(), type, response);
  });
  return kept;
}

void PageServer::add_answers() {
  const auto add = [this](const char* path, const char* type,
                          std::vector<std::string> words) -> auto& {
    return add_answer(path, type, [this, type, words = std::move(words)] {
      return ask_controller(settings_, words, type == std::string_view(kJson));
    });
  };
  add("/api/status", kJson, {"status", "--json", "--no-lock"});
  add("/api/month", kJson, {"earned", "month", "--json"});
  add("/api/log", kCsv, {"log", "--csv", "--last", std::to_string(kStepsPerDay)});
  add("/metrics", "text/plain; version=0.0.4; charset=utf-8",
      {"status", "--prometheus", "--no-lock"});
  CachedAnswer& why = add("/api/why", kJson, {"why", "--json"});
  add_answer("/api/map", kJson, [&why] {
    Answer answer = *why.newest();
    if (answer.trouble.empty()) {
      answer.text = decision_map_of(Json::parse(answer.text).value()).text();
    }
    return answer;
  });
  server_->Get("/api/day", [this](const httplib::Request& request, httplib::Response& response) {
    const std::string date = request.get_param_value("date");
    if (!looks_like_date(date))
      return refuse(response, 400, "no day: use /api/day?date=2026-11-23");
    const std::scoped_lock one_at_a_time(day_lock_);
    send(ask_controller(settings_,
                        {"log", "--csv", "--since", date + " 00:00", "--until", date + " 23:59"},
                        false),
         kCsv, response);
  });
}

bool PageServer::bind(std::string& error) {
  port_ = settings_.port;
  const bool is_bound = settings_.port == 0
                            ? (port_ = server_->bind_to_any_port(settings_.host)) > 0
                            : server_->bind_to_port(settings_.host, settings_.port);
  if (!is_bound) {
    error = "[page] host, port: " + settings_.host + ":" + std::to_string(settings_.port) +
            " cannot be opened: is another program using the port?";
  }
  // The library's default queue holds 5 clients: a sixth would wait for a second.
  if (is_bound) ::listen(listening_socket_, kQueued);
  return is_bound;
}

void PageServer::serve() { server_->listen_after_bind(); }
void PageServer::stop() { server_->stop(); }

}  // namespace bess
