// Local server with the answers of energy-charts.
#pragma once

#include <atomic>
#include <string>

#include "tests/support/local_server.h"
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
  explicit FakeCharts(int failures = 0) : failures_(failures) {
    server_.routes().Get(
        "/price", [this](const httplib::Request& request, httplib::Response& response) {
          ++requests;
          if (failures_-- > 0) {
            response.status = 503;
            return;
          }
          const LocalDate from = parse_local_date(request.get_param_value("start"), "start");
          const LocalDate to = parse_local_date(request.get_param_value("end"), "end");
          std::string seconds, prices;
          for (std::int64_t utc_s = local_midnight_utc_s(from);
               utc_s < local_midnight_utc_s(add_days(to, 1)); utc_s += 3600) {
            if (utc_s == missing_utc_s) continue;
            const char* comma = seconds.empty() ? "" : ",";
            seconds += comma + std::to_string(utc_s);
            prices += comma + std::to_string(utc_s / 3600 % 89);
          }
          response.set_content(charts(seconds, prices), "application/json");
        });
    server_.start();
  }
  [[nodiscard]] std::string base_url() const { return server_.url(); }
  std::atomic<int> requests{0};
  std::int64_t missing_utc_s = 0;

 private:
  std::atomic<int> failures_;
  LocalServer server_;  ///< last, so that it stops before the members its thread uses
};

}  // namespace bess
