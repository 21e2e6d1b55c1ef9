// Energy between the records of a log, by hand: an order that begins late, a battery that is full
// before the next tick, a skipped tick, a clock step backwards.
#include "shared/host/exchange.h"

#include <gtest/gtest.h>

#include <cmath>

namespace bess {
namespace {

constexpr std::int64_t kExchangeStart = 1'679'785'200;  // a quarter-hour begins
const double kOneWayOf90 = std::sqrt(0.9);

/// 8 kWh, read at tick `i` with that power, and ordered `order_w` from `after_s` on.
ExchangeSample sample_at(int i, std::int32_t power_w, std::int32_t soc_e4, std::int32_t order_w,
                         float after_s = 6) {
  return {.utc_s = kExchangeStart + i * 120,
          .power_w = power_w,
          .soc_e4 = soc_e4,
          .capacity_wh = 8'000,
          .order_w = order_w,
          .written_after_s = after_s,
          .is_ordered = true};
}

struct ExchangeSums {
  double charged_wh = 0, discharged_wh = 0, unseen_wh = 0;
  double first_quarter_wh = 0;  ///< net, from kExchangeStart
};

/// Without the interval before the first one.
ExchangeSums exchange_sums(const std::vector<ExchangeSample>& samples) {
  ExchangeSums sums;
  for_each_exchange(samples, [&](const Exchange& e) {
    if (e.from_utc_s < kExchangeStart) return;
    EXPECT_LE(e.until_utc_s - e.from_utc_s, 900);
    (e.energy_wh > 0 ? sums.charged_wh : sums.discharged_wh) += std::fabs(e.energy_wh);
    if (!e.is_seen) sums.unseen_wh += std::fabs(e.energy_wh);
    if (e.from_utc_s < kExchangeStart + 900) sums.first_quarter_wh += e.energy_wh;
  });
  return sums;
}

TEST(Exchanges, AnOrderHoldsFromWhenItWasWritten) {
  const ExchangeSums sums =
      exchange_sums({sample_at(0, 0, 5'000, 4'000), sample_at(1, 4'000, 5'150, -4'000),
                     sample_at(2, -4'000, 5'000, 0), sample_at(3, 0, 4'990, 0)});
  EXPECT_NEAR(sums.charged_wh, 4'000 * (114 + 6) / 3'600.0, 1e-6);
  EXPECT_NEAR(sums.discharged_wh, 4'000 * (114 + 6) / 3'600.0, 1e-6);
  EXPECT_EQ(sums.unseen_wh, 0);
}

/// 7.5 steps are a quarter-hour: the eighth belongs half to the next.
TEST(Exchanges, NoneGoesAcrossAQuarterHour) {
  std::vector<ExchangeSample> samples;
  for (int i = 0; i <= 10; ++i) samples.push_back(sample_at(i, 3'000, 5'000, 3'000));
  const ExchangeSums sums = exchange_sums(samples);
  EXPECT_NEAR(sums.charged_wh, 1'000, 1e-6);
  EXPECT_NEAR(sums.first_quarter_wh, 750, 1e-6);
}

/// The SoC shows how much still fitted; the power at the next tick is 0 and has no information.
TEST(Exchanges, ABatteryThatIsFullBeforeTheTickTookWhatFitted) {
  const ExchangeSums sums =
      exchange_sums({sample_at(0, 4'000, 9'700, 4'000), sample_at(1, 4'000, 9'858, 4'000),
                     sample_at(2, 0, 10'000, 4'000), sample_at(3, 0, 10'000, 4'000)});
  // From the first tick on 300e-4 of 8 kWh fit.
  EXPECT_NEAR(sums.charged_wh, 0.03 * 8'000 / kOneWayOf90, 0.5);
}

/// Killed while it charged: the order continues until the battery's timer ends it.
TEST(Exchanges, AGapIsFilledByTheStateOfCharge) {
  const std::int32_t after_e4 = 5'000 + 158 + 396;  // 120 s, and 300 s more, at 4 kW
  const ExchangeSums sums =
      exchange_sums({sample_at(0, 4'000, 5'000, 4'000), sample_at(1, 4'000, 5'158, 4'000),
                     sample_at(30, 0, after_e4, 0)});
  const double gap_wh = 0.0396 * 8'000 / kOneWayOf90;
  EXPECT_NEAR(sums.charged_wh, 4'000 / 30.0 + gap_wh, 2);
  EXPECT_NEAR(sums.unseen_wh, gap_wh - 4'000 * 6 / 3'600.0, 2);
  EXPECT_NEAR(sums.first_quarter_wh, sums.charged_wh, 1e-6);  // immediately, not over the hour
  EXPECT_EQ(sums.discharged_wh, 0);
}

TEST(Exchanges, ATickThatWasMissedUnderOneOrderIsSeenAtBothEnds) {
  const ExchangeSums sums =
      exchange_sums({sample_at(0, -2'000, 5'000, -2'000), sample_at(3, -2'000, 4'700, -2'000)});
  EXPECT_NEAR(sums.discharged_wh, 200, 1e-6);
  EXPECT_EQ(sums.unseen_wh, 0);
}

TEST(Exchanges, AClockStepBackwardsStartsAgain) {
  const ExchangeSums sums =
      exchange_sums({sample_at(10, 4'000, 5'000, 4'000), sample_at(11, 4'000, 5'158, 4'000),
                     sample_at(5, 4'000, 5'316, 4'000), sample_at(6, 4'000, 5'474, 4'000)});
  // And the interval before the first one.
  EXPECT_NEAR(sums.charged_wh, 3 * 4'000 / 30.0, 1e-6);
}

TEST(Exchanges, TheEfficiencyIsThatOfTheLog) {
  std::vector<ExchangeSample> samples;
  double soc_e4 = 1'000;
  for (int i = 0; i < 40; ++i) {  // 95 % of what is charged shows
    samples.push_back(sample_at(i, 3'600, static_cast<std::int32_t>(std::lround(soc_e4)), 3'600));
    soc_e4 += 120 * 0.95 / 8'000 * 1e4;
  }
  EXPECT_NEAR(charge_scale_of(samples).charge_efficiency, 0.95, 0.002);
  EXPECT_NEAR(charge_scale_of({}).charge_efficiency, kOneWayOf90, 1e-9);
}

/// By the age of the price at that time.
TEST(Exchanges, ASampleKnowsWhenItsOrderWasWritten) {
  ExchangeSample sample{.utc_s = kExchangeStart};
  sample.set_written(kExchangeStart - 60, 5);
  EXPECT_NEAR(sample.written_after_s, 5.5, 1e-6);
  sample.set_written(kExchangeStart - 60, 90);  // of a late price
  EXPECT_EQ(sample.written_after_s, 0);
}

}  // namespace
}  // namespace bess
