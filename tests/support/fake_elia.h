// Fake Elia API on loopback: a test can change its answers byte by byte, to truncate, compress,
// miscount or redirect them.
#pragma once

#include <fmt/core.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <functional>
#include <map>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "shared/utc_text.h"
#include "tests/support/test_server.h"

namespace bess {

/// Request of the program.
struct EliaRequest {
  std::string dataset;
  std::int64_t from_utc_s = 0, until_utc_s = 0;
  bool wants_total = false;  ///< the server's count instead of rows
  int number = 0;            ///< of the requests for rows of this dataset, from 1
  [[nodiscard]] bool minutes() const {
    return dataset == "ods046" || dataset == "ods133" || dataset == "ods161";
  }
};

struct EliaRow {
  std::int64_t utc_s;
  std::string price;
};

/// An answer before it is sent.
struct EliaAnswer {
  std::vector<EliaRow> rows;
  std::string status = "200 OK";
  std::string headers;
  /// Text of the rows; `body` when that is not empty.
  std::function<std::string(const EliaRequest&, const std::vector<EliaRow>&)> format;
  std::string body;
  bool has_length = true;
  std::size_t sent_max = std::string::npos;  ///< bytes of the body, the length notwithstanding
  int drip_ms = 0;                           ///< between single bytes of the body
};

inline std::string elia_csv(const EliaRequest& ask, const std::vector<EliaRow>& rows) {
  std::string text = "datetime;resolutioncode;imbalanceprice\n";
  for (const EliaRow& row : rows) {
    text += std::string(utc_text(row.utc_s).view().substr(0, 19)) + "+00:00;" +
            (ask.minutes() ? "PT1M;" : "PT15M;") + row.price + "\n";
  }
  return text;
}

/// The rows of [from, until): settled prices oscillate, minute prices converge to them.
inline std::vector<EliaRow> elia_rows(const EliaRequest& ask, std::int64_t from_utc_s,
                                      std::int64_t until_utc_s) {
  std::vector<EliaRow> rows;
  for (std::int64_t utc_s = from_utc_s; utc_s < until_utc_s; utc_s += ask.minutes() ? 60 : 900) {
    const double settled = std::round(90 + 60 * std::sin(static_cast<double>(utc_s / 900)));
    const auto minute = static_cast<double>(utc_s % 900 / 60);
    rows.push_back({utc_s, fmt::format("{}", ask.minutes() ? settled + 5.25 - minute : settled)});
  }
  return rows;
}

class FakeElia {
 public:
  using Quirk = std::function<void(const EliaRequest&, EliaAnswer&)>;

  explicit FakeElia(Quirk quirk = [](const EliaRequest&, EliaAnswer&) {})
      : quirk_(std::move(quirk)),
        server_([this](TestConnection& connection, const std::string& request) {
          return answer(connection, request);
        }) {}

  [[nodiscard]] std::string base_url() const {
    return "http://127.0.0.1:" + std::to_string(server_.port()) + "/api/explore/v2.1";
  }
  /// Requests for rows so far, by dataset.
  std::map<std::string, int> requests() {
    const std::lock_guard lock(mutex_);
    return requests_;
  }

 private:
  static std::string decoded(const std::string& text) {
    std::string plain;
    for (std::size_t i = 0; i < text.size(); ++i) {
      const bool escaped = text[i] == '%' && i + 2 < text.size();
      plain += escaped ? static_cast<char>(std::stoi(text.substr(i + 1, 2), nullptr, 16)) : text[i];
      if (escaped) i += 2;
    }
    return plain;
  }

  EliaRequest parse(const std::string& request) {
    EliaRequest ask;
    const std::string line = decoded(request.substr(0, request.find('\n')));
    ask.dataset = line.substr(line.find("/ods") + 1, 6);
    ask.wants_total = line.find("/records?") != line.npos;
    EXPECT_TRUE(parse_utc(line.substr(line.find(">= \"") + 4, 25), ask.from_utc_s)) << line;
    EXPECT_TRUE(parse_utc(line.substr(line.find("< \"") + 3, 25), ask.until_utc_s)) << line;
    const std::lock_guard lock(mutex_);
    ask.number = ask.wants_total ? requests_[ask.dataset] : ++requests_[ask.dataset];
    return ask;
  }

  bool answer(TestConnection& connection, const std::string& request) {
    const EliaRequest ask = parse(request);
    EliaAnswer answer;
    answer.rows = elia_rows(ask, ask.from_utc_s, ask.until_utc_s);
    answer.format = [](const EliaRequest& of, const std::vector<EliaRow>& rows) {
      return of.wants_total ? fmt::format("{{\"total_count\": {}, \"results\": []}}", rows.size())
                            : elia_csv(of, rows);
    };
    quirk_(ask, answer);
    const std::string body =
        answer.body.empty() && answer.format ? answer.format(ask, answer.rows) : answer.body;
    std::string head = "HTTP/1.1 " + answer.status + "\r\nConnection: close\r\n" + answer.headers;
    if (answer.has_length) head += "Content-Length: " + std::to_string(body.size()) + "\r\n";
    const std::string sent = body.substr(0, answer.sent_max);
    connection.send(head + "\r\n" + (answer.drip_ms > 0 ? "" : sent));
    for (const char c : answer.drip_ms > 0 ? sent : "") {
      std::this_thread::sleep_for(std::chrono::milliseconds(answer.drip_ms));
      if (server_.is_stopping() || !connection.send(std::string(1, c))) break;
    }
    return false;
  }

  Quirk quirk_;
  std::mutex mutex_;
  std::map<std::string, int> requests_;
  TestServer server_;  ///< last, so that it stops before the members its thread uses
};

}  // namespace bess
