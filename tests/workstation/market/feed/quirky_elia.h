// A server on loopback that answers like Elia's API but for one quirk: what it says is put together
// byte by byte, so that it can be cut, packed, counted wrongly or sent by somebody else.
#pragma once

#include <fmt/core.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <functional>
#include <map>
#include <string>
#include <thread>
#include <vector>

#include "shared/utc_text.h"
#include "tests/support/test_server.h"

namespace bess {

/// What the program asked for.
struct Ask {
  std::string dataset;
  std::int64_t from_utc_s = 0, until_utc_s = 0;
  bool wants_total = false;  ///< the server's count instead of rows
  int number = 0;            ///< of the requests for rows of this dataset, from 1
  [[nodiscard]] bool minutes() const { return dataset == "ods046"; }
  [[nodiscard]] std::int64_t step_s() const { return minutes() ? 60 : 900; }
};

struct QuirkyRow {
  std::int64_t utc_s;
  std::string price;
};

/// An answer before it is sent.
struct Answer {
  std::vector<QuirkyRow> rows;
  std::string status = "200 OK";
  std::string headers;
  /// Text of the rows; `body` when that is empty.
  std::function<std::string(const Ask&, const std::vector<QuirkyRow>&)> format;
  std::string body;
  bool has_length = true;
  std::size_t sent_max = std::string::npos;  ///< bytes of the body, the length notwithstanding
  int drip_ms = 0;                           ///< between single bytes of the body
};

inline std::string quirky_csv(const Ask& ask, const std::vector<QuirkyRow>& rows,
                              const std::string& separator = ";", const std::string& end = "\n") {
  std::string text = "datetime" + separator + "resolutioncode" + separator + "imbalanceprice" + end;
  for (const QuirkyRow& row : rows) {
    text += std::string(utc_text(row.utc_s).view().substr(0, 19)) + "+00:00" + separator +
            (ask.minutes() ? "PT1M" : "PT15M") + separator + row.price + end;
  }
  return text;
}

inline std::string quirky_price(const Ask& ask, std::int64_t utc_s) {
  const double settled = std::round(90 + 60 * std::sin(static_cast<double>(utc_s / 900)));
  const auto minute = static_cast<double>(utc_s % 900 / 60);
  return fmt::format("{}", ask.minutes() ? settled + 5.25 - minute : settled);
}

/// The rows of [from, until).
inline std::vector<QuirkyRow> quirky_rows(const Ask& ask, std::int64_t from_utc_s,
                                          std::int64_t until_utc_s) {
  std::vector<QuirkyRow> rows;
  for (std::int64_t utc_s = from_utc_s; utc_s < until_utc_s; utc_s += ask.step_s()) {
    rows.push_back({utc_s, quirky_price(ask, utc_s)});
  }
  return rows;
}

class QuirkyElia {
 public:
  using Quirk = std::function<void(const Ask&, Answer&)>;

  explicit QuirkyElia(Quirk quirk)
      : quirk_(std::move(quirk)),
        server_([this](TestConnection& connection, const std::string& request) {
          return answer(connection, request);
        }) {}

  [[nodiscard]] std::string base_url() const {
    return "http://127.0.0.1:" + std::to_string(server_.port()) + "/api/explore/v2.1";
  }
  /// Requests for rows of minutes.
  [[nodiscard]] int minute_requests() const { return requests_.at("ods046"); }

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

  Ask parse(const std::string& request) {
    Ask ask;
    const std::string line = decoded(request.substr(0, request.find('\n')));
    ask.dataset = line.substr(line.find("/ods") + 1, 6);
    ask.wants_total = line.find("/records?") != line.npos;
    EXPECT_TRUE(parse_utc(line.substr(line.find(">= \"") + 4, 25), ask.from_utc_s)) << line;
    EXPECT_TRUE(parse_utc(line.substr(line.find("< \"") + 3, 25), ask.until_utc_s)) << line;
    if (!ask.wants_total) ask.number = ++requests_[ask.dataset];
    return ask;
  }

  bool answer(TestConnection& connection, const std::string& request) {
    const Ask ask = parse(request);
    Answer answer;
    answer.rows = quirky_rows(ask, ask.from_utc_s, ask.until_utc_s);
    answer.format = [](const Ask& of, const std::vector<QuirkyRow>& rows) {
      return of.wants_total ? fmt::format("{{\"total_count\": {}, \"results\": []}}", rows.size())
                            : quirky_csv(of, rows);
    };
    quirk_(ask, answer);
    const std::string body =
        answer.body.empty() && answer.format ? answer.format(ask, answer.rows) : answer.body;
    std::string head = "HTTP/1.1 " + answer.status + "\r\nConnection: close\r\n" + answer.headers;
    if (answer.has_length) head += "Content-Length: " + std::to_string(body.size()) + "\r\n";
    const std::string sent = body.substr(0, answer.sent_max);
    if (answer.drip_ms > 0) {
      connection.send(head + "\r\n");
      for (const char c : sent) {
        std::this_thread::sleep_for(std::chrono::milliseconds(answer.drip_ms));
        if (server_.is_stopping() || !connection.send(std::string(1, c))) break;
      }
      return false;
    }
    connection.send(head + "\r\n" + sent);
    return false;
  }

  Quirk quirk_;
  std::map<std::string, int> requests_{{"ods046", 0}};
  TestServer server_;
};

}  // namespace bess
