#include "edge/account/rivals.h"

#include <algorithm>
#include <array>

#include "edge/account/account_days.h"
#include "edge/control/policy.h"
#include "shared/host/text.h"

namespace bess {
namespace {

constexpr int kSocLevels = 241;
constexpr Action kActions[] = {Action::kDischarge, Action::kIdle, Action::kCharge};

double eur_per_mwh(const PricedCycle& cycle) {
  return static_cast<double>(cycle.price_centi_eur_per_mwh) / kCentiPerEur;
}

double mean_eur_per_mwh(std::span<const PricedCycle> cycles) {
  double sum = 0;
  for (const PricedCycle& cycle : cycles) sum += eur_per_mwh(cycle);
  return cycles.empty() ? 0 : sum / static_cast<double>(cycles.size());
}

BatteryStep step(const BatteryParameters& battery, double soc_frac, Action action) {
  return battery_step(battery, soc_frac, power_sign(action) * battery.power_w_max, kHoursPerStep);
}

double paid_eur(const BatteryStep& step, double price_eur_per_mwh) {
  return -step.power_w * kHoursPerStep / kWattsPerMegawatt * price_eur_per_mwh;
}

/// `decide(index of the cycle, SoC)`, over all cycles; what is stored besides counts at the mean.
template <typename Decide>
double drive(std::span<const PricedCycle> cycles, double soc_frac, const BatteryParameters& battery,
             const Decide& decide) {
  const double first_frac = soc_frac;
  double earned_eur = 0;
  for (std::size_t i = 0; i < cycles.size(); ++i) {
    const BatteryStep next = step(battery, soc_frac, decide(i, soc_frac));
    earned_eur += paid_eur(next, eur_per_mwh(cycles[i]));
    soc_frac = next.soc_frac;
  }
  const double stored_mwh = (soc_frac - first_frac) * battery.capacity_wh / kWattsPerMegawatt;
  return earned_eur + stored_mwh * mean_eur_per_mwh(cycles);
}

/// What a state of charge is worth before each cycle, on a grid over the window; linear between.
class ValueOfCharge {
 public:
  ValueOfCharge(std::span<const PricedCycle> cycles, const BatteryParameters& battery)
      : battery_(battery), values_(cycles.size() + 1) {
    const double mean = mean_eur_per_mwh(cycles);
    for (int level = 0; level < kSocLevels; ++level) {
      values_.back()[at(level)] =
          static_cast<float>(soc_of(level) * battery.capacity_wh / kWattsPerMegawatt * mean);
    }
    for (std::size_t i = cycles.size(); i-- > 0;) {
      for (int level = 0; level < kSocLevels; ++level) {
        double best = -1e30;
        for (const Action action : kActions) {
          best = std::max(best, value_of(i, soc_of(level), action, eur_per_mwh(cycles[i])));
        }
        values_[i][at(level)] = static_cast<float>(best);
      }
    }
  }

  [[nodiscard]] Action best(std::size_t cycle, double soc_frac, double price_eur_per_mwh) const {
    std::array<double, kActionCount> values{};
    for (const Action action : kActions) {
      values[static_cast<std::size_t>(action)] =
          value_of(cycle, soc_frac, action, price_eur_per_mwh);
    }
    return argmax_action(values.data());
  }

 private:
  static std::size_t at(int level) { return static_cast<std::size_t>(level); }
  [[nodiscard]] double soc_of(int level) const {
    return battery_.soc_min_frac +
           (battery_.soc_max_frac - battery_.soc_min_frac) * level / (kSocLevels - 1);
  }
  [[nodiscard]] double value_of(std::size_t cycle, double soc_frac, Action action,
                                double price_eur_per_mwh) const {
    const BatteryStep next = step(battery_, soc_frac, action);
    const double window = battery_.soc_max_frac - battery_.soc_min_frac;
    const double place =
        std::clamp((next.soc_frac - battery_.soc_min_frac) / window, 0.0, 1.0) * (kSocLevels - 1);
    const int below = std::min(static_cast<int>(place), kSocLevels - 2);
    const auto& values = values_[cycle + 1];
    const double share = place - below;
    return paid_eur(next, price_eur_per_mwh) + (1 - share) * values[at(below)] +
           share * values[at(below + 1)];
  }

