// Settled prices by quarter-hour, and the energy and money of what flowed (exchange.h) by local
// days at these prices. Energy charged and discharged has its own cost beside the price, by the
// terms of a contract (exchange_cost.h).
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>

#include "shared/battery_model.h"
#include "shared/host/exchange.h"

namespace bess {

// What quarter-hours are paid at: the settled price where it is published, else, as an estimate,
// the newest of the minutes that the log saw of it. The same for the battery and for every policy
// that it is compared with.

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

struct QuarterHourMoney {
  double earned_eur = 0;          ///< before the contract
  double estimated_eur = 0;       ///< of it, where nothing is published yet
  double contract_eur = 0;        ///< what the contract takes of it, wear included
  double prices_eur_per_mwh = 0;  ///< the sum of those that have one
  int quarter_hours = 0;          ///< of which the log knows something
  int published = 0;              ///< of those, the validated among them
  int validated = 0;
  int unpriced = 0;  ///< without any price: their energy is not in the money

  [[nodiscard]] double net_eur() const { return earned_eur - contract_eur; }
  /// 0 where none has a price.
  [[nodiscard]] double mean_price_eur_per_mwh() const;
  void add(const QuarterHourMoney& other);
};

/// Of one local day; energies grid side, not negative.
struct ExchangedDay {
  double charged_wh = 0;
  double discharged_wh = 0;
  double unseen_wh = 0;  ///< of both together, by the state of charge alone
  QuarterHourMoney money{};

  void add(const ExchangedDay& other);
};

/// By local day, as 20231126; `samples` oldest first. Of `terms` costs and wear count.
std::map<std::int32_t, ExchangedDay> exchanged_days(std::span<const ExchangeSample> samples,
                                                    const QuarterPrices& prices,
                                                    const BatteryParameters& terms);

}  // namespace bess
