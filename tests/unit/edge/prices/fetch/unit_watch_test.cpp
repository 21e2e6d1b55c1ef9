// Prices in another unit are found, small real ones are accepted; the request time is learnt.
#include "edge/prices/fetch/unit_watch.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "edge/prices/fetch/fetch.h"

namespace bess {
namespace {

constexpr std::int64_t kNoon = 1'679'824'800;

PriceRow row_at(int minute, double eur_per_mwh) {
  return {
      .minute_utc_s = kNoon + 60 * minute,
      .price_centi_eur_per_mwh = static_cast<std::int32_t>(std::lround(eur_per_mwh * 100)),
      .is_finer_than_cents = std::fabs(eur_per_mwh * 100 - std::round(eur_per_mwh * 100)) > 1e-6};
}

/// Minutes until it is doubtful; -1: never.
template <typename PriceAt>
int minutes_until_doubtful(int minutes, const PriceAt& price_at) {
  UnitWatch watch;
  for (int minute = 0; minute < minutes; ++minute) {
    watch.observe(row_at(minute, price_at(minute)));
    if (watch.is_doubtful()) return minute + 1;
  }
  return -1;
}

double usual(int minute) { return 85 + 60 * std::sin(minute / 7.0) + 0.01 * (minute % 100); }

TEST(UnitWatch, KilowattHoursAreFoundWithinAnHourAndASwitchToThemWithinMinutes) {
  for (const auto& [from_minute, last_minute] : {std::pair{0, 60}, {720, 725}}) {
    const int found = minutes_until_doubtful(from_minute + 300, [from_minute = from_minute](int m) {
      return m < from_minute ? usual(m) : usual(m) / 1'000;
    });
    EXPECT_GT(found, from_minute);
    EXPECT_LE(found, last_minute);
  }
}

TEST(UnitWatch, CentsAreFound) {
  EXPECT_GT(minutes_until_doubtful(300, [](int m) { return 100 * (usual(m) + 40); }), 0);
}

/// As on a sunny Sunday: 135 min within 0.5 EUR, in whole cents.
TEST(UnitWatch, SmallRealPricesAreNot) {
  EXPECT_EQ(
      minutes_until_doubtful(135, [](int m) { return std::round(40 * std::sin(m / 3.0)) / 100; }),
      -1);
  EXPECT_EQ(minutes_until_doubtful(600, [](int) { return 0.0; }), -1) << "constant: frozen_price";
  EXPECT_EQ(minutes_until_doubtful(5'000, usual), -1);
}

TEST(UnitWatch, RandomWalksAreNot) {
  std::mt19937 random(20'261'127);
  std::normal_distribution<double> step(0, 15);
  for (int walk = 0; walk < 50; ++walk) {
    double price = 80;
    EXPECT_EQ(minutes_until_doubtful(2'000,
                                     [&](int) {
                                       price += step(random) - 0.02 * (price - 60);
                                       return std::round(price * 100) / 100;
                                     }),
              -1);
  }
}

TEST(UnitWatch, ADuplicateOrOlderRowChangesNothing) {
  UnitWatch watch;
  for (int i = 0; i < 1'000; ++i) watch.observe(row_at(0, 0.085 + i));
  EXPECT_FALSE(watch.is_doubtful());
}

TEST(AskTiming, FindsTheSecondAtWhichRowsAreThere) {
  AskTiming timing;
  EXPECT_EQ(timing.first_s(), 0);
  int requests = 0;
  for (int cycle = 0; cycle < 20; ++cycle) {
    const bool is_found = timing.first_s() >= 12;
    requests += is_found ? 1 : 2;
    timing.learn(is_found, false);
  }
  EXPECT_EQ(timing.first_s(), 12);
  EXPECT_LE(requests, 24);
}

TEST(AskTiming, ComesEarlierAgainUnlessRefused) {
  AskTiming patient;
  AskTiming refused;
  for (AskTiming* timing : {&patient, &refused}) timing->learn(false, false);
  refused.learn(true, true);
  for (int cycle = 0; cycle < 200; ++cycle) {
    patient.learn(true, false);
    refused.learn(true, false);
  }
  EXPECT_EQ(patient.first_s(), 0);
  EXPECT_EQ(refused.first_s(), 3);
}

TEST(AskTiming, LeavesTimeForOneMore) {
  AskTiming timing;
  for (int cycle = 0; cycle < 100; ++cycle) timing.learn(false, false);
  EXPECT_LE(timing.first_s(), 18);
}

}  // namespace
}  // namespace bess
