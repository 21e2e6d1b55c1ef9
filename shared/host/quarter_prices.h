// What quarter-hours are paid at: the settled price where it is published, else, as an estimate,
// the newest of the minutes that the log saw of it. The same for the battery and for every policy
// that it is compared with.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>

namespace bess {

enum class PriceState : std::uint8_t { kIndicative, kPublished, kValidated };

struct SettledQuarter {
  std::int64_t start_utc_s = 0;  ///< a multiple of 900
  double eur_per_mwh = 0;
  PriceState state = PriceState::kPublished;
  friend bool operator==(const SettledQuarter&, const SettledQuarter&) = default;
};

class QuarterPrices {
 public:
  explicit QuarterPrices(std::span<const SettledQuarter> settled);

  /// The price that the cycle at `tick_utc_s` knew. In any order; the minutes of a quarter-hour's
  /// end are seen by the first cycle behind it.
  void note(std::int64_t tick_utc_s, std::int64_t minute_utc_s, double eur_per_mwh);

  /// Of the quarter-hour that holds the instant. None: neither published, nor seen.
  [[nodiscard]] std::optional<SettledQuarter> find(std::int64_t utc_s) const;

 private:
  struct Price {
    std::int64_t minute_utc_s = 0;
    SettledQuarter quarter{};
  };
  std::map<std::int64_t, Price> prices_;  ///< by the start of the quarter-hour
};

}  // namespace bess
