// Energy and money by local days from the decision log, at settled prices with the costs of a
// contract; for the ring on the edge and the CSV log on the workstation. The energy flow is
// reconstructed as stretches of constant power, split at quarter-hours.
//
// The power of a sample is measured some seconds before its tick, so it belongs to the previous
// order. Between two samples:
//   power of the older one, until the order of that tick was written; then
//   power of the newer one.
// The time of a write follows from the age of its price. If the newer power is neither the ordered
// nor the previous one, something ended in between (full, empty, an order cut between two ticks);
// and after missed ticks there are no samples. Then the state of charge gives the energy, with the
// efficiency found in the same log.
#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <span>

#include "shared/battery_model.h"
#include "shared/units_and_limits.h"

namespace bess {

/// Relevant values of a control cycle with a reading.
struct ExchangeSample {
  std::int64_t utc_s = 0;
  std::int32_t power_w = 0;
  std::int32_t soc_e4 = 0;
  std::int32_t capacity_wh = 0;
  std::int32_t order_w = 0;
  float written_after_s = 0;  ///< after the tick; 0: unknown
  bool is_ordered = false;    ///< `order_w` is in force from then

  /// Order written when the price of `price_minute_utc_s` had the age `price_age_s`, truncated to
  /// whole seconds: adds half a second.
  void set_written(std::int64_t price_minute_utc_s, std::int32_t price_age_s);
};

struct Exchange {
  double from_utc_s = 0;
  double until_utc_s = 0;
  double energy_wh = 0;  ///< grid side, charge positive
  bool is_seen = true;   ///< false: from the state of charge only

  [[nodiscard]] double charged_wh() const { return std::max(energy_wh, 0.0); }
  [[nodiscard]] double discharged_wh() const { return std::max(-energy_wh, 0.0); }
};

/// Relation of state of charge and energy.
struct ChargeScale {
  double charge_efficiency = 0.9486832980505138;     ///< default until known from the log
  double discharge_efficiency = 0.9486832980505138;  // [SPEC 3]
  std::int32_t soc_step_e4 = 10;                     ///< smallest displayed change
  std::int32_t soc_low_e4 = 0;                       ///< observed limits
  std::int32_t soc_high_e4 = kSocFullE4;

  /// Grid side, charge positive.
  [[nodiscard]] double energy_wh(double moved_e4, double capacity_wh) const;
  [[nodiscard]] double moved_e4(double energy_wh, double capacity_wh) const;
  /// Too coarse for the efficiency of single stretches.
  [[nodiscard]] bool is_coarse() const { return soc_step_e4 >= 50; }
  [[nodiscard]] bool is_at_an_end(std::int32_t soc_e4) const {
    return !stands_still() && (soc_e4 <= soc_low_e4 || soc_e4 >= soc_high_e4);
  }
  [[nodiscard]] bool stands_still() const { return soc_low_e4 == soc_high_e4; }
};

/// From stretches with a single order in force.
ChargeScale charge_scale_of(std::span<const ExchangeSample> samples);

/// `samples` oldest first; a backward clock step restarts. The first sample represents the step
/// that ends there.
void for_each_exchange(std::span<const ExchangeSample> samples,
                       const std::function<void(const Exchange&)>& visit);

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

  void add(const Exchange& exchange);  ///< energy only
  void add(const ExchangedDay& other);
};

/// By local day, as 20231126; `samples` oldest first. Uses costs and wear of `terms`.
std::map<std::int32_t, ExchangedDay> exchanged_days(std::span<const ExchangeSample> samples,
                                                    const QuarterPrices& prices,
                                                    const BatteryParameters& terms);

}  // namespace bess
