// What others would have earned in the log's cycles: by hand on a few, foresight against every plan
// on short draws, and that nobody beats it.
#include "edge/account/rivals.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <random>

#include "edge/account/account_days.h"
#include "edge/account/comparison.h"
#include "edge/control/policy.h"
#include "edge/log/ring_log.h"
#include "shared/local_time.h"
#include "tests/support/temporary_folder.h"

namespace bess {
namespace {

using ::testing::HasSubstr;

constexpr std::int64_t kStart = 1'679'785'200;  // 2023-03-26, before dawn
const double kRootOf90 = std::sqrt(0.9);

/// 8 kWh, 4 kW, from 10 to 100 %.
BatteryParameters battery() { return {.power_w_max = 4'000, .capacity_wh = 8'000}; }

/// Paid at what was decided on.
std::vector<PricedCycle> cycles_at(const std::vector<double>& prices_eur) {
  std::vector<PricedCycle> cycles;
  for (std::size_t i = 0; i < prices_eur.size(); ++i) {
    cycles.push_back({kStart + static_cast<std::int64_t>(i) * kSecondsPerStep,
                      static_cast<std::int32_t>(std::lround(prices_eur[i] * 100)),
                      static_cast<float>(prices_eur[i]), 6});
  }
  return cycles;
}

double mean_of(const std::vector<double>& prices_eur) {
  double sum = 0;
  for (const double price : prices_eur) sum += price;
  return sum / static_cast<double>(prices_eur.size());
}

TEST(Rivals, EarnNothingOnNothing) {
  set_market_time_zone();
  const Rivals none = find_rivals({}, 0.5, battery(), {}, {}, 0);
  EXPECT_EQ(none.foresight.paid_eur, 0);
  BatteryParameters without = battery();
  without.capacity_wh = 0;
  EXPECT_EQ(find_rivals(cycles_at({0, 500}), 0.5, without, {}, {}, 0).rule.paid_eur, 0);
}

/// It decides at 20 EUR/MWh and is paid at 60, less what the contract takes: 1 kWh in, in 7.5
/// cycles; what is in the battery then is sold at the mean of 150.
TEST(Rivals, ArePaidByQuarterHoursAndNotAtTheirDecisions) {
  set_market_time_zone();
  std::vector<PricedCycle> cycles = cycles_at(std::vector<double>(15, 20));
  for (PricedCycle& cycle : cycles) cycle.paid_eur_per_mwh = 60;
  BatteryParameters with_fees = battery();
  with_fees.costs = {.import_adder_eur_per_mwh = 45, .export_fee_eur_per_mwh = 3};
  with_fees.wear_eur_per_mwh = 2;
  const QuartileRule rule{.low_centi = 2'001, .high_centi = 9'000};
  const Rival paid = find_rivals(cycles, 0.5, with_fees, {}, rule, 150).rule;
  EXPECT_NEAR(paid.paid_eur, -0.002 * (60 + 45 + 2), 1e-9);
  EXPECT_NEAR(paid.at_equal_charge_eur, paid.paid_eur + 0.002 * 0.9 * (150 - 3 - 2), 1e-9);
  ASSERT_EQ(paid.by_day.size(), 1u);
  EXPECT_NEAR(paid.by_day.at(20'230'326), paid.at_equal_charge_eur, 1e-9);
  const QuartileRule at_its_edge{.low_centi = 2'000, .high_centi = 2'000};
  EXPECT_EQ(find_rivals(cycles, 0.5, with_fees, {}, at_its_edge, 150).rule.paid_eur, 0);
}

/// Half an hour at 0, the same at 100: 2 kWh in, what is left of them out, 90 %.
TEST(Rivals, ForesightBuysCheapAndSellsDear) {
  set_market_time_zone();
  std::vector<double> prices(15, 0.0);
  prices.resize(30, 100.0);
  const Rival seer = find_rivals(cycles_at(prices), 0.10, battery(), {}, {}, 50).foresight;
  EXPECT_NEAR(seer.paid_eur, 1.8 * 0.100, 1e-3);
  EXPECT_NEAR(seer.at_equal_charge_eur, 1.8 * 0.100, 1e-3);
  // Where it may end empty it sells all that it has: 2 kWh, in half an hour, and 1.8 it bought.
  const Rival full = find_rivals(cycles_at(prices), 1.0, battery(), {}, {}, 500).foresight;
  EXPECT_NEAR(full.paid_eur, 2 * 0.100, 1e-3);
  EXPECT_NEAR(full.at_equal_charge_eur, 0, 1e-3);
}

/// All 3^9 plans, from three states of charge.
TEST(Rivals, ForesightIsTheBestOfAllPlans) {
  set_market_time_zone();
  std::mt19937_64 random(20'261'123);
  std::uniform_real_distribution<double> price(-100, 300);
  BatteryParameters small = battery();
  small.capacity_wh = 800;  // some cycles fill it
  for (int draw = 0; draw < 6; ++draw) {
    std::vector<double> prices(9);
    for (double& p : prices) p = price(random);
    const auto cycles = cycles_at(prices);
    const double mean = mean_of(prices);
    const double first = 0.1 + 0.4 * (draw % 3);
    double best_paid = -1e9, best = -1e9;
    for (int plan = 0; plan < 19'683; ++plan) {
      double soc = first;
      double eur = 0;
      for (int i = 0, digits = plan; i < 9; ++i, digits /= 3) {
        const BatteryStep next =
            battery_step(small, soc, (digits % 3 - 1) * small.power_w_max, kHoursPerStep);
        eur -= next.power_w / 30 / 1e6 * prices[static_cast<std::size_t>(i)];
        soc = next.soc_frac;
      }
      const double stored_mwh = (soc - first) * small.capacity_wh / 1e6;
      best_paid = std::max(best_paid, eur);
      best = std::max(
          best, eur + mean * (stored_mwh > 0 ? stored_mwh * kRootOf90 : stored_mwh / kRootOf90));
    }
    const Rival seer = find_rivals(cycles, first, small, {}, {}, mean).foresight;
    EXPECT_LE(seer.paid_eur, best_paid + 1e-6) << draw;
    EXPECT_GE(seer.paid_eur, best_paid - 0.01 * std::abs(best_paid)) << draw;  // its grid's share
    EXPECT_LE(seer.at_equal_charge_eur, best + 1e-6) << draw;
    EXPECT_GE(seer.at_equal_charge_eur, best - 0.01 * std::abs(best)) << draw;
  }
}

TEST(Rivals, NobodyBeatsForesightAndTheThresholdsAreThoseOfTheGuard) {
  set_market_time_zone();
  std::mt19937_64 random(7);
  std::normal_distribution<double> noise(0, 60);
  std::vector<double> prices(720);
  for (std::size_t i = 0; i < prices.size(); ++i) {
    prices[i] = 90 + 80 * std::sin(static_cast<double>(i) / 60) + noise(random);
  }
  const auto cycles = cycles_at(prices);
  const QuartileRule rule{.low_centi = 4'000, .high_centi = 14'000};
  const Rivals rivals = find_rivals(cycles, 0.5, battery(), {}, rule, 90);
  for (const Rival& rival : {rivals.student, rivals.rule}) {
    EXPECT_GT(rivals.foresight.paid_eur, rival.paid_eur);
    EXPECT_GT(rivals.foresight.at_equal_charge_eur, rival.at_equal_charge_eur);
  }
  EXPECT_GT(rivals.rule.paid_eur, 0);
  // Thresholds that leave the student nothing: always charging below 2,000 EUR/MWh.
  const Rivals charged = find_rivals(
      cycles, 0.5, battery(), {.low_eur_per_mwh = 2'000, .high_eur_per_mwh = 3'000}, rule, 90);
  EXPECT_NE(charged.student.paid_eur, rivals.student.paid_eur);
  EXPECT_EQ(charged.foresight.paid_eur, rivals.foresight.paid_eur);
}

/// A log of some days, each cycle at the price that is asked for.
class LoggedDays : public ::testing::Test {
 protected:
  LoggedDays() : folder_("/dev/shm") {  // each record waits for its disk
    set_market_time_zone();
    FileMessage error;
    EXPECT_TRUE(ring_.open(folder_.file("decisions.ring").c_str(), 12 * 720, error));
  }
  template <typename PriceOf>
  void log(std::int64_t from_utc_s, int cycles, const PriceOf& price_eur_of, Action action) {
    for (int i = 0; i < cycles; ++i) {
      CycleRecord r{.utc_s = from_utc_s + i * kSecondsPerStep,
                    .mode = Mode::kRunning,
                    .reason = Reason::kStudent};
      r.has_measurement = true;
      r.measurement.soc_e4 = 5'000;
      r.measurement.capacity_wh = 8'000;
      r.price = {.has_row = true, .minute_utc_s = r.utc_s - 60};
      r.price.price_centi_eur_per_mwh = price_eur_of(i) * 100;
      r.price_level = PriceLevel::starting_at(9'000);
      r.has_student_action = true;
      r.student_action = action;
      r.context_class = 1;
      ASSERT_TRUE(ring_.append(r));
    }
  }
  const LogReader& reader() {
    EventLogSettings settings;
    settings.ring.assign(folder_.file("decisions.ring"));
    FileMessage error;
    EXPECT_TRUE(reader_.open(settings, error)) << error.c_str();
    return reader_;
  }
  TemporaryFolder folder_;
  RingLog ring_;
  LogReader reader_;
};

/// Eight days at 0 to 99 EUR/MWh; the day itself, at 1,000, is no part of its own rule.
TEST_F(LoggedDays, GiveTheRuleItsQuartilesFromTheDaysBefore) {
  const std::int64_t midnight = DayAccount(20'230'324).start_utc_s();
  log(
      midnight - 8 * 86'400, 8 * 720, [](int i) { return i % 100; }, Action::kIdle);
  log(
      midnight, 30, [](int) { return 1'000; }, Action::kIdle);
  const LogReader& days = reader();
  const QuartileRule rule = quartile_rule(days, 20'230'324);
  EXPECT_EQ(rule.days, 8);
  EXPECT_NEAR(rule.low_centi, 2'500, 100);
  EXPECT_NEAR(rule.high_centi, 7'500, 100);
  // Of five days there are too few: as the student learnt.
  const QuartileRule learnt = quartile_rule(days, 20'230'321);
  EXPECT_EQ(learnt.days, 0);
  EXPECT_EQ(learnt.low_centi, 100 * student_price_quartile(1));
  EXPECT_EQ(learnt.high_centi, 100 * student_price_quartile(3));
}

TEST_F(LoggedDays, AreTradedOnceWhereThereIsAPrice) {
  log(
      kStart, 30, [](int) { return 900; }, Action::kCharge);
  log(
      kStart + 20 * kSecondsPerStep, 20, [](int) { return 900; }, Action::kDischarge);
  CycleRecord old{.utc_s = kStart + 50 * kSecondsPerStep, .mode = Mode::kRunning};
  old.price = {.has_row = true, .minute_utc_s = old.utc_s - 302, .price_centi_eur_per_mwh = 100};
  ASSERT_TRUE(ring_.append(old));
  old.price.has_row = false;
  old.utc_s += kSecondsPerStep;
  ASSERT_TRUE(ring_.append(old));
  const SettledPrices none;
  QuarterPrices prices(none);
  const Period day{20'230'326, 20'230'326};
  const LogReader& written = reader();
  for_each_record_around(written, day.first_day, day.last_day,
                         [&](const CycleRecord& record) { prices.note(record); });
  const LoggedMarket market = logged_market(written, day, prices, 240);
  EXPECT_EQ(market.cycles.size(), 40u);  // the clock went back by ten cycles
  EXPECT_EQ(market.decided, 50);
  // At 900 EUR/MWh this student discharges a battery that is half full; another one charged.
  EXPECT_EQ(market.decided_otherwise, 30);
  EXPECT_EQ(market.cycles.front().paid_eur_per_mwh, 900);
  EXPECT_EQ(market.cycles.front().context_class,
            student_context_class(local_minute_of(kStart), 9'000));
}

/// So many days, each with so much earned.
Statement days_that_earned(const std::vector<double>& eur) {
  std::vector<DayAccount> days;
  for (std::size_t i = 0; i < eur.size(); ++i) {
    days.emplace_back(20'230'301 + static_cast<std::int32_t>(i));
    days.back().set_money({.earned_eur = eur[i], .quarter_hours = 96, .unpriced = 96});
  }
  return Statement(days);
}

TEST(Comparisons, SayTheSameInEachForm) {
  const Statement statement = days_that_earned({2});
  const Comparison beside{{.rule = {.paid_eur = 1.5, .at_equal_charge_eur = 1},
                           .student = {.paid_eur = 2.25, .at_equal_charge_eur = 2.5},
                           .foresight = {.paid_eur = 5, .at_equal_charge_eur = 4}},
                          {.low_centi = 2'000, .high_centi = 9'050, .days = 30},
                          720,
                          12,
                          statement};
  const std::string text = beside.text();
  EXPECT_THAT(text, HasSubstr("  a rule                                     +1.50       +1.00: "
                              "this battery +1.00\n"));
  EXPECT_THAT(text, HasSubstr("undisturbed  "));
  EXPECT_THAT(text, HasSubstr("+2.25       +2.50: this battery -0.50\n"));
  EXPECT_THAT(text, HasSubstr("50 % of foresight\n"));
  EXPECT_THAT(text,
              HasSubstr("charges below 20.00 and discharges above 90.50 EUR/MWh, the quartiles "
                        "of the prices of 30 days before\n"));
  EXPECT_THAT(text, HasSubstr("in 12 of 720 cycles that of the time decided otherwise\n"));
  const Json json = Json::parse(beside.json().text());
  EXPECT_DOUBLE_EQ(json.value()["share_of_foresight"].number().value(), 0.5);
  EXPECT_DOUBLE_EQ(json.value()["student_undisturbed_eur"].number().value(), 2.5);
  EXPECT_DOUBLE_EQ(json.value()["paid"]["student_undisturbed_eur"].number().value(), 2.25);
  EXPECT_TRUE(json.value()["error_of_difference"]["rule_eur"].is_null());
  const Comparison none{{}, {}, 0, 0, statement};
  EXPECT_FALSE(none.json().value()["share_of_foresight"].exists());
  EXPECT_THAT(none.text(), HasSubstr("less than a week before\n"));
}

/// Eight days; by 0 and 2 EUR in turns ahead: 8 together, and sqrt(8 * 8/7) of it.
TEST(Comparisons, TellTheirErrorOfMoreThanSevenDays) {
  const std::vector<double> eur{3, 5, 3, 5, 3, 5, 3, 5};
  Rival rival{.at_equal_charge_eur = 24};
  for (std::int32_t day = 0; day < 8; ++day) rival.by_day[20'230'301 + day] = 3;
  const Statement eight = days_that_earned(eur);
  const Comparison beside{{.rule = rival, .student = {}, .foresight = {}}, {}, 0, 0, eight};
  EXPECT_DOUBLE_EQ(beside.ahead_eur(rival), 8);
  EXPECT_NEAR(beside.error_eur(rival), std::sqrt(8 * 8.0 / 7), 1e-9);
  EXPECT_THAT(beside.text(), HasSubstr("this battery +8.00 ± 3.02 over days\n"));
  const Statement seven = days_that_earned({3, 5, 3, 5, 3, 5, 3});
  EXPECT_TRUE(std::isnan(Comparison{{}, {}, 0, 0, seven}.error_eur(rival)));
}

}  // namespace
}  // namespace bess
