#include "edge/account/rivals.h"

#include <algorithm>
#include <array>

#include "edge/account/account_days.h"
#include "edge/control/policy.h"
#include "edge/control/safety_guard.h"
#include "shared/exchange_cost.h"
#include "shared/local_time.h"

namespace bess {
namespace {

constexpr int kSocLevels = 241;
constexpr Action kActions[] = {Action::kDischarge, Action::kIdle, Action::kCharge};

/// What all of them trade with.
struct Trade {
  std::span<const PricedCycle> cycles;
  double soc_frac;
  const BatteryParameters& battery;
  double mean_eur_per_mwh;

  [[nodiscard]] double stored_eur(double soc_end_frac) const {
    return stored_worth_eur(battery, soc_end_frac - soc_frac, mean_eur_per_mwh);
  }
};

/// `decide(index of the cycle, SoC)`, over all cycles.
template <typename Decide>
Rival drive(const Trade& trade, const Decide& decide) {
  Rival rival;
  Driven before{.soc_frac = trade.soc_frac};
  const auto see = [&](const PricedCycle& cycle, const Driven& driven) {
    rival.by_day[local_day_at(cycle.utc_s)] += driven.earned_eur - before.earned_eur +
                                               trade.stored_eur(driven.soc_frac) -
                                               trade.stored_eur(before.soc_frac);
    before = driven;
  };
  rival.paid_eur =
      drive_through(trade.cycles, trade.soc_frac, trade.battery, decide, see).earned_eur;
  rival.at_equal_charge_eur = rival.paid_eur + trade.stored_eur(before.soc_frac);
  return rival;
}

/// What a state of charge is worth before each cycle, on a grid over the window; linear between.
/// From the last cycle to the first; of that only every 150th is kept, and a block between two of
/// them made again when it is asked for: a month fits into a small memory.
class ValueOfCharge {
 public:
  /// `counts_stored`: what is left at the end has its worth; else it has none.
  ValueOfCharge(const Trade& trade, bool counts_stored)
      : cycles_(trade.cycles), battery_(trade.battery), anchors_(cycles_.size() / kBlock + 2) {
    Values values{};
    for (int level = 0; level < kSocLevels; ++level) {
      for (const Action action : kActions)
        moves_[at(level)][at(action)] = move(soc_of(level), action);
      if (counts_stored) values[at(level)] = static_cast<float>(trade.stored_eur(soc_of(level)));
    }
    anchors_.back() = values;
    for (std::size_t i = cycles_.size(); i-- > 0;) {
      values = before(i, values);
      if (i % kBlock == 0) anchors_[i / kBlock] = values;
    }
  }

  /// Cycles one after the other, from the first.
  [[nodiscard]] Action best(std::size_t cycle, double soc_frac) {
    if (cycle % kBlock == 0) make_block(cycle);
    std::array<double, kActionCount> values{};
    for (const Action action : kActions) {
      values[at(action)] = value_of(cycle, move(soc_frac, action), block_[cycle % kBlock + 1]);
    }
    return argmax_action(values.data());
  }

 private:
  static constexpr std::size_t kBlock = 150;
  using Values = std::array<float, kSocLevels>;
  /// What an action exchanges, and where between two levels it leads.
  struct Move {
    double mwh = 0;
    int below = 0;
    double share = 0;
  };

  static std::size_t at(int level) { return static_cast<std::size_t>(level); }
  static std::size_t at(Action action) { return static_cast<std::size_t>(action); }
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
      for (const Move& move : moves_[at(level)]) {
        best = std::max(best, value_of(cycle, move, after));
      }
      values[at(level)] = static_cast<float>(best);
    }
    return values;
  }

  [[nodiscard]] Move move(double soc_frac, Action action) const {
    const BatteryStep next = full_step(battery_, soc_frac, action);
    const double window = battery_.soc_max_frac - battery_.soc_min_frac;
    const double place =
        std::clamp((next.soc_frac - battery_.soc_min_frac) / window, 0.0, 1.0) * (kSocLevels - 1);
    const int below = std::min(static_cast<int>(place), kSocLevels - 2);
    return {next.power_w * kHoursPerStep / kWattsPerMegawatt, below, place - below};
  }

