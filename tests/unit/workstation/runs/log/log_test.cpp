// Log by hand: 30 min of charging at 50 EUR/MWh and 30 min of discharging at 250, at 4 kW, 2 kWh
// each way; its earnings, those of a rule and another student, and bad logs.
#include <fmt/core.h>
#include <gmock/gmock.h>

#include <cmath>

#include "shared/units_and_limits.h"
#include "shared/utc_text.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/tokens.h"
#include "tests/support/user_error_of.h"
#include "workstation/runs/log/log_input.h"

namespace bess {
namespace {

constexpr std::int64_t kStart = 1'795'341'600;  // 2026-11-22T10:00:00Z, a quarter-hour begins
const char* const kHead =
    "utc,mode,price_minute_utc,price_centi_eur_per_mwh,price_age_s,soc_e4,battery_power_w,"
    "student_action,ordered_power_w,reason,battery_status,written,price_level_centi_q16,outlook,"
    "break_even_centi,price_stands_in,stand_in_centi\n";

std::string row(int tick, int price_eur, int power_w, int ordered_w, const char* student = "idle",
                const char* mode = "running", const char* reason = "student") {
  const std::int64_t utc_s = kStart + tick * kSecondsPerStep;
  return fmt::format("{},{},{},{},-1,5000,{},{},{},{},ok,1,655360000,none,0,0,0\n",
                     utc_text(utc_s).view(), mode, utc_text(utc_s - 60).view(), price_eur * 100,
                     power_w, student, ordered_w, reason);
}

/// Each reading belongs to the order of the previous tick.
std::string hour_of_trade() {
  std::string log = kHead;
  for (int tick = 1; tick <= 15; ++tick) log += row(tick, 50, 4'000, tick < 15 ? 4'000 : -4'000);
  for (int tick = 16; tick <= 30; ++tick) log += row(tick, 250, -4'000, tick < 30 ? -4'000 : 0);
  return log + row(31, 250, 0, 0);
}

class Log : public testing::Test {
 protected:
  [[nodiscard]] ReadLog read(const std::string& text,
                             const std::vector<SettledQuarter>& settled = {}) const {
    CycleLog log = read_cycle_log({folder_.write("log.csv", text)});
    QuarterPrices prices = prices_of(log, settled);
    std::vector<LoggedDay> days = days_of(log, prices, battery_, {});
    return {std::move(log), battery_, {}, std::move(prices), std::move(days)};
  }

  [[nodiscard]] std::string complaint(const std::string& text) const {
    return refusal_of([&] { static_cast<void>(read(text)); });
  }

  const TemporaryFolder folder_;
  BatteryParameters battery_{.power_w_max = 4'000, .capacity_wh = 8'000};
};

TEST_F(Log, EarnsByQuarterHoursLessTheContract) {
  battery_.costs = {.import_adder_eur_per_mwh = 45, .export_fee_eur_per_mwh = 5};
  battery_.wear_eur_per_mwh = 10;
  const ReadLog log = read(hour_of_trade());
  ASSERT_EQ(log.days.size(), 1u);
  const ExchangedDay& day = log.days.front().exchanged;
  EXPECT_NEAR(day.charged_wh, 2'000, 1e-6);
  EXPECT_NEAR(day.discharged_wh, 2'000, 1e-6);
  EXPECT_NEAR(day.money.earned_eur, 0.5 - 0.1, 1e-9);
  EXPECT_NEAR(day.money.contract_eur, 2 * 0.045 + 2 * 0.005 + 4 * 0.010, 1e-9);
  EXPECT_NEAR(day.money.estimated_eur, 0.4, 1e-9);
  EXPECT_THAT(statement_page(log.days, battery_), Names("2026-11-22 2.000 0.40 0.14 0.26 45"));
}

/// The first quarter-hour at 90 instead of 50: 1 kWh, 4 cents less.
TEST_F(Log, IsPaidAtTheSettledPrice) {
  const std::vector<SettledQuarter> settled = read_settled(
      folder_.write("settled.csv",
                    "quarter_hour_utc,eur_per_mwh,state\n2026-11-22T10:00:00Z,90,validated\n"
                    "2026-11-22T10:15:00Z,50,published\n# crc32 12345678\n"));
  const ReadLog log = read(hour_of_trade(), settled);
  const QuarterHourMoney& money = log.days.front().exchanged.money;
  EXPECT_NEAR(money.earned_eur, 0.5 - 0.14, 1e-9);
  EXPECT_EQ(money.published, 2);
  EXPECT_EQ(money.validated, 1);
  EXPECT_THROW(read_settled(folder_.write("bad.csv",
                                          "quarter_hour_utc,eur_per_mwh,state\n"
                                          "2026-11-22T10:01:00Z,90,validated\n")),
               UserError);
}

/// A rule decides on 50 in ticks 1 to 15 and on 250 in 16 to 31; the step of tick 15 is in the
/// third quarter-hour, and is paid at 250. A step of 4 kW is 1/7500 MWh.
TEST_F(Log, ARuleIsPaidByTheSameQuarterHours) {
  const std::vector<NamedEvaluation> all =
      compare_log(read(hour_of_trade()), {"rbc:100:200", "rbc:-1000:1000"});
  ASSERT_EQ(all.size(), 4u);
  EXPECT_EQ(all[0].name, kThisBattery);
  const NetEarnings battery = net_earnings_of(all[0].carried_over),
                    rule = net_earnings_of(all[1].carried_over);
  const NetEarnings rest = net_earnings_of(all[2].carried_over),
                    foresight = net_earnings_of(all[3].carried_over);
  EXPECT_NEAR(battery.paid_eur, 0.4, 1e-9);
  EXPECT_EQ(battery.charge_eur, 0);
  EXPECT_NEAR(rule.paid_eur, (16 * 250 - 14 * 50 - 250) / 7'500.0, 1e-9);
  // 15 steps in and 16 out from a half: the difference is bought at the mean of 14 x 50, 17 x 250.
  const double mean = (14 * 50 + 17 * 250) / 31.0, way = std::sqrt(0.9);
  EXPECT_NEAR(rule.charge_eur, (15 * way - 16 / way) / way / 7'500 * mean, 1e-9);
  EXPECT_EQ(rest.paid_eur, 0);
  EXPECT_GE(foresight.paid_eur, rule.paid_eur);
}

TEST_F(Log, WithoutAUsablePriceAllRest) {
  std::string text = kHead;
  for (int tick = 1; tick <= 10; ++tick) {
    std::string line = row(tick, 50, 0, 0);
    if (tick > 5) line.replace(line.find("running,") + 8, 20, "2026-11-22T09:00:00Z");
    text += line;
  }
  const ReadLog log = read(text);
  EXPECT_EQ(market_of_log(log.log, log.prices, {}, ContextKind::kLevel).steps.size(), 5u);
}

/// Below -500 EUR/MWh every proved student charges, above 1500 it discharges: three of the ten
/// low-price cycles were idle. The extra charge is discharged at the mean of -600 and 1600.
TEST_F(Log, ReplayCountsWhatAnotherStudentWouldHaveDecided) {
  std::string text = kHead;
  for (int tick = 1; tick <= 10; ++tick)
    text += row(tick, -600, 0, 4'000, tick <= 3 ? "idle" : "charge");
  for (int tick = 11; tick <= 20; ++tick) text += row(tick, 1'600, 0, 0, "discharge");
  const ReadLog log = read(text);
  StudentNet student = compiled_student().net;
  const LogReplay replay = replay_log(log.log, {}, student);
  EXPECT_EQ(replay.compared, 20);
  EXPECT_EQ(replay.differing, 3);
  EXPECT_NEAR(replay.gained_eur, 3 * (500 + 600) / 7'500.0, 1e-9);
  EXPECT_THAT(replay.text(), Names("3 20 15.00 % +0.44"));
  EXPECT_THAT(replay.text(), Names("idle charge 3"));
  EXPECT_EQ(replay.others.front().utc_s, kStart + kSecondsPerStep);
  EXPECT_EQ(replay.others.front().now, Action::kCharge);
  student.context.kind = ContextKind::kOutlook;  // which this log does not cover
  EXPECT_THROW(replay_log(log.log, {}, student), UserError);
  EXPECT_THROW(replay_log(read(hour_of_trade()).log, {20'200'101, 20'200'131}, student), UserError);
}

TEST_F(Log, WhatIsSkippedIsCounted) {
  const std::string whole = hour_of_trade();
  const ReadLog log =
      read(whole + row(31, 250, 0, 0) + row(35, 250, 0, 0, "idle", "holding", "link") +
           "2026-11-22T11:12:00Z,runn");
  EXPECT_EQ(log.log.torn, 1);
  EXPECT_EQ(log.log.duplicates, 1);
  EXPECT_EQ(log.log.cycles.size(), 32u);
  EXPECT_EQ(log.days.front().missing, 3);
  EXPECT_EQ(log.days.front().driven_cycles, 31);
  EXPECT_EQ(log.days.front().stopped.at("link"), 1);
}

TEST_F(Log, ABadLogIsNamedByLineAndColumn) {
  EXPECT_THAT(complaint("utc,mode\n2026-11-22T10:00:00Z,running\n"), Names("price_minute_utc"));
  EXPECT_THAT(complaint(kHead + row(1, 50, 0, 0) + "2026-11-22T10:04:00Z,running\n"),
              Names("log.csv:3 2 17"));
  EXPECT_THAT(complaint(kHead + row(1, 50, 0, 0, "dance")),
              Names("log.csv:2 student_action \"dance\""));
  std::string no_number = row(1, 50, 0, 0);
  no_number.replace(no_number.find("5000,0,idle"), 4, "half");
  EXPECT_THAT(complaint(kHead + no_number), Names("log.csv:2 soc_e4 \"half\""));
  const CycleLog log = read(hour_of_trade()).log;
  EXPECT_THROW(require_same_battery(log, BatteryParameters{}, ""), UserError) << "megawatts";
  EXPECT_NO_THROW(require_same_battery(log, battery_, ""));
}

}  // namespace
}  // namespace bess
