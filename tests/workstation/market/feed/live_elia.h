// A local server with the /records of Elia's near-real-time data sets, whose rows a test adds,
// revises and takes away while it is asked.
#pragma once

#include <cmath>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <string>

#include "shared/host/json.h"
#include "shared/utc_text.h"
#include "tests/support/local_server.h"

namespace bess {

/// Newest first, by limit and offset, as the API does.
class LiveElia {
 public:
  /// True when it has answered itself.
  using Fault = std::function<bool(const std::string& dataset, httplib::Response&)>;

  LiveElia() {
    server_.routes().Get(R"(/api/explore/v2\.1/catalog/datasets/(ods\d+)/records)",
                         [this](const httplib::Request& request, httplib::Response& response) {
                           answer(request, response);
                         });
    server_.start();
  }

  [[nodiscard]] std::string base_url() const { return server_.url() + "/api/explore/v2.1"; }
  /// NaN is published as null.
  void publish_price(std::int64_t utc_s, double price, const std::string& quality = "DataIssue") {
    const std::lock_guard lock(mutex_);
    prices_[utc_s] = {price, quality};
  }
  void publish_imbalance(std::int64_t utc_s, double imbalance) {
    const std::lock_guard lock(mutex_);
    imbalances_[utc_s] = {imbalance, "DataIssue"};
  }
  void publish(std::int64_t utc_s, double price, double imbalance) {
    publish_price(utc_s, price);
    publish_imbalance(utc_s, imbalance);
  }
  /// What the source does at local midnight.
  void forget_before(std::int64_t utc_s) {
    const std::lock_guard lock(mutex_);
    prices_.erase(prices_.begin(), prices_.lower_bound(utc_s));
    imbalances_.erase(imbalances_.begin(), imbalances_.lower_bound(utc_s));
  }
  void set_fault(Fault fault) {
    const std::lock_guard lock(mutex_);
    fault_ = std::move(fault);
  }
  int requests() {
    const std::lock_guard lock(mutex_);
    return requests_;
  }

 private:
  struct Row {
    double value;
    std::string quality;
  };

  void answer(const httplib::Request& request, httplib::Response& response) {
    const std::string dataset = request.matches[1];
    Fault fault;
    {
      const std::lock_guard lock(mutex_);
      ++requests_;
      fault = fault_;
    }
    if (fault && fault(dataset, response)) return;
    const auto number = [&request](const char* name) {
      return std::stoul(request.get_param_value(name));
    };
    response.set_content(rows(dataset, number("limit"), number("offset")), "application/json");
  }

  std::string rows(const std::string& dataset, std::size_t limit, std::size_t offset) {
    const std::lock_guard lock(mutex_);
    const bool of_prices = dataset == "ods161";
    const std::map<std::int64_t, Row>& all = of_prices ? prices_ : imbalances_;
    Json results = Json::list();
    std::size_t index = 0;
    for (auto row = all.rbegin(); row != all.rend(); ++row, ++index) {
      if (index < offset || index >= offset + limit) continue;
      const std::string time(utc_text(row->first).view().substr(0, 19));
      results.add(
          Json::object({{"datetime", time + "+00:00"},
                        {"resolutioncode", "PT1M"},
                        {"qualitystatus", row->second.quality},
                        {of_prices ? "imbalanceprice" : "systemimbalance", row->second.value}}));
    }
    return Json::object({{"total_count", all.size()}, {"results", std::move(results)}}).line();
  }

  std::mutex mutex_;
  std::map<std::int64_t, Row> prices_, imbalances_;
  Fault fault_;
  int requests_ = 0;
  LocalServer server_;  ///< the last: it stops before what its thread uses
};

}  // namespace bess