  [[nodiscard]] double value_of(std::size_t cycle, const Move& move, const Values& after) const {
    return -exchange_cost_eur(battery_, move.mwh, cycles_[cycle].paid_eur_per_mwh) +
           (1 - move.share) * after[at(move.below)] + move.share * after[at(move.below + 1)];
  }

  std::span<const PricedCycle> cycles_;
  const BatteryParameters& battery_;
  std::array<std::array<Move, kActionCount>, kSocLevels> moves_{};
  std::vector<Values> anchors_;
  std::array<Values, kBlock + 1> block_{};
};

Rival drive_knowing(const Trade& trade, bool counts_stored) {
  ValueOfCharge value(trade, counts_stored);
  return drive(trade, [&](std::size_t i, double soc) { return value.best(i, soc); });
}

/// By its rank; moves them.
std::int32_t quantile(std::vector<std::int32_t>& prices, std::size_t rank) {
  const auto at = prices.begin() + static_cast<std::ptrdiff_t>(rank);
  std::ranges::nth_element(prices, at);
  return *at;
}

bool decides_otherwise(const CycleRecord& record, const PricedCycle& cycle) {
  return record.student_action != decide_with_student(make_lattice_state(
                                      local_minute_of(record.utc_s), cycle.context_class,
                                      record.measurement.soc_e4, decided_price_centi(record)));
}

}  // namespace

LoggedMarket logged_market(const LogReader& log, const Period& period, const QuarterPrices& prices,
                           std::int32_t price_age_s_max) {
  LoggedMarket market;
  const auto see = [&](std::int32_t, const CycleRecord& record) {
    const bool has_price =
        record.price_stands_in ||
        (record.price.has_row &&
         price_age_s(record.utc_s, record.price.minute_utc_s) <= price_age_s_max);
    if (record.mode == Mode::kStopping || !has_price) return;
    const PricedCycle cycle = priced_cycle(record, prices);
    market.cycles.push_back(cycle);
    if (!record.has_student_action) return;
    ++market.decided;
    market.decided_otherwise += decides_otherwise(record, cycle) ? 1 : 0;
  };
  for_each_record(log, period.first_day, period.last_day, see);
  std::ranges::sort(market.cycles, {}, &PricedCycle::utc_s);
  const auto at_one_time = [](const PricedCycle& a, const PricedCycle& b) {
    return a.utc_s == b.utc_s;
  };
  market.cycles.erase(std::unique(market.cycles.begin(), market.cycles.end(), at_one_time),
                      market.cycles.end());
  return market;
}

QuartileRule quartile_rule(const LogReader& log, std::int32_t first_day) {
  constexpr int kDays = 30, kDaysMin = 7;
  std::vector<std::int32_t> prices;
  for_each_record(log, day_after(first_day, -kDays), day_after(first_day, -1),
                  [&](std::int32_t, const CycleRecord& record) {
                    if (record.mode == Mode::kStopping || !record.price.has_row) return;
                    prices.push_back(record.price.price_centi_eur_per_mwh);
                  });
  const auto days = static_cast<int>((prices.size() + kStepsPerDay / 2) / kStepsPerDay);
  if (days < kDaysMin) {
    return {student_price_quartile(1) * kCentiPerEur, student_price_quartile(3) * kCentiPerEur};
  }
  return {quantile(prices, prices.size() / 4), quantile(prices, prices.size() * 3 / 4), days};
}

Rivals find_rivals(std::span<const PricedCycle> cycles, double soc_frac,
                   const BatteryParameters& battery, const PriceThresholds& thresholds,
                   const QuartileRule& rule, double mean_eur_per_mwh) {
  if (cycles.empty() || battery.capacity_wh <= 0) return {};
  const Trade trade{cycles, soc_frac, battery, mean_eur_per_mwh};
  Rivals rivals;
  rivals.rule = drive(trade, [&](std::size_t i, double) {
    const std::int32_t price = cycles[i].price_centi_eur_per_mwh;
    return price < rule.low_centi    ? Action::kCharge
           : price > rule.high_centi ? Action::kDischarge
                                     : Action::kIdle;
  });
  rivals.student = drive(trade, [&](std::size_t i, double soc) {
    return decide_undisturbed(cycles[i], soc, thresholds);
  });
  rivals.foresight = drive_knowing(trade, true);
  rivals.foresight.paid_eur = drive_knowing(trade, false).paid_eur;
  return rivals;
}

}  // namespace bess
