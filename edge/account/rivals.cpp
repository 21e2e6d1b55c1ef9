#include "edge/account/rivals.h"

#include <algorithm>
#include <array>

#include "edge/account/account_days.h"
#include "shared/host/text.h"

namespace bess {
namespace {

constexpr int kSocLevels = 241;
constexpr Action kActions[] = {Action::kDischarge, Action::kIdle, Action::kCharge};

double mean_eur_per_mwh(std::span<const PricedCycle> cycles) {
  double sum = 0;
  for (const PricedCycle& cycle : cycles) sum += eur_per_mwh(cycle);
  return cycles.empty() ? 0 : sum / static_cast<double>(cycles.size());
}

/// `decide(index of the cycle, SoC)`, over all cycles; what is stored besides counts at the mean.
template <typename Decide>
double drive(std::span<const PricedCycle> cycles, double soc_frac, const BatteryParameters& battery,
             const Decide& decide) {
  const Driven driven = drive_through(cycles, soc_frac, battery, decide);
  const double stored_mwh = (driven.soc_frac - soc_frac) * battery.capacity_wh / kWattsPerMegawatt;
  return driven.earned_eur + stored_mwh * mean_eur_per_mwh(cycles);
}

/// What a state of charge is worth before each cycle, on a grid over the window; linear between.
/// From the last cycle to the first; of that only every 150th is kept, and a block between two of
/// them made again when it is asked for: a month fits into a small memory.
class ValueOfCharge {
 public:
  ValueOfCharge(std::span<const PricedCycle> cycles, const BatteryParameters& battery)
      : cycles_(cycles), battery_(battery), anchors_(cycles.size() / kBlock + 2) {
    Values values{};
    const double mean = mean_eur_per_mwh(cycles);
    for (int level = 0; level < kSocLevels; ++level) {
      values[at(level)] =
          static_cast<float>(soc_of(level) * battery.capacity_wh / kWattsPerMegawatt * mean);
    }
    anchors_.back() = values;
    for (std::size_t i = cycles.size(); i-- > 0;) {
      values = before(i, values);
      if (i % kBlock == 0) anchors_[i / kBlock] = values;
    }
  }

  /// Cycles one after the other, from the first.
  [[nodiscard]] Action best(std::size_t cycle, double soc_frac) {
    if (cycle % kBlock == 0) make_block(cycle);
    std::array<double, kActionCount> values{};
    for (const Action action : kActions) {
      values[static_cast<std::size_t>(action)] =
          value_of(cycle, soc_frac, action, block_[cycle % kBlock + 1]);
    }
    return argmax_action(values.data());
  }

 private:
  static constexpr std::size_t kBlock = 150;
  using Values = std::array<float, kSocLevels>;

  static std::size_t at(int level) { return static_cast<std::size_t>(level); }
  [[nodiscard]] double soc_of(int level) const {
    return battery_.soc_min_frac +
           (battery_.soc_max_frac - battery_.soc_min_frac) * level / (kSocLevels - 1);
  }

  void make_block(std::size_t first) {
    const std::size_t last = std::min(first + kBlock, cycles_.size());
    block_[last - first] = last == cycles_.size() ? anchors_.back() : anchors_[last / kBlock];
    for (std::size_t i = last; i-- > first;) block_[i - first] = before(i, block_[i - first + 1]);
  }

  [[nodiscard]] Values before(std::size_t cycle, const Values& after) const {
    Values values{};
    for (int level = 0; level < kSocLevels; ++level) {
      double best = -1e30;
      for (const Action action : kActions) {
        best = std::max(best, value_of(cycle, soc_of(level), action, after));
      }
      values[at(level)] = static_cast<float>(best);
    }
    return values;
  }

  [[nodiscard]] double value_of(std::size_t cycle, double soc_frac, Action action,
                                const Values& after) const {
    const BatteryStep next = full_step(battery_, soc_frac, action);
    const double window = battery_.soc_max_frac - battery_.soc_min_frac;
    const double place =
        std::clamp((next.soc_frac - battery_.soc_min_frac) / window, 0.0, 1.0) * (kSocLevels - 1);
    const int below = std::min(static_cast<int>(place), kSocLevels - 2);
    const double share = place - below;
    return earned_eur(next, eur_per_mwh(cycles_[cycle])) + (1 - share) * after[at(below)] +
           share * after[at(below + 1)];
  }

  std::span<const PricedCycle> cycles_;
  const BatteryParameters& battery_;
  std::vector<Values> anchors_;
  std::array<Values, kBlock + 1> block_{};
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

}  // namespace

std::vector<PricedCycle> priced_cycles(const LogReader& log, std::int32_t first_day,
                                       std::int32_t last_day) {
  std::vector<PricedCycle> cycles;
  for_each_record(log, first_day, last_day, [&](std::int32_t, const CycleRecord& record) {
    if (record.mode == Mode::kStopping || !record.price.has_row) return;
    cycles.push_back(priced_cycle(record));
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
  ValueOfCharge value(cycles, battery);
  rivals.foresight_eur = drive(cycles, soc_frac, battery,
                               [&](std::size_t i, double soc) { return value.best(i, soc); });
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
