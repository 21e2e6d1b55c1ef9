// A local server that answers like Elia's API, and like it on a bad day when a fault is given.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <map>
#include <mutex>
#include <string>

#include "shared/host/minute_file.h"
#include "shared/utc_text.h"
#include "tests/support/local_server.h"
#include "workstation/market/series/local_date.h"

namespace bess {

enum class FakeRows {
  kMidnights,  ///< one minute and one settled quarter-hour for each local midnight of the window
  kAll,        ///< every minute and every quarter-hour
};

/// Serves the asked window, newest first.
class FakeElia {
 public:
  using Fault = std::function<bool(const std::string& dataset, int request, httplib::Response&)>;

  explicit FakeElia(Fault fault = {}, FakeRows served = FakeRows::kMidnights)
      : fault_(std::move(fault)), served_(served) {
    server_.routes().Get(R"(/api/explore/v2\.1/catalog/datasets/(ods\d+)/exports/csv)",
                         [this](const httplib::Request& request, httplib::Response& response) {
                           answer(request, response);
                         });
    server_.routes().Get(R"(/api/explore/v2\.1/catalog/datasets/(ods\d+)/records)",
                         [this](const httplib::Request& request, httplib::Response& response) {
                           answer_total(request, response);
                         });
    server_.start();
  }

  [[nodiscard]] std::string base_url() const { return server_.url() + "/api/explore/v2.1"; }
  /// Requests seen so far, by dataset.
  std::map<std::string, int> requests() {
    const std::lock_guard lock(mutex_);
    return requests_;
  }

 private:
  void answer(const httplib::Request& request, httplib::Response& response) {
    const std::string dataset = request.matches[1];
    int number = 0;
    {
      const std::lock_guard lock(mutex_);
      number = ++requests_[dataset];
    }
    const bool is_faulty = fault_ && fault_(dataset, number, response);
    {
      const std::lock_guard lock(mutex_);
      is_faulty_[dataset] = is_faulty;
    }
    if (is_faulty) return;
    // cpp-httplib would spend seconds on packing a month of text.
    response.set_content(rows(dataset, request.get_param_value("where")),
                         served_ == FakeRows::kAll ? "application/csv" : "text/csv; charset=utf-8");
  }

  /// The number of rows of a window; nobody knows it while the dataset's answers are at fault.
  void answer_total(const httplib::Request& request, httplib::Response& response) {
    const std::string dataset = request.matches[1];
    const std::lock_guard lock(mutex_);
    if (is_faulty_[dataset]) {
      response.status = 404;
      return;
    }
    const std::string text = rows(dataset, request.get_param_value("where"));
    const auto lines = std::count(text.begin(), text.end(), '\n');
    // without the header and the row too many
    const bool ends_at_a_row = served_ == FakeRows::kAll || lines > 1;
    response.set_content(
        "{\"total_count\":" + std::to_string(lines - (ends_at_a_row ? 2 : 1)) + "}",
        "application/json");
  }

  [[nodiscard]] std::string rows(const std::string& dataset, const std::string& where) const {
    std::int64_t from_utc_s = 0;
    std::int64_t until_utc_s = 0;
    EXPECT_TRUE(parse_utc(where.substr(where.find(">= \"") + 4, 25), from_utc_s)) << where;
    EXPECT_TRUE(parse_utc(where.substr(where.find("< \"") + 3, 25), until_utc_s)) << where;
    const bool minutes = dataset == "ods046" || dataset == "ods133" || dataset == "ods161";
    std::string text =
        "\xEF\xBB\xBF"
        "datetime;resolutioncode;qualitystatus;imbalanceprice\n";
    // newest first, and one row too many: the window's end is exclusive
    const bool all = served_ == FakeRows::kAll;
    const std::int64_t step_s = !all ? 3600 : minutes ? 60 : 900;
    for (std::int64_t utc_s = until_utc_s; utc_s >= from_utc_s; utc_s -= step_s) {
      const int day = all ? static_cast<int>(utc_s / 86'400 % 97) : local_date_of(utc_s).day;
      if (!all && local_midnight_utc_s(local_date_of(utc_s)) != utc_s) continue;
      text += std::string(utc_text(utc_s).view().substr(0, 19)) + "+00:00;" +
              (minutes ? "PT1M" : "PT15M") + ";DataIssue;" + std::to_string(day) +
              (minutes ? ".5" : "") + "\n";
    }
    return text;
  }

  Fault fault_;
  FakeRows served_;
  std::mutex mutex_;
  std::map<std::string, int> requests_;
  std::map<std::string, bool> is_faulty_;
  LocalServer server_;  ///< the last: it stops before what its thread uses
};

}  // namespace bess
