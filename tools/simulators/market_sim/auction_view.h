// Published day-ahead prices at an instant, as energy-charts JSON
// (`/price?bzn=BE&start=2025-03-29&end=2025-03-30`). A local day is published as a whole at a local
// time of the previous day, or at the time in its file; in hours while the auction sold hours.
// Faults apply to days, not requests: all answers have the same faulty day until its correction.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace bess {

enum class AuctionFault : std::uint8_t {
  // clang-format off
  kNone, kLate, kMissing, kHalf, kShiftedHour, kShiftedDay, kDoubled, kYesterday, kHours,
  kOutOfRange, kHtml, kSlow, kAll,
  // clang-format on
};

inline constexpr std::string_view kAuctionFaultNames[] = {
    "none",      "late",  "missing",      "half", "shifted-hour", "shifted-day", "doubled",
    "yesterday", "hours", "out-of-range", "html", "slow",         "all"};

struct AuctionSettings {
  std::int32_t published_min = 12 * 60 + 57;  ///< local minute of the previous day
  std::int64_t start_utc_s = 0;               ///< of the server
  AuctionFault fault = AuctionFault::kNone;
  std::int32_t every = 1;  ///< every Nth day published in the span
  double from_s = 0;       ///< simulated seconds since the start
  double to_s = std::numeric_limits<double>::infinity();
  std::optional<double> repair_s{};  ///< after publication: the day is corrected
};

struct AuctionAnswer {
  int status = 200;
  std::string body{};
  AuctionFault fault = AuctionFault::kNone;  ///< of its newest faulty day
};

struct AuctionRow {
  std::int64_t utc_s;  ///< start of the quarter-hour
  double eur_per_mwh;
  std::int64_t step_s;           ///< of the product; its price repeats in quarter-hours
  std::int64_t published_utc_s;  ///< 0: at the usual time
};

/// Rows of a day-ahead file (bess-train prices fetch --day-ahead), ascending. Throws UserError
/// naming the line.
std::vector<AuctionRow> parse_auction_rows(std::string_view text, const std::string& name);

class AuctionView {
 public:
  /// Needs the market's time zone, and rows.
  AuctionView(std::vector<AuctionRow> rows, const AuctionSettings& settings)
      : rows_(std::move(rows)), settings_(settings) {}
  /// Local days from `start` to `end`, inclusive; empty: today, and the start.
  [[nodiscard]] AuctionAnswer answer(const std::string& start, const std::string& end,
                                     std::int64_t now_utc_s) const;

 private:
  [[nodiscard]] AuctionFault fault_of(std::int64_t published_utc_s, std::int64_t now_utc_s) const;
  [[nodiscard]] double price_at(std::int64_t utc_s, double otherwise) const;
  void add_day(std::int64_t midnight_utc_s, std::int64_t now_utc_s, AuctionAnswer& answer,
               std::vector<AuctionRow>& published) const;
  void add(AuctionFault fault, AuctionRow row, bool is_noon,
           std::vector<AuctionRow>& published) const;

  std::vector<AuctionRow> rows_;
  AuctionSettings settings_;
};

}  // namespace bess
