// Published market rows at an instant, as Elia API v2.1 JSON (`/records`). Row m of the minute
// series is computed at the END of minute m and readable `latency_s` later, likewise the settled
// price of a quarter-hour.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "shared/host/minute_file.h"
#include "tools/simulators/market_sim/market_fault.h"

namespace bess {

enum class Dataset : std::uint8_t {
  kMinutes,            ///< ods161: the last 24 hours
  kQuarterHours,       ///< ods162: the last 24 hours
  kMinutesOfPastDays,  ///< ods133: all until the last midnight UTC
};

struct RecordsQuery {
  Dataset dataset = Dataset::kMinutes;
  bool newest_first = true;
  int limit = 10;
  int offset = 0;
};

class MarketView {
 public:
  /// A minute without any price has no row; with a settled price only, a row without price.
  MarketView(MinuteSeries prices, double latency_s)
      : prices_(std::move(prices)), latency_ns_(static_cast<std::int64_t>(latency_s * 1e9)) {}

  /// Answer to `/records` at an instant: one page of the rows published by then, changed by a fault
  /// of its rows or text that began at `fault_utc_s`.
  [[nodiscard]] std::string records(const RecordsQuery& query, std::int64_t now_utc_ns,
                                    MarketFault fault = MarketFault::kNone,
                                    std::int64_t fault_utc_s = 0) const;
  [[nodiscard]] std::int64_t first_utc_s() const { return prices_.start_utc_s; }
  [[nodiscard]] std::int64_t last_utc_s() const { return prices_.utc_s(prices_.size() - 1); }

 private:
  struct Row {
    std::int64_t utc_s;
    double price;
  };
  static void freeze(std::int64_t frozen_utc_s, std::vector<Row>& rows);
  [[nodiscard]] std::vector<Row> visible(Dataset dataset, std::int64_t now_utc_ns) const;
  [[nodiscard]] std::pair<std::size_t, std::size_t> window(Dataset dataset,
                                                           std::int64_t now_utc_ns) const;

  MinuteSeries prices_;
  std::int64_t latency_ns_;
};

}  // namespace bess
