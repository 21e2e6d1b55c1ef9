// Faults of the simulated price server and their schedule.
#pragma once

#include <atomic>
#include <cstdint>
#include <limits>
#include <string_view>

namespace bess {

enum class MarketFault : std::uint8_t {
  kNone,
  kNull,      ///< the newest row's price is null
  kHttp500,   ///< internal server error
  kStale,     ///< the answer is 10 minutes old
  kGarbage,   ///< not JSON
  kTrailing,  ///< more than one document
  kTwice,     ///< each row has its price twice
  kAll,       ///< all in turn
  kFrozen,    ///< the price at the begin of the fault, with new time stamps
};

inline constexpr std::string_view kMarketFaultNames[] = {
    "none", "null", "http-500", "stale", "garbage", "trailing", "twice", "all", "frozen"};

inline constexpr std::int64_t kStaleAnswerS = 600;

struct MarketFaultSchedule {
  MarketFault fault = MarketFault::kNone;
  std::int32_t every = 10;  ///< every Nth request
  double from_s = 0;        ///< simulated seconds since the server's start
  double to_s = std::numeric_limits<double>::infinity();
};

/// Fault of each request. Thread-safe.
class MarketFaultPlan {
 public:
  explicit MarketFaultPlan(const MarketFaultSchedule& schedule) : schedule_(schedule) {}

  MarketFault next(double at_s) {
    const bool is_in_span = at_s >= schedule_.from_s && at_s < schedule_.to_s;
    if (schedule_.fault == MarketFault::kNone || !is_in_span) return MarketFault::kNone;
    const std::int64_t request = ++requests_;
    if (request % schedule_.every != 0) return MarketFault::kNone;
    ++faults_;
    if (schedule_.fault != MarketFault::kAll) return schedule_.fault;
    constexpr auto kCount = static_cast<std::int64_t>(MarketFault::kAll) - 1;  // without none
    return MarketFault(1 + request / schedule_.every % kCount);
  }
  [[nodiscard]] std::int64_t faults() const { return faults_; }  ///< faulty answers so far

 private:
  MarketFaultSchedule schedule_;
  std::atomic<std::int64_t> requests_ = 0;
  std::atomic<std::int64_t> faults_ = 0;
};

}  // namespace bess
