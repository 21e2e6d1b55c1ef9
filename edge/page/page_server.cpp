#include "edge/page/page_server.h"

#include <httplib.h>
#include <sys/socket.h>

#include <functional>

#include "edge/companion/orders.h"
#include "edge/log/journal.h"
#include "edge/page/page_files.h"
#include "edge/page/page_html.h"
#include "shared/host/run_program.h"
#include "shared/host/text.h"
#include "shared/scaled_clock.h"

namespace bess {
namespace {

constexpr std::int64_t kOrderS = 20;
// A connection that says nothing, or a byte now and then, holds its own thread only.
constexpr int kThreads = 128;
constexpr int kQueued = 128;
constexpr time_t kReadS = 5;  ///< without a byte
constexpr time_t kWriteS = 5;
constexpr std::size_t kBodyBytesMax = 4'096;
constexpr const char* kHtml = "text/html; charset=utf-8";
constexpr const char* kJson = "application/json";

/// Nothing of the page comes from elsewhere, goes elsewhere, or stands in somebody else's frame.
void set_headers(httplib::Server& server) {
  server.set_default_headers(
      {{"Content-Security-Policy",
        "default-src 'none'; style-src 'self'; script-src 'self'; "
        "connect-src 'self'; img-src 'self' data:; "
        "form-action 'self'; frame-ancestors 'none'; base-uri 'none'"},
       {"X-Content-Type-Options", "nosniff"},
       {"X-Frame-Options", "DENY"},
       // Not "no-referrer": a browser would then send its own form with "Origin: null".
       {"Referrer-Policy", "same-origin"},
       {"Cross-Origin-Resource-Policy", "same-origin"},
       {"Cache-Control", "no-store"}});
}

void refuse(httplib::Response& response, int status, const std::string& why) {
  response.status = status;
  response.set_content(why + "\n", "text/plain; charset=utf-8");
}

OrderFields fields_of(const httplib::Request& request) {
  OrderFields fields;
  for (const auto& [name, value] : request.params) fields[name] = value;
  return fields;
}

/// Of the Authorization header, or of the form.
std::string token_of(const httplib::Request& request) {
  constexpr std::string_view kBearer = "Bearer ";
  const std::string given = request.get_header_value("Authorization");
  if (given.starts_with(kBearer)) return given.substr(kBearer.size());
  return request.get_param_value("token");
}

bool wants_html(const httplib::Request& request) {
  return request.get_header_value("Accept").find("text/html") != std::string::npos;
}

}  // namespace

PageServer::PageServer(const PageSettings& settings)
    : settings_(settings), views_(settings), server_(std::make_unique<httplib::Server>()) {
  // The library's own would let two pages share a port unnoticed.
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
  server_->set_pre_routing_handler(
      [this](const httplib::Request& request, httplib::Response& response) {
        if (is_our_host(request.get_header_value("Host"), settings_)) {
          return httplib::Server::HandlerResponse::Unhandled;
        }
        refuse(response, 421, "this is not that host: name it in [page] hosts");
        return httplib::Server::HandlerResponse::Handled;
      });
  server_->set_exception_handler(
      [](const httplib::Request&, httplib::Response& response, const std::exception_ptr&) {
        refuse(response, 500, "the page could not be made");
      });
  add_pages();
  add_answers();
  server_->Post("/orders", [this](const httplib::Request& request, httplib::Response& response) {
    take_order(request, response);
  });
}

PageServer::~PageServer() = default;

void PageServer::add_pages() {
  const auto get = [this](const char* path, const char* type,
                          const std::function<std::string()>& content) {
    server_->Get(path, [content, type](const httplib::Request&, httplib::Response& response) {
      response.set_content(content(), type);
    });
  };
  get("/", kHtml, [this] { return page_html(*views_.newest(), settings_); });
  get("/statement", kHtml, [this] { return statement_html(*views_.newest(), settings_); });
  get("/page.css", "text/css; charset=utf-8", [] { return std::string(page_file("page.css")); });
  get("/page.js", "text/javascript; charset=utf-8",
      [] { return std::string(page_file("page.js")); });
  get("/metrics", "text/plain; version=0.0.4; charset=utf-8",
      [this] { return views_.newest()->metrics; });
}

void PageServer::add_answers() {
  const auto get = [this](const char* path,
                          const std::function<std::string(const ControllerView&)>& content) {
    server_->Get(path, [this, content](const httplib::Request&, httplib::Response& response) {
      response.set_content(content(*views_.newest()), kJson);
    });
  };
  const auto text_of = [](const Answer& answer) {
    return answer.trouble.empty() ? answer.json.text()
                                  : Json::object({{"trouble", answer.trouble}}).text();
  };
  get("/api/status", [text_of](const ControllerView& view) { return text_of(view.status); });
  get("/api/why", [text_of](const ControllerView& view) { return text_of(view.why); });
  get("/api/month", [text_of](const ControllerView& view) { return text_of(view.month); });
  get("/api/history", [text_of](const ControllerView& view) { return text_of(view.history); });
  get("/api/today", [](const ControllerView& view) { return day_json(view.day_records).text(); });
  get("/api/map", [](const ControllerView& view) {
    return (view.map ? decision_map_json(*view.map) : Json::object()).text();
  });
}

void PageServer::take_order(const httplib::Request& request, httplib::Response& response) {
  const std::int64_t now_ns = clock_ns(CLOCK_MONOTONIC);
  if (settings_.tokens.is_empty()) {
    return refuse(response, 403, "nothing may be ordered here: [page] token_file is not set");
  }
  if (!is_our_origin(request.get_header_value("Origin"), settings_)) {
    return refuse(response, 403, "an order must come from this page");
  }
  if (wrong_tokens_.are_too_many(now_ns)) {
    return refuse(response, 429, "too many wrong tokens: try again in a minute");
  }
  const std::string who(settings_.tokens.owner_of(token_of(request)));
  if (who.empty()) {
    wrong_tokens_.count(now_ns);
    write_journal_line(JournalLevel::kWarning,
                       "bess-page: an order with a wrong token, from " + request.remote_addr);
    return refuse(response, 401, "the token is wrong");
  }
  OrderOutcome outcome;
  Order order = read_order(fields_of(request));
  if (!order.complaint.empty()) {
    outcome = {order.complaint, true};
  } else {
    std::string said;
    for (const std::string& word : order.words) said += ' ' + word;
    order.words.insert(order.words.begin(), settings_.program);
    order.words.insert(order.words.end(), {"--config", settings_.config_path});
    const ProgramResult result = run_and_hear(order.words, kOrderS);
    outcome = {result.is_well() ? one_line(result.output, 400) : result.complaint(),
               !result.is_well()};
    write_journal_line(JournalLevel::kNotice, "bess-page: " + who + " orders:" + said + ": " +
                                                  (outcome.is_refused ? outcome.text : "done"));
    views_.expire();
  }
  response.status = outcome.is_refused ? 422 : 200;
  if (wants_html(request)) {
    response.set_content(page_html(*views_.newest(), settings_, outcome), kHtml);
  } else {
    response.set_content(
        Json::object({{"done", !outcome.is_refused}, {"said", outcome.text}}).text(), kJson);
  }
}

bool PageServer::bind(std::string& error) {
  port_ = settings_.port;
  const bool is_bound = settings_.port == 0
                            ? (port_ = server_->bind_to_any_port(settings_.host)) > 0
                            : server_->bind_to_port(settings_.host, settings_.port);
  if (!is_bound) {
    error = "[page] host, port: " + settings_.host + ":" + std::to_string(settings_.port) +
            " cannot be listened on: is another program there?";
  }
  // The library's own queue is five long: a sixth client would wait for a second.
  if (is_bound) ::listen(listening_socket_, kQueued);
  return is_bound;
}

void PageServer::serve() { server_->listen_after_bind(); }
void PageServer::stop() { server_->stop(); }

}  // namespace bess
