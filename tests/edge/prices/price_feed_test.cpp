// The price feed's thread and report: what it keeps, what it flags, and that nothing outside can
// hold up whoever waits for it.
#include "edge/prices/price_feed.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>

#include "edge/loop/control_loop.h"
#include "edge/prices/history_pages.h"
#include "shared/utc_text.h"
#include "tests/support/fake_resolver.h"
#include "tests/support/test_server.h"

namespace bess {
namespace {

constexpr std::int64_t kMillisecond = 1'000'000;
constexpr std::int64_t kNowS = 1'705'960'800;  // 2024-01-22T22:00:00Z

std::int64_t now_ns() { return clock_ns(CLOCK_MONOTONIC); }

/// Stands still for all that a test notices: an hour passes in an hour.
ScaledClock clock_at(std::int64_t utc_s, std::int32_t scale = 1) {
  return {.anchor_monotonic_ns = now_ns(), .anchor_utc_s = utc_s, .scale = scale};
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
    settings.hold_flagged_step = hold_flagged_step_;
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

  bool hold_flagged_step_ = true;
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
      {"implausible", row(kNowS - 60, "100001"), Status::kNoRow},
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

TEST_F(PriceFeedTest, ALargeStepWaitsForTheNextRowAndTheRowBeforeKeepsItsAge) {
  start();
  const PriceReport before = fetch(row(kNowS - 240, "-300"));
  const PriceReport held = fetch(row(kNowS - 180, "9000"));
  EXPECT_EQ(held.status, Status::kOk);
  EXPECT_TRUE(held.step_held);
  EXPECT_EQ(held.held_centi_eur_per_mwh, 900'000);
  EXPECT_EQ(held.minute_utc_s, kNowS - 240);
  EXPECT_EQ(held.price_centi_eur_per_mwh, -30'000);
  EXPECT_EQ(held.received_monotonic_ns, before.received_monotonic_ns);
  EXPECT_FALSE(held.large_step);
  EXPECT_TRUE(fetch(row(kNowS - 240, "-300")).step_held);  // a duplicate changes nothing
  const PriceReport confirmed = fetch(row(kNowS - 120, "8900"));
  EXPECT_FALSE(confirmed.step_held);
  EXPECT_TRUE(confirmed.large_step);
  EXPECT_EQ(confirmed.minute_utc_s, kNowS - 120);
  EXPECT_EQ(confirmed.price_centi_eur_per_mwh, 890'000);
  EXPECT_GT(confirmed.received_monotonic_ns, before.received_monotonic_ns);
}

TEST_F(PriceFeedTest, ALargeStepIsFlaggedAndUsedWhereItShallNotBeHeld) {
  hold_flagged_step_ = false;
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
  ScaledClock scaled_clock;
  [[nodiscard]] const ScaledClock& scaled() const { return scaled_clock; }
  [[nodiscard]] std::int64_t now_utc_ns() const { return scaled_clock.now_utc_ns(); }
  [[nodiscard]] std::int64_t monotonic_ns() const { return now_ns(); }
  [[nodiscard]] std::int64_t monotonic_ns_at(std::int64_t utc_ns) const {
    return scaled_clock.monotonic_ns_at(utc_ns);
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
  auto feed = std::make_unique<PriceFeed>(settings, clock.scaled());
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
      // The limit counts at the tick; the age in the record is that of the write, whenever it was.
      EXPECT_LE(price_age_s(record.utc_s, record.price.minute_utc_s), 240)
          << utc_text(record.utc_s).view();
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

/// A server with pages as Opendatasoft has them, or with less; its rows lie before kNowS, one a
/// minute, and cost as many EUR/MWh as minutes have passed since.
class HistoryTest : public ::testing::Test {
 protected:
  static std::int32_t centi_of(int age_min) { return 100 * age_min; }

  std::string page(const std::string& request) {
    const auto number = [&](const std::string& key) {
      const std::size_t at = request.find(key);
      return at == std::string::npos ? -1 : std::atoi(request.c_str() + at + key.size());
    };
    if (number("&limit=") > 100 || request.find("limit=20") != std::string::npos) return "[0";
    const int first = knows_pages ? number("&offset=") : 0;
    std::string rows;
    for (int i = first; i < std::min(first + rows_per_page, rows_held); ++i) {
      const bool is_null = i >= null_from && i < null_from + 150;
      rows += (rows.empty() ? "" : ",") +
              row(kNowS - 60 * (i + 1), is_null ? "null" : std::to_string(i + 1));
    }
    return "{\"results\":[" + rows + "]}";
  }

  Status fetch(int hours, const std::string& history_url = "") {
    TestServer* self = nullptr;
    TestServer server([&](TestConnection& connection, const std::string& request) {
      requests.push_back(request.substr(0, request.find(" HTTP")));
      if (silent_from > 0 && static_cast<int>(requests.size()) >= silent_from) {
        self->wait_for_end();
        return false;
      }
      const bool fails = std::count(failing.begin(), failing.end(), requests.size()) > 0;
      return connection.answer(page(request),
                               fails ? "HTTP/1.1 500 Oh\r\n" : "HTTP/1.1 200 OK\r\n");
    });
    self = &server;
    PriceFeedSettings price;
    const std::string host = "http://127.0.0.1:" + std::to_string(server.port());
    price.http.url = FixedText<511>(host + "/now?order_by=datetime%20desc&limit=20&timezone=UTC");
    HistorySettings settings{.hours = hours, .wait_s = wait_s, .url = {}};
    if (!history_url.empty()) settings.url = FixedText<511>(host + history_url);
    const TestClock clock{clock_at(kNowS, time_scale)};
    PriceFeed feed(price, clock.scaled());
    history = std::make_unique<PriceHistory>(hours, kNowS);
    const std::int64_t start_ns = now_ns();
    const Status status = fetch_history(feed, price, settings, clock, *history);
    took_ms = (now_ns() - start_ns) / kMillisecond;
    return status;
  }

  int rows_held = 100'000;
  int rows_per_page = 100;
  int null_from = 1'000'000;
  bool knows_pages = true;
  int silent_from = 0;  ///< this request and all after it get no answer; 0 = none
  std::int32_t wait_s = 20;
  std::int32_t time_scale = 1;
  std::vector<std::size_t> failing;
  std::vector<std::string> requests;
  std::unique_ptr<PriceHistory> history;
  std::int64_t took_ms = 0;
};

TEST_F(HistoryTest, PagesAreAskedForUntilTheHoursAreFull) {
  EXPECT_EQ(fetch(72), Status::kOk);
  EXPECT_EQ(history->rows(), 72 * 60);
  EXPECT_EQ(history->hours_covered(), 72);
  ASSERT_EQ(requests.size(), 44U);  // 4,320 rows
  EXPECT_EQ(requests[0], "GET /now?order_by=datetime%20desc&timezone=UTC&limit=100&offset=0");
  EXPECT_EQ(requests[43], "GET /now?order_by=datetime%20desc&timezone=UTC&limit=100&offset=4300");
  PriceLevel level;  // kNowS is a tick: it saw the row of one minute ago
  for (int age_min = 72 * 60 - 1; age_min > 0; age_min -= 2) {
    level.observe(kNowS - 60 * age_min, centi_of(age_min));
  }
  EXPECT_EQ(history->level(), level);
}

TEST_F(HistoryTest, ThePageThatIsShortOrWithoutPricesIsNotTheLast) {
  rows_per_page = 30;
  null_from = 95;  // five pages without a price
  EXPECT_EQ(fetch(5), Status::kOk);
  EXPECT_EQ(history->rows(), 150);
  EXPECT_EQ(requests.size(), 10U);
}

TEST_F(HistoryTest, AServerThatHasLessIsAskedOnceMore) {
  rows_held = 250;
  EXPECT_EQ(fetch(72), Status::kOk);
  EXPECT_EQ(history->rows(), 250);
  EXPECT_EQ(history->hours_covered(), 5);
  EXPECT_EQ(requests.size(), 4U);
}

TEST_F(HistoryTest, AServerWithoutPagesGivesWhatItHas) {
  knows_pages = false;
  rows_per_page = 20;
  EXPECT_EQ(fetch(72), Status::kOk);
  EXPECT_EQ(history->rows(), 20);
  EXPECT_EQ(requests.size(), 2U);
}

TEST_F(HistoryTest, TheSecondUrlIsAskedForWhatTheFirstNoLongerHas) {
  rows_held = 150;
  EXPECT_EQ(fetch(3, "/past"), Status::kOk);
  ASSERT_EQ(requests.size(), 6U);  // 100, 50 and none of each
  EXPECT_EQ(requests[3], "GET /past?limit=100&offset=0");
  EXPECT_EQ(history->rows(), 150);  // the same ones
}

TEST_F(HistoryTest, AFailedPageIsAskedForAgainAndThenWhatThereIsMustDo) {
  failing = {2, 4};
  EXPECT_EQ(fetch(10), Status::kOk);
  EXPECT_EQ(history->rows(), 600);
  EXPECT_EQ(requests.size(), 8U);
  requests.clear();
  failing = {2, 4, 6};
  EXPECT_EQ(fetch(10), Status::kHttpError);
  EXPECT_EQ(history->rows(), 300);
  EXPECT_EQ(requests.size(), 6U);
}

TEST_F(HistoryTest, ASilentServerHoldsUpNobodyPastTheDeadline) {
  silent_from = 3;
  wait_s = 1;
  EXPECT_EQ(fetch(10), Status::kTimeout);
  EXPECT_EQ(history->rows(), 200);
  EXPECT_LT(took_ms, 4'000);
}

TEST_F(HistoryTest, TheDeadlineIsOfTheScaledClock) {
  silent_from = 1;
  wait_s = 900;
  time_scale = 900;
  EXPECT_EQ(fetch(10), Status::kTimeout);
  EXPECT_EQ(history->rows(), 0);
  EXPECT_LT(took_ms, 4'000);
}

TEST_F(HistoryTest, NobodyListeningIsNoHistory) {
  const TestClock clock{clock_at(kNowS)};
  PriceFeedSettings price;
  price.http.url = "http://127.0.0.1:1/";
  PriceFeed feed(price, clock.scaled());
  PriceHistory none(72, kNowS);
  EXPECT_EQ(fetch_history(feed, price, HistorySettings{}, clock, none), Status::kNotConnected);
  EXPECT_FALSE(none.level().is_known());
  int items = 0;
  const PriceRowTaker taker{nullptr, [](void*, const PriceRow&) { ADD_FAILURE(); }};
  EXPECT_EQ(feed.fetch_page("http://127.0.0.1:2/", 1'000, taker, items), Status::kMalformed);
}

}  // namespace
}  // namespace bess
