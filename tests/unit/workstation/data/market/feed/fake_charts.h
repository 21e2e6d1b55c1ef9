// Local server with the answers of energy-charts.
#pragma once

#include <atomic>
#include <string>

#include "tests/support/test_server.h"
#include "workstation/data/market/series/local_date.h"

namespace bess {

inline std::string charts(const std::string& seconds, const std::string& prices,
                          const std::string& unit = "EUR / MWh") {
  return "{\"license_info\":\"CC BY 4.0\",\"unix_seconds\":[" + seconds + "],\"price\":[" + prices +
         "],\"unit\":\"" + unit + "\",\"deprecated\":false}";
}

/// Answers like energy-charts: hours of the requested local days.
class FakeCharts {
 public:
  explicit FakeCharts(int failures = 0) : failures_(failures) {}
  [[nodiscard]] std::string base_url() const {
    return "http://127.0.0.1:" + std::to_string(server_.port());
  }
  [[nodiscard]] int requests() const { return server_.requests(); }

  std::int64_t missing_utc_s = 0;

 private:
  static LocalDate date_in(const std::string& request, const std::string& name) {
    return parse_local_date(request.substr(request.find("&" + name + "=") + name.size() + 2, 10),
                            name);
  }
  [[nodiscard]] std::string hours_of(const std::string& request) const {
    const std::int64_t end_utc_s = local_midnight_utc_s(add_days(date_in(request, "end"), 1));
    std::string seconds, prices;
    for (std::int64_t utc_s = local_midnight_utc_s(date_in(request, "start")); utc_s < end_utc_s;
         utc_s += 3600) {
      if (utc_s == missing_utc_s) continue;
      const char* comma = seconds.empty() ? "" : ",";
      seconds += comma + std::to_string(utc_s);
      prices += comma + std::to_string(utc_s / 3600 % 89);
    }
    return charts(seconds, prices);
  }

  std::atomic<int> failures_;
  /// Last, so that it stops before the members its thread uses.
  TestServer server_{[this](TestConnection& connection, const std::string& request) {
    const bool fails = failures_-- > 0;
    connection.answer(fails ? "" : hours_of(request),
                      std::string(fails ? "HTTP/1.1 503 Busy" : "HTTP/1.1 200 OK") +
                          "\r\nConnection: close\r\nContent-Type: application/json\r\n");
    return false;
  }};
};

}  // namespace bess
