#include "workstation/policy/rl/train.h"

#include <algorithm>
#include <cmath>

namespace bess {
namespace {

/// Shifts a normalised input within its range.
void move_input(float& x, double shift) {
  x = std::clamp(x + static_cast<float>(shift), 0.0F, 1.0F);
}

}  // namespace

TrainingMarket::TrainingMarket(const MarketSteps& market, const PriceMap& price_map,
                               const BatteryParameters& battery, Horizon horizon,
                               const RewardShaping& shaping, const ContextClasses& context)
    : battery_(shaping.program ? shaping.program.battery() : battery), price_map_(price_map) {
  const std::vector<MarketDay> training = market.days_of(Split::kTrain);
  require_training_days(training.size());
  if (shaping.program) program_.emplace(shaping.program, market, training, shaping.threads);
  const TradingCosts& costs = battery_.costs;
  for (std::size_t d = 0; d < training.size(); ++d) {
    const std::size_t first = steps_.size();
    const auto steps = market.of(training[d]);
    for (std::size_t i = 0; i < steps.size(); ++i) {
      const bool last = i + 1 == steps.size();
      // The successor of a day's last step is the first step of the next training day, if adjacent.
      // The last step of a block has no permitted successor and is omitted.
      const MarketStep* next = last ? nullptr : &steps[i + 1];
      if (last && d + 1 < training.size()) next = &market.of(training[d + 1])[0];
      const bool follows = next != nullptr && next->utc_s == steps[i].utc_s + kSecondsPerStep;
      const bool terminal = last && horizon == Horizon::kDay;
      if (!follows && !terminal) continue;
      const NetworkContext here = network_context(steps[i], price_map, context);
      Step step{here,
                follows ? network_context(*next, price_map, context) : here,
                static_cast<float>(costs.import_eur_per_mwh(steps[i].paid_eur_per_mwh)),
                static_cast<float>(costs.export_eur_per_mwh(steps[i].paid_eur_per_mwh)),
                terminal,
                steps[i].quarter_hour};
      if (program_) {
        step.row = program_->row_of(steps[i]);
        step.next_row = program_->row_of(follows ? *next : steps[i]);
        step.begins_anew = program_->is_outlook() ? program_->begins_plan(step.next_row) : last;
        step.follows_last = !steps_.empty() && steps_.back().next_row == step.row;
      }
      steps_.push_back(step);
    }
    days_.push_back({first, steps_.size() - first});
  }
  if (program_) centre_residuals();
}

double TrainingMarket::make_transition(std::size_t index, double soc_frac, Action action,
                                       Transition& out) const {
  const Step& step = steps_[index];
  const double wanted_w = power_sign(action) * battery_.power_w_at(step.quarter_hour);
  const BatteryStep moved = battery_step(battery_, soc_frac, wanted_w, kHoursPerStep);
  write_input(seen(step.context, step.row, soc_frac), soc_frac, out.state);
  write_input(seen(step.next, step.next_row, moved.soc_frac), moved.soc_frac, out.next_state);
  // r = -p * price in EUR/h for a battery of the paper's 4 MW: scaled by P, so that the same
  // support and learning rate serve every size [SPEC 3, 4]. Money as exchange_cost_eur, in float.
  const auto power_frac = static_cast<float>(moved.power_w / battery_.power_w_max);
  const auto wear = static_cast<float>(battery_.wear_eur_per_mwh);
  const float price = power_frac > 0 ? step.import_eur_per_mwh : step.export_eur_per_mwh;
  const float paid_eur_per_h = power_frac * price + std::fabs(power_frac) * wear;
  out.reward = -paid_eur_per_h * kPaperPowerMw * kRewardScale - reward_centre_;
  out.action = static_cast<std::int32_t>(action);
  out.terminal = step.terminal ? 1 : 0;
  if (program_) {
    shape_by_program(step, soc_frac, moved.soc_frac, out);
  } else {
    std::ranges::fill(out.next_advantage, 0.0F);
  }
  return moved.soc_frac;
}

NetworkContext TrainingMarket::seen(NetworkContext context, std::uint32_t row,
                                    double soc_frac) const {
  if (program_ && program_->is_outlook()) {
    context.context_class = price_map_(program_->break_even(row, soc_frac));
  }
  return context;
}

/// r' and A(s', .) of teacher.h.
void TrainingMarket::shape_by_program(const Step& step, double soc_frac, double next_soc_frac,
                                      Transition& out) const {
  const ProgramRows::Values here = program_->at(step.row, soc_frac);
  const ProgramRows::Values next = program_->at(step.next_row, next_soc_frac);
  out.reward += static_cast<float>(program_->gamma()) * next.best -
                here.action[static_cast<std::size_t>(out.action)];
  out.reward -= step.centre;
  for (int b = 0; b < kActionCount; ++b) out.next_advantage[b] = next.action[b] - next.best;
}

template <typename Visit>
void TrainingMarket::trade_by_program(Visit visit) const {
  double soc_frac = middle_soc_frac();
  Transition transition{};
  for (std::size_t i = 0; i < steps_.size(); ++i) {
    if (!steps_[i].follows_last) soc_frac = middle_soc_frac();
    const Action action = argmax_action(program_->at(steps_[i].row, soc_frac).action.data());
    soc_frac = make_transition(i, soc_frac, action, transition);
    visit(steps_[i], transition);
  }
}

/// Centring: r' is zero on average where the program trades, with a separate mean where its values
/// begin a new plan: at midnight, a day more. With the outlook each plan has new information, and
/// the r' of an idle step in the middle of the window is subtracted from that step. It is equal for
/// every action and SoC, so no decision changes, and it removes much noise, 40 % of the loss.
void TrainingMarket::centre_residuals() {
  for (std::size_t i = 0; i < steps_.size() && program_->is_outlook(); ++i) {
    Transition idle{};
    make_transition(i, middle_soc_frac(), Action::kIdle, idle);
    steps_[i].centre = idle.reward;
  }
  double sum[2] = {0, 0};
  double count[2] = {1e-9, 1e-9};  // a market may have no midnight
  trade_by_program([&](const Step& step, const Transition& transition) {
    sum[step.begins_anew] += double{transition.reward};
    count[step.begins_anew] += 1;
  });
  reward_centre_ += static_cast<float>(sum[0] / count[0]);
  const auto anew_centre = static_cast<float>(sum[1] / count[1] - sum[0] / count[0]);
  for (Step& step : steps_) {
    if (step.begins_anew) step.centre += anew_centre;
  }
}

std::vector<float> TrainingMarket::residual_returns(double discount) const {
  std::vector<float> returns;
  std::vector<bool> follows;
  trade_by_program([&](const Step& step, const Transition& transition) {
    returns.push_back(transition.reward);
    follows.push_back(step.follows_last);
  });
  for (std::size_t i = returns.size(); i-- > 1;) {
    if (follows[i]) returns[i - 1] += static_cast<float>(discount) * returns[i];
  }
  return returns;
}

std::vector<double> observed_training_prices(const MarketSteps& market) {
  return market.prices_of(market.days_of(Split::kTrain), &MarketStep::observed_eur_per_mwh);
}

void draw_counterfactual(const TrainingMarket& market, std::size_t count,
                         const ContextJitter& jitter, Random& random,
                         std::vector<Transition>& out) {
  constexpr int kQuarterHourInput = 1;  // order of write_input
  constexpr int kContextClassInput = 2;
  out.resize(count);
  std::size_t index = 0;
  double soc_frac = 0;
  double quarter_hour_shift = 0;
  double class_shift = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t action = i % kActionCount;
    if (action == 0) {
      index = random.index(market.step_count());
      soc_frac = market.draw_soc(random);
      quarter_hour_shift = random.normal() * jitter.quarter_hours / (kQuarterHourCount - 1);
      class_shift = random.normal() * jitter.classes / (kContextClassCount - 1);
    }
    Transition& transition = out[i];
    market.make_transition(index, soc_frac, static_cast<Action>(action), transition);
    for (float* x : {transition.state, transition.next_state}) {
      move_input(x[kQuarterHourInput], quarter_hour_shift);
      move_input(x[kContextClassInput], class_shift);
    }
  }
}

}  // namespace bess
