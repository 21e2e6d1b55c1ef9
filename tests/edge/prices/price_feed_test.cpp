// The price feed's thread and report: what it keeps, what it flags, and that nothing outside can
// hold up whoever waits for it.
#include "edge/prices/price_feed.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>

#include "edge/control/control_loop.h"
#include "shared/utc_text.h"
#include "tests/support/fake_resolver.h"
#include "tests/support/test_server.h"

namespace bess {
namespace {

constexpr std::int64_t kMillisecond = 1'000'000;
constexpr std::int64_t kNowS = 1'705'960'800;  // 2024-01-22T22:00:00Z

std::int64_t now_ns() { return clock_ns(CLOCK_MONOTONIC); }

/// Stands still for all that a test notices: an hour passes in an hour.
ScaledClock clock_at(std::int64_t utc_s) {
  return {.anchor_monotonic_ns = now_ns(), .anchor_utc_s = utc_s, .scale = 1};
}

std::string row(std::int64_t minute_utc_s, const std::string& price) {
  return "{\"datetime\":\"" + std::string(utc_text(minute_utc_s).view()) +
         "\",\"imbalanceprice\":" + price + "}";
}

/// A price server whose answer the test changes, and a feed that reads it.
class PriceFeedTest : public ::testing::Test {
 protected:
  void start(int requests_per_cycle = 1) {
    server_ = std::make_unique<TestServer>([this](TestConnection& connection, const std::string&) {
      const std::lock_guard lock(mutex_);
      return connection.answer(answer_);
    });
    PriceFeedSettings settings;
    settings.http.url = FixedText<511>("http://127.0.0.1:" + std::to_string(server_->port()) + "/");
    settings.requests_per_cycle = requests_per_cycle;
    settings.wait_s = 1;
    feed_ = std::make_unique<PriceFeed>(settings, clock_at(kNowS));
  }
  void set_answer(const std::string& rows) {
    const std::lock_guard lock(mutex_);
    answer_ = "{\"results\":[" + rows + "]}";
  }
  PriceReport fetch(const std::string& rows, std::int64_t minute_utc_s = kNowS - 60) {
    set_answer(rows);
    feed_->request(minute_utc_s, now_ns(), now_ns() + 10'000 * kMillisecond);
    EXPECT_TRUE(feed_->wait(now_ns() + 20'000 * kMillisecond));
    return feed_->latest();
  }

  std::mutex mutex_;
  std::string answer_;
  std::unique_ptr<TestServer> server_;
  std::unique_ptr<PriceFeed> feed_;
};

TEST_F(PriceFeedTest, KeepsTheNewestRowEverAccepted) {
  start();
  EXPECT_FALSE(feed_->latest().has_row);
  const PriceReport first = fetch(row(kNowS - 120, "10.5"));
  ASSERT_TRUE(first.has_row);
  EXPECT_EQ(first.minute_utc_s, kNowS - 120);
  EXPECT_EQ(first.price_centi_eur_per_mwh, 1'050);
  struct Change {
    const char* name;
    std::string rows;
    Status status;
  };
  std::string many = "0";
  while (many.size() < 65'000) many += ",0";
  const Change nothing[] = {
      {"duplicate", row(kNowS - 120, "10.5"), Status::kOk},
      {"older", row(kNowS - 180, "77"), Status::kOk},
      {"future", row(kNowS, "88"), Status::kNoRow},
      {"null", row(kNowS - 60, "null"), Status::kNoRow},
      {"implausible", row(kNowS - 60, "15001"), Status::kNoRow},
      {"empty", "", Status::kNoRow},
      {"broken", "{", Status::kMalformed},
      {"nested", std::string(60'000, '['), Status::kMalformed},  // on the thread's own stack
      {"many rows", many, Status::kNoRow},                       // the arena holds all of them
  };
  for (const Change& change : nothing) {
    const PriceReport report = fetch(change.rows);
    EXPECT_EQ(status_name(report.status), status_name(change.status)) << change.name;
    EXPECT_EQ(report.minute_utc_s, first.minute_utc_s) << change.name;
    EXPECT_EQ(report.price_centi_eur_per_mwh, 1'050) << change.name;
    EXPECT_EQ(report.received_monotonic_ns, first.received_monotonic_ns) << change.name;
    EXPECT_FALSE(report.large_step) << change.name;
  }
  EXPECT_EQ(fetch(row(kNowS - 120, "11")).price_centi_eur_per_mwh, 1'100);  // corrected
  EXPECT_EQ(feed_->latest().received_monotonic_ns, first.received_monotonic_ns);
  EXPECT_EQ(fetch(row(kNowS - 60, "12")).minute_utc_s, kNowS - 60);
  EXPECT_GT(feed_->latest().received_monotonic_ns, first.received_monotonic_ns);
}

TEST_F(PriceFeedTest, ALargeStepIsFlaggedAndUsed) {
  start();
  EXPECT_FALSE(fetch(row(kNowS - 240, "-300")).large_step);
  EXPECT_FALSE(fetch(row(kNowS - 180, "2000")).large_step);  // exactly 2,300
  const PriceReport large = fetch(row(kNowS - 120, "-300.01"));
  EXPECT_TRUE(large.large_step);
  EXPECT_EQ(large.price_centi_eur_per_mwh, -30'001);
  EXPECT_TRUE(fetch(row(kNowS - 120, "-300.01")).large_step);  // a duplicate changes nothing
  EXPECT_FALSE(fetch(row(kNowS - 60, "0")).large_step);
}

TEST_F(PriceFeedTest, AsksUntilTheRowIsInAndAtMostFourTimes) {
  start(4);
  fetch(row(kNowS - 120, "1"));  // never the wanted minute
  EXPECT_EQ(server_->requests(), 4);
  fetch(row(kNowS - 60, "1"));
  EXPECT_EQ(server_->requests(), 5);
}

TEST_F(PriceFeedTest, AHangingServerHoldsUpNobodyAndTheNextCycleIsServed) {
  TestServer* hanging = nullptr;
  TestServer server([&](TestConnection&, const std::string&) {
    hanging->wait_for_end();
    return false;
  });
  hanging = &server;
  PriceFeedSettings settings;
  settings.http.url = FixedText<511>("http://127.0.0.1:" + std::to_string(server.port()) + "/");
  settings.http.timeout_ms = 1'000;
  settings.requests_per_cycle = 1;
  PriceFeed feed(settings, clock_at(kNowS));
  for (int i = 0; i < 2; ++i) {
    feed.request(kNowS - 60, now_ns(), now_ns() + 100 * kMillisecond);
    const std::int64_t start_ns = now_ns();
    EXPECT_FALSE(feed.wait(now_ns() + 100 * kMillisecond));
    EXPECT_LT(now_ns() - start_ns, 800 * kMillisecond);
    EXPECT_TRUE(feed.wait(now_ns() + 10'000 * kMillisecond));
    EXPECT_EQ(feed.latest().status, Status::kTimeout);
  }
}

TEST_F(PriceFeedTest, ASlowResolverHoldsUpNobodyEither) {
  fake_resolver::set("slow.example", {});
  fake_resolver::set_delay_ms(0);
  PriceFeedSettings settings;
  settings.http.url = "http://slow.example/";
  settings.requests_per_cycle = 1;
  PriceFeed feed(settings, clock_at(kNowS));
  fake_resolver::set_delay_ms(1'000);
  feed.request(kNowS - 60, now_ns(), now_ns() + 100 * kMillisecond);
  const std::int64_t start_ns = now_ns();
  EXPECT_FALSE(feed.wait(now_ns() + 100 * kMillisecond));
  EXPECT_LT(now_ns() - start_ns, 800 * kMillisecond);
  EXPECT_TRUE(feed.wait(now_ns() + 10'000 * kMillisecond));
  EXPECT_EQ(feed.latest().status, Status::kNameUnresolved);
  fake_resolver::set_delay_ms(0);
}

/// The loop's clock, in simulated time; nothing stops it.
struct TestClock {
  ScaledClock scaled;
  [[nodiscard]] std::int64_t now_utc_ns() const { return scaled.now_utc_ns(); }
  [[nodiscard]] std::int64_t monotonic_ns() const { return now_ns(); }
  [[nodiscard]] std::int64_t monotonic_ns_at(std::int64_t utc_ns) const {
    return scaled.monotonic_ns_at(utc_ns);
  }
  bool sleep_until_utc_ns(std::int64_t utc_ns) const {
    while (now_utc_ns() < utc_ns) sleep_until_monotonic(monotonic_ns_at(utc_ns));
    return true;
  }
  [[nodiscard]] bool stop_requested() const { return false; }
  [[nodiscard]] bool is_synchronised() const { return true; }
};

struct ObedientBattery {
  std::int32_t power_w = 0;
  Status read(BatteryMeasurement& m) const {
    m = BatteryMeasurement{.soc_e4 = 5'000, .power_w = power_w, .capacity_wh = 8'000};
    return Status::kOk;
  }
  Status order(const PowerOrder& order) {
    power_w = order.power_w;
    return Status::kOk;
  }
  [[nodiscard]] std::int32_t refresh_interval_s() const { return 0; }
  Status refresh() { return Status::kOk; }
  [[nodiscard]] BatteryCounters counters() const { return {}; }
  Status release() {
    power_w = 0;
    return Status::kOk;
  }
};

constexpr std::int64_t kOutageStartS = 1'705'957'200;  // 2024-01-22T22:00 in Brussels
constexpr std::int64_t kOutageEndS = kOutageStartS + 9 * 3'600;

/// What Elia's API answered that night: the rows up to 22:00, with 200, for nine hours.
std::string published_rows(std::int64_t now_utc_s) {
  const bool is_out = now_utc_s >= kOutageStartS && now_utc_s < kOutageEndS;
  const std::int64_t newest = (is_out ? kOutageStartS : now_utc_s) / 60 * 60 - 60;
  std::string rows;
  for (int i = 0; i < 20; ++i) {
    rows += (i > 0 ? "," : "") + row(newest - 60 * i, i == 3 ? "null" : "-600");
  }
  return "{\"total_count\": 20, \"results\": [" + rows + "]}";
}

TEST(MarketOutage, NineHoursOfOldRowsGiveNoOrder) {
  set_market_time_zone();
  const std::int64_t start_s = kOutageStartS - 1'800;
  const TestClock clock{{.anchor_monotonic_ns = now_ns() + 200 * kMillisecond,
                         .anchor_utc_s = start_s,
                         .scale = 6'000}};
  TestServer server([&](TestConnection& connection, const std::string&) {
    return connection.answer(published_rows(clock.now_utc_ns() / kNanosecondsPerSecond));
  });
  PriceFeedSettings settings;
  settings.http.url = FixedText<511>("http://127.0.0.1:" + std::to_string(server.port()) + "/");
  auto feed = std::make_unique<PriceFeed>(settings, clock.scaled);
  ObedientBattery battery;
  ControlLoop<ObedientBattery, PriceFeed, const TestClock> loop(
      {.control = true, .guard = {}, .price_wait_s = settings.wait_s}, battery, *feed, clock);
  int running_before = 0;
  int held = 0;
  int running_after = 0;
  CycleRecord record;
  for (bool more = true; more; more = record.utc_s < kOutageEndS + 1'800) {
    ASSERT_TRUE(loop.run_cycle(record));
    if (record.mode == Mode::kRunning) {
      EXPECT_LE(record.price_age_s, 240) << utc_text(record.utc_s).view();
      EXPECT_EQ(record.ordered_power_w, 4'000);  // -600 EUR/MWh: charge
      ++(record.utc_s < kOutageEndS ? running_before : running_after);
    } else if (record.reason == Reason::kLink) {
      EXPECT_EQ(battery.power_w, 0);  // a busy machine was minutes late: the reading is too old
    } else if (record.price.has_row) {
      EXPECT_EQ(battery.power_w, 0) << utc_text(record.utc_s).view();
      // The record tells the age at the tick; the guard of a busy machine asked the clock later.
      EXPECT_GE(record.price_age_s, 120);
      EXPECT_TRUE(record.reason == Reason::kPriceAge || record.reason == Reason::kPriceQuarterHour);
      ++held;
    }
    if (record.utc_s > kOutageStartS + 300 && record.utc_s < kOutageEndS) {
      EXPECT_NE(record.mode, Mode::kRunning) << utc_text(record.utc_s).view();
      EXPECT_EQ(record.price.minute_utc_s, kOutageStartS - 60);
    }
  }
  EXPECT_GT(running_before, 5);
  EXPECT_GT(held, 100);  // of 270 ticks; a busy machine skips some
  EXPECT_GT(running_after, 5);
}

}  // namespace
}  // namespace bess
