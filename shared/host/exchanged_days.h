// Settled prices by quarter-hour, and energy (exchange.h) and money by local days at these prices,
// with the costs of a contract.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>

#include "shared/battery_model.h"
#include "shared/host/exchange.h"

namespace bess {

// Prices of quarter-hours: the settled price if published, else the newest minute in the log as an
// estimate. The same for the battery and all policies in a comparison.

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

  /// Price known to the control cycle at `tick_utc_s`, in any order; the first control cycle after
  /// a quarter-hour knows its last minutes.
  void note(std::int64_t tick_utc_s, std::int64_t minute_utc_s, double eur_per_mwh);

  /// Price of the quarter-hour at an instant. Empty: neither published nor in the log.
  [[nodiscard]] std::optional<SettledQuarter> find(std::int64_t utc_s) const;

 private:
  struct Price {
    std::int64_t minute_utc_s = 0;
    SettledQuarter quarter{};
  };
  std::map<std::int64_t, Price> prices_;  ///< by the start of the quarter-hour
};

struct QuarterHourMoney {
  double earned_eur = 0;          ///< before the contract
  double estimated_eur = 0;       ///< part of it without published prices
  double contract_eur = 0;        ///< costs of the contract, with wear
  double prices_eur_per_mwh = 0;  ///< sum over quarter-hours with a price
  int quarter_hours = 0;          ///< in the log
  int published = 0;              ///< with published prices, including validated ones
  int validated = 0;
  int unpriced = 0;  ///< without a price: not in the money

  [[nodiscard]] double net_eur() const { return earned_eur - contract_eur; }
  /// 0 without prices.
  [[nodiscard]] double mean_price_eur_per_mwh() const;
  void add(const QuarterHourMoney& other);
};

/// One local day; energies grid side, not negative.
struct ExchangedDay {
  double charged_wh = 0;
  double discharged_wh = 0;
  double unseen_wh = 0;  ///< of both, from the state of charge only
  QuarterHourMoney money{};

  void add(const ExchangedDay& other);
};

/// By local day, as 20231126; `samples` oldest first. Uses costs and wear of `terms`.
std::map<std::int32_t, ExchangedDay> exchanged_days(std::span<const ExchangeSample> samples,
                                                    const QuarterPrices& prices,
                                                    const BatteryParameters& terms);

}  // namespace bess