  const BatteryParameters& battery_;
  std::vector<std::array<float, kSocLevels>> values_;
};

double earned_by_rule(std::span<const PricedCycle> cycles, double soc_frac,
                      const BatteryParameters& battery, Rivals& rivals) {
  std::vector<std::int32_t> prices;
  prices.reserve(cycles.size());
  for (const PricedCycle& cycle : cycles) prices.push_back(cycle.price_centi_eur_per_mwh);
  std::ranges::sort(prices);
  rivals.rule_low_centi = prices[prices.size() / 4];
  rivals.rule_high_centi = prices[prices.size() * 3 / 4];
  return drive(cycles, soc_frac, battery, [&](std::size_t i, double) {
    const std::int32_t price = cycles[i].price_centi_eur_per_mwh;
    return price < rivals.rule_low_centi    ? Action::kCharge
           : price > rivals.rule_high_centi ? Action::kDischarge
                                            : Action::kIdle;
  });
}

Action decide_undisturbed(const PricedCycle& cycle, double soc_frac,
                          const PriceThresholds& thresholds) {
  const std::int32_t price = cycle.price_centi_eur_per_mwh;
  if (price <= thresholds.low_eur_per_mwh * kCentiPerEur) return Action::kCharge;
  if (price >= thresholds.high_eur_per_mwh * kCentiPerEur) return Action::kDischarge;
  const auto soc_e4 = static_cast<std::int32_t>(soc_frac * kSocFullE4 + 0.5);
  return decide_with_student(
      make_lattice_state(local_minute_of(cycle.utc_s), cycle.context_class, soc_e4, price));
}

}  // namespace

std::vector<PricedCycle> priced_cycles(const LogReader& log, std::int32_t first_day,
                                       std::int32_t last_day) {
  std::vector<PricedCycle> cycles;
  for_each_record(log, first_day, last_day, [&](std::int32_t, const CycleRecord& record) {
    if (record.mode == Mode::kStopping || !record.price.has_row) return;
    const std::int16_t context_class =
        record.context_class > 0
            ? record.context_class
            : student_context_class(local_minute_of(record.utc_s), record.price_level);
    cycles.push_back({record.utc_s, record.price.price_centi_eur_per_mwh, context_class});
  });
  std::ranges::sort(cycles, {}, &PricedCycle::utc_s);
  return cycles;
}

Rivals find_rivals(std::span<const PricedCycle> cycles, double soc_frac,
                   const BatteryParameters& battery, const PriceThresholds& thresholds) {
  Rivals rivals;
  if (cycles.empty() || battery.capacity_wh <= 0) return rivals;
  rivals.rule_eur = earned_by_rule(cycles, soc_frac, battery, rivals);
  rivals.student_eur = drive(cycles, soc_frac, battery, [&](std::size_t i, double soc) {
    return decide_undisturbed(cycles[i], soc, thresholds);
  });
  const ValueOfCharge value(cycles, battery);
  rivals.foresight_eur = drive(cycles, soc_frac, battery, [&](std::size_t i, double soc) {
    return value.best(i, soc, eur_per_mwh(cycles[i]));
  });
  return rivals;
}

std::string rivals_text(const Rivals& rivals, double earned_eur) {
  std::string text;
  add_formatted(
      text,
      "on the same prices, with the same charge at both ends: this battery %+.2f, at rest "
      "0.00, a rule (charge below %.2f, discharge above %.2f) %+.2f, the student "
      "undisturbed %+.2f, foresight %+.2f EUR",
      earned_eur, rivals.rule_low_centi / static_cast<double>(kCentiPerEur),
      rivals.rule_high_centi / static_cast<double>(kCentiPerEur), rivals.rule_eur,
      rivals.student_eur, rivals.foresight_eur);
  if (rivals.foresight_eur > 0) {
    add_formatted(text, "; %.0f %% of foresight", 100 * earned_eur / rivals.foresight_eur);
  }
  return text + "\n";
}

Json rivals_json(const Rivals& rivals, double earned_eur) {
  Json json = Json::object({{"this_battery_eur", Decimals{earned_eur, 4}},
                            {"rest_eur", Decimals{0, 4}},
                            {"rule_eur", Decimals{rivals.rule_eur, 4}},
                            {"student_undisturbed_eur", Decimals{rivals.student_eur, 4}},
                            {"foresight_eur", Decimals{rivals.foresight_eur, 4}}});
  if (rivals.foresight_eur > 0) {
    json.set("share_of_foresight", Decimals{earned_eur / rivals.foresight_eur, 4});
  }
  return json;
}

}  // namespace bess
