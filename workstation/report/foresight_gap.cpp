#include "workstation/report/foresight_gap.h"

#include <algorithm>
#include <limits>

#include "workstation/policy/planners/foresight.h"

namespace bess {
namespace {

/// Tolerance at the ends of the SoC window, below the resolution of the student.
constexpr double kAtTheEndFrac = 0.005;

constexpr std::array<LossCauseText, kLossCauseCount> kTexts{{
    {"dear_missed", "missed high price",
     "discharging was optimal, but the policy did not discharge"},
    {"cheap_missed", "missed low price", "charging was optimal, but the policy did not charge"},
    {"empty", "empty at a high price",
     "too little charge kept or bought: the battery was empty at a high price later that day"},
    {"full", "full at a low price",
     "too much charge kept or bought: the battery was full at a low price later that day"},
    {"timing", "sold or bought too early", "idle was optimal"},
    {"newest_price", "newest price differs from paid price",
     "with the paid price as input, the student would have decided better"},
    {"outage", "price outage", "the same, while the newest price was late"},
    {"rules", "a rule or the guard",
     "without the rules the plain student would have decided better"},
    {"correction", "the correction",
     "the student without correction would have decided better at the same SoC"},
    {"cycle_limit", "cycle limit", "the full cycles of the day were used up, or saved for later"},
    {"rounding", "rounding", "of the foresight plan, which uses a SoC grid"},
}};

double median_paid(const std::vector<StepRecord>& records) {
  std::vector<double> paid;
  for (const StepRecord& r : records) paid.push_back(r.paid_eur_per_mwh);
  std::ranges::nth_element(paid, paid.begin() + static_cast<std::ptrdiff_t>(paid.size() / 2));
  return paid[paid.size() / 2];
}

/// Extreme prices after each step at which the battery is at an end of its SoC window.
struct RemainingExtremes {
  std::vector<double> dearest_while_empty;  ///< paid, EUR/MWh; -inf: not empty later
  std::vector<double> cheapest_while_full;  ///< +inf: not full later
  double usual_eur_per_mwh;                 ///< median of the day

  RemainingExtremes(const std::vector<StepRecord>& records, const BatteryParameters& battery)
      : dearest_while_empty(records.size()),
        cheapest_while_full(records.size()),
        usual_eur_per_mwh(median_paid(records)) {
    double dearest = -std::numeric_limits<double>::infinity();
    double cheapest = std::numeric_limits<double>::infinity();
    for (std::size_t i = records.size(); i-- > 0;) {
      dearest_while_empty[i] = dearest;
      cheapest_while_full[i] = cheapest;
      const StepRecord& r = records[i];
      if (r.soc_frac <= battery.soc_min_frac + kAtTheEndFrac) {
        dearest = std::max(dearest, r.paid_eur_per_mwh);
      }
      if (r.soc_frac >= battery.soc_max_frac - kAtTheEndFrac) {
        cheapest = std::min(cheapest, r.paid_eur_per_mwh);
      }
    }
  }

  /// Empty later at a higher price that is further from the median.
  [[nodiscard]] bool empty_is_to_blame(std::size_t i, double paid) const {
    const double dear = dearest_while_empty[i];
    return dear >= paid && dear - usual_eur_per_mwh >= usual_eur_per_mwh - paid;
  }
  [[nodiscard]] bool full_is_to_blame(std::size_t i, double paid) const {
    const double cheap = cheapest_while_full[i];
    return cheap <= paid && usual_eur_per_mwh - cheap >= paid - usual_eur_per_mwh;
  }
};

/// Step with the paid price as newest price.
MarketStep with_paid_price_shown(MarketStep step) {
  step.observed_eur_per_mwh = step.paid_eur_per_mwh;
  step.observed_age_min = 0;
  return step;
}

/// Action at a step and SoC, with its value.
struct Answer {
  Action action;
  double worth_eur;
};

/// Losses of one day of one policy.
struct DayJudge {
  const LossChain& chain;
  const BatteryParameters& battery;
  const ForesightPolicy& bound;
  int usual_age_min;

  void judge(std::span<const MarketStep> steps, const std::vector<StepRecord>& records,
             DayLoss& loss) const {
    const RemainingExtremes ends(records, battery);
    for (std::size_t i = 0; i < steps.size(); ++i) judge_step(i, steps[i], records[i], ends, loss);
    double sum = 0;
    for (const double part : loss.part_eur) sum += part;
    // With a cycle limit, the plan includes the shadow price of throughput, which is not in
    // profits.
    const LossCause rest =
        battery.cycles_per_day_max > 0 ? LossCause::kCycleLimit : LossCause::kRounding;
    loss.part_eur[static_cast<std::size_t>(rest)] += loss.missed_eur() - sum;
  }

