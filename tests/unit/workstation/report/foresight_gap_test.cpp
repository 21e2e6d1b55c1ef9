// Lost money on synthetic days with exactly one cause, and on days with all: the parts add up to
// the missed amount.
#include "workstation/report/foresight_gap.h"

#include <gtest/gtest.h>

#include <functional>
#include <numeric>
#include <random>

#include "workstation/policy/planners/foresight.h"

namespace bess {
namespace {

constexpr std::size_t kSteps = 720;
constexpr std::size_t kMorning = 100;
constexpr std::size_t kEvent = 400;     ///< start of the high or low price
constexpr std::size_t kEventEnd = 420;  ///< 2.67 MWh later: half a battery has them
constexpr std::size_t kEvening = 600;
constexpr double kUsualEurPerMwh = 100;

class FunctionPolicy final : public Policy {
 public:
  using Function = std::function<Action(const MarketStep&, std::size_t, double)>;
  explicit FunctionPolicy(Function function) : function_(std::move(function)) {}
  [[nodiscard]] Action decide(const MarketStep& step, std::size_t index,
                              double soc_frac) const override {
    return function_(step, index, soc_frac);
  }

 private:
  Function function_;
};

/// A day at the usual price except for the event.
MarketSteps day_with(double event_eur_per_mwh) {
  MarketSteps market;
  for (std::size_t i = 0; i < kSteps; ++i) {
    const double price = i >= kEvent && i < kEventEnd ? event_eur_per_mwh : kUsualEurPerMwh;
    market.steps.push_back({.utc_s = static_cast<std::int64_t>(120 * i),
                            .observed_eur_per_mwh = price,
                            .paid_eur_per_mwh = price,
                            .level_centi_eur_per_mwh = 10'000,
                            .observed_age_min = 1,
                            .minute_of_quarter_hour = static_cast<std::int8_t>(2 * i % 15),
                            .quarter_hour = static_cast<std::int8_t>(2 * i / 15),
                            .month = 1,
                            .half_hour_phase = static_cast<std::int8_t>(i % 15)});
  }
  market.days.push_back({2023, 1, 26, Split::kTest, 0, kSteps});
  return market;
}

MarketSteps dear_day() { return day_with(1000); }

/// The price of the event is published late, as the usual one.
MarketSteps hidden_dear_day(int age_min) {
  MarketSteps market = dear_day();
  for (std::size_t i = kEvent; i < kEventEnd; ++i) {
    market.steps[i].observed_eur_per_mwh = kUsualEurPerMwh;
    market.steps[i].observed_age_min = static_cast<std::int16_t>(age_min);
  }
  return market;
}

/// Sells in the evening; or at a visibly high price; in the morning; rests; buys in the event.
Action asleep(const MarketStep&, std::size_t i, double) {
  return i >= kEvening ? Action::kDischarge : Action::kIdle;
}
Action attentive(const MarketStep& step, std::size_t i, double) {
  return step.observed_eur_per_mwh > 500 || i >= kEvening ? Action::kDischarge : Action::kIdle;
}
Action early(const MarketStep&, std::size_t i, double) {
  return i >= kMorning && i < 2 * kMorning ? Action::kDischarge : Action::kIdle;
}
Action resting(const MarketStep&, std::size_t, double) { return Action::kIdle; }
Action buyer(const MarketStep& step, std::size_t i, double soc_frac) {
  return i >= kEvent && i < kEventEnd ? Action::kCharge : asleep(step, i, soc_frac);
}

DayLoss loss_of(const MarketSteps& market, const LossChain& chain, double initial_soc_frac = 0.5,
                const BatteryParameters& battery = {}) {
  return foresight_gap(market, market.days, chain, battery, initial_soc_frac).front();
}

double sum_of(const DayLoss& loss) {
  return std::accumulate(loss.part_eur.begin(), loss.part_eur.end(), 0.0);
}

void expect_alone(const DayLoss& loss, LossCause cause, double missed_eur) {
  const double near_eur = 0.1 + 0.001 * missed_eur;  // the bound's grid
  EXPECT_NEAR(loss.missed_eur(), missed_eur, near_eur);
  EXPECT_NEAR(sum_of(loss), loss.missed_eur(), 1e-9);
  EXPECT_EQ(loss.main_cause(), cause) << text_of(loss.main_cause()).name;
  for (std::size_t c = 0; c < kLossCauseCount; ++c) {
    const double wanted = c == static_cast<std::size_t>(cause) ? loss.missed_eur() : 0;
    EXPECT_NEAR(loss.part_eur[c], wanted, near_eur) << text_of(static_cast<LossCause>(c)).name;
  }
}

constexpr double kStepMwh = 4 * 2.0 / 60;
constexpr double kEventMwh = kStepMwh * (kEventEnd - kEvent);
constexpr double kSpikeEur = kEventMwh * (1000 - kUsualEurPerMwh);

TEST(LostMoney, EachCauseAlone) {
  const struct {
    MarketSteps market;
    FunctionPolicy::Function exported, under, plain;
    double initial_soc_frac;
    LossCause cause;
    double missed_eur;
  } cases[] = {
      {dear_day(), asleep, nullptr, nullptr, 0.5, LossCause::kDearMissed, kSpikeEur},
      {day_with(0), resting, nullptr, nullptr, 0.1, LossCause::kCheapMissed,
       kEventMwh * 0.9 * kUsualEurPerMwh},
      {dear_day(), early, nullptr, nullptr, 0.5, LossCause::kEmpty, kSpikeEur},
      {day_with(-500), asleep, nullptr, nullptr, 1.0, LossCause::kFull,
       kEventMwh * 500 + kEventMwh * 0.9 * kUsualEurPerMwh},
      {day_with(99), buyer, nullptr, nullptr, 0.1, LossCause::kTiming,
       kEventMwh * (99 - 0.9 * kUsualEurPerMwh)},
      {hidden_dear_day(1), attentive, nullptr, nullptr, 0.5, LossCause::kNewestPrice, kSpikeEur},
      {hidden_dear_day(9), attentive, nullptr, nullptr, 0.5, LossCause::kOutage, kSpikeEur},
      {dear_day(), asleep, asleep, attentive, 0.5, LossCause::kRules, kSpikeEur},
      {dear_day(), asleep, nullptr, attentive, 0.5, LossCause::kCorrection, kSpikeEur},
      {dear_day(), asleep, attentive, attentive, 0.5, LossCause::kCorrection, kSpikeEur}};
  for (const auto& c : cases) {
    SCOPED_TRACE(text_of(c.cause).name);
    FunctionPolicy exported(c.exported), under(c.under), plain(c.plain);
    expect_alone(
        loss_of(c.market, {exported, c.under ? &under : nullptr, c.plain ? &plain : nullptr},
                c.initial_soc_frac),
        c.cause, c.missed_eur);
  }
}

TEST(LostMoney, TheMomentIsThatOfTheDecisionNotOfTheHighPrice) {
  FunctionPolicy sleeps(asleep), sells_early(early);
  const DayLoss loss = loss_of(dear_day(), {sleeps});
  const GapMoment& moment = loss.moment[static_cast<std::size_t>(LossCause::kDearMissed)];
  EXPECT_EQ(moment.step.paid_eur_per_mwh, 1000);
  EXPECT_EQ(moment.done, Action::kIdle);
  EXPECT_EQ(moment.best, Action::kDischarge);
  EXPECT_DOUBLE_EQ(moment.soc_frac, 0.5);
  EXPECT_NEAR(moment.eur, kStepMwh * 900, 0.1);
  EXPECT_NEAR(loss.regret_eur[kEvent * 2 / 60] + loss.regret_eur[kEvent * 2 / 60 + 1],
              loss.missed_eur(), 1);
  const DayLoss empty = loss_of(dear_day(), {sells_early});
  EXPECT_EQ(empty.moment[static_cast<std::size_t>(LossCause::kEmpty)].step.paid_eur_per_mwh,
            kUsualEurPerMwh);
}

TEST(LostMoney, ACorrectionThatHelpsIsNegative) {
  FunctionPolicy corrected(attentive), plain(asleep);
  const DayLoss loss = loss_of(dear_day(), {corrected, nullptr, &plain});
  EXPECT_NEAR(loss.missed_eur(), 0, 1);
  EXPECT_NEAR(loss.of(LossCause::kCorrection), -kSpikeEur, 0.002 * kSpikeEur);
  EXPECT_NEAR(sum_of(loss), loss.missed_eur(), 1e-9);
}

TEST(LostMoney, TheCyclesAreUsedUp) {
  BatteryParameters battery;
  battery.cycles_per_day_max = 0.1;  // 1.6 MWh
  FunctionPolicy eager([](const MarketStep&, std::size_t i, double) {
    return i >= kMorning ? Action::kDischarge : Action::kIdle;
  });
  MarketSteps market = dear_day();
  for (std::size_t i = kEvent; i < kEventEnd; ++i) {  // so that a part of it pays for its wear
    market.steps[i].paid_eur_per_mwh += static_cast<double>(i);
  }
  const DayLoss loss = loss_of(market, {eager}, 0.5, battery);
  EXPECT_NEAR(loss.missed_eur(), 1.6 * 1300, 0.1 * 1.6 * 1300);
  // Its cycles were used at the usual price; the last step beyond the limit counts to it.
  EXPECT_GT(loss.of(LossCause::kTiming), 0.8 * loss.missed_eur());
  EXPECT_NEAR(loss.of(LossCause::kCycleLimit), 0, 0.2 * loss.missed_eur());
  EXPECT_NEAR(sum_of(loss), loss.missed_eur(), 1e-9);
  EXPECT_EQ(loss.of(LossCause::kRounding), 0);
}

TEST(LostMoney, TheBoundItselfMissesNothingNorWhatColdHoursTake) {
  BatteryParameters cold;
  cold.cold = {.power_share = 0.4, .from_hour = 0, .to_hour = 24};
  for (const BatteryParameters& battery : {BatteryParameters{}, cold}) {
    ForesightPolicy bound(battery);
    const DayLoss loss = loss_of(dear_day(), {bound}, 0.5, battery);
    EXPECT_EQ(loss.missed_eur(), 0);
    for (const double part : loss.part_eur) EXPECT_NEAR(part, 0, 0.5);
    for (const double eur : loss.regret_eur) EXPECT_NEAR(eur, 0, 0.5);
  }
}

TEST(LostMoney, AllPartsAddUpWhateverHappens) {
  std::mt19937 random(24);
  for (int trial = 0; trial < 20; ++trial) {
    MarketSteps market = dear_day();
    std::normal_distribution<double> move(0, trial % 2 == 0 ? 40 : 4000);
    double price = 100;
    for (MarketStep& step : market.steps) {
      if (step.minute_of_quarter_hour < 2) price = 0.8 * price + 20 + move(random);
      step.paid_eur_per_mwh = price;
      step.observed_eur_per_mwh = price + move(random) / 4;
      step.observed_age_min = static_cast<std::int16_t>(1 + (random() % 10 == 0));
    }
    const auto threshold = [](double low, double high) {
      return FunctionPolicy([=](const MarketStep& step, std::size_t, double) {
        if (step.observed_eur_per_mwh < low) return Action::kCharge;
        return step.observed_eur_per_mwh > high ? Action::kDischarge : Action::kIdle;
      });
    };
    FunctionPolicy exported = threshold(50, 150);
    FunctionPolicy under = threshold(60, 120);
    FunctionPolicy plain = threshold(80, 130);
    BatteryParameters battery;
    battery.wear_eur_per_mwh = 3 * (trial % 3);
    const DayLoss loss = loss_of(market, {exported, &under, &plain}, 0.5, battery);
    EXPECT_NEAR(sum_of(loss), loss.missed_eur(), 1e-6);
    EXPECT_LT(std::abs(loss.of(LossCause::kRounding)), 0.005 * loss.missed_eur() + 1);
    const double regret = std::accumulate(loss.regret_eur.begin(), loss.regret_eur.end(), 0.0);
    EXPECT_NEAR(regret, loss.missed_eur() - loss.of(LossCause::kRounding), 1e-6);
    for (const double hour : loss.regret_eur) EXPECT_GE(hour, 0);
    for (const LossCause cause : {LossCause::kDearMissed, LossCause::kCheapMissed,
                                  LossCause::kEmpty, LossCause::kFull, LossCause::kTiming}) {
      EXPECT_GE(loss.of(cause), 0) << text_of(cause).name;
    }
  }
}

}  // namespace
}  // namespace bess