  [[nodiscard]] Answer answer(std::size_t i, double soc_frac, Action action, double share) const {
    return {action, bound.worth_eur(i, soc_frac, power_sign(action) * battery.power_w_max * share)};
  }
  [[nodiscard]] Answer ask(const Policy& policy, const MarketStep& shown, std::size_t i,
                           double soc_frac) const {
    return answer(i, soc_frac, policy.decide(shown, i, soc_frac),
                  policy.power_share_max(shown, soc_frac));
  }
  [[nodiscard]] Answer best(std::size_t i, double soc_frac) const {
    Answer best = answer(i, soc_frac, Action::kIdle, 1);
    for (const Action action : {Action::kDischarge, Action::kCharge}) {
      const Answer other = answer(i, soc_frac, action, 1);
      if (other.worth_eur > best.worth_eur) best = other;
    }
    return best;
  }

  void judge_step(std::size_t i, const MarketStep& step, const StepRecord& record,
                  const RemainingExtremes& ends, DayLoss& loss) const {
    const double soc = record.soc_frac;
    const Answer optimum = best(i, soc);
    const Answer done{record.action, bound.worth_eur(i, soc, record.power_w)};
    const std::size_t hour = static_cast<std::size_t>(step.quarter_hour) / 4;
    loss.regret_eur[hour] += optimum.worth_eur - done.worth_eur;
    Answer now = done;
    const auto add = [&](LossCause cause, const Answer& freer) {
      const auto c = static_cast<std::size_t>(cause);
      const double eur = freer.worth_eur - now.worth_eur;
      loss.part_eur[c] += eur;
      if (eur > loss.moment[c].eur) {
        loss.moment[c] = {eur, step, soc, record.action, optimum.action};
      }
      now = freer;
    };
    const Policy* last = &chain.policy;
    const Answer wanted = ask(*last, step, i, soc);
    if (wanted.action != record.action) {  // cycle limit reached
      add(LossCause::kCycleLimit, optimum);
      return;
    }
    if (chain.under_rules != nullptr) {
      last = chain.under_rules;
      add(LossCause::kCorrection, ask(*last, step, i, soc));
    }
    if (chain.plain != nullptr) {
      last = chain.plain;
      const bool has_rules = chain.under_rules != nullptr;
      add(has_rules ? LossCause::kRules : LossCause::kCorrection, ask(*last, step, i, soc));
    }
    add(step.observed_age_min > usual_age_min ? LossCause::kOutage : LossCause::kNewestPrice,
        ask(*last, with_paid_price_shown(step), i, soc));
    add(cause_of_the_future(now.action, optimum.action, step.paid_eur_per_mwh, i, ends), optimum);
  }

  static LossCause cause_of_the_future(Action wanted, Action best, double paid_eur_per_mwh,
                                       std::size_t i, const RemainingExtremes& ends) {
    const bool leaves_too_little = power_sign(wanted) < power_sign(best);
    if (leaves_too_little && ends.empty_is_to_blame(i, paid_eur_per_mwh)) return LossCause::kEmpty;
    if (!leaves_too_little && ends.full_is_to_blame(i, paid_eur_per_mwh)) return LossCause::kFull;
    if (best == Action::kDischarge) return LossCause::kDearMissed;
    if (best == Action::kCharge) return LossCause::kCheapMissed;
    return LossCause::kTiming;
  }
};

}  // namespace

const LossCauseText& text_of(LossCause cause) { return kTexts[static_cast<std::size_t>(cause)]; }

LossCause DayLoss::main_cause() const {
  return static_cast<LossCause>(std::ranges::max_element(part_eur) - part_eur.begin());
}

std::vector<DayLoss> foresight_gap(const MarketSteps& market, const std::vector<MarketDay>& days,
                                   const LossChain& chain, const BatteryParameters& battery,
                                   double initial_soc_frac) {
  const EvaluationOptions options{battery, initial_soc_frac, false};
  const auto youngest = std::ranges::min_element(market.steps, {}, &MarketStep::observed_age_min);
  const int usual_age_min = youngest == market.steps.end() ? 0 : youngest->observed_age_min;
  std::vector<DayLoss> losses;
  for (const MarketDay& day : days) {
    ForesightPolicy bound(battery);
    std::vector<StepRecord> records;
    DayLoss loss{.date = day.date()};
    loss.foresight_eur = evaluate(market, {day}, bound, options).days.front().profit_eur;
    loss.earned_eur =
        evaluate(market, {day}, chain.policy, options, &records).days.front().profit_eur;
    DayJudge{chain, battery, bound, usual_age_min}.judge(market.of(day), records, loss);
    losses.push_back(std::move(loss));
  }
  return losses;
}

}  // namespace bess
