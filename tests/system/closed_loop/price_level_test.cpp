// Price level on both sides: the real control loop, on a market served by bess-sim and read by the
// edge, against the workstation's level of the same minutes. Bit-identical, over gaps, restarts,
// out-of-range prices and both clock changes.
#include <gmock/gmock.h>

#include <map>
#include <memory>
#include <thread>

#include "edge/core/control/level_start.h"
#include "edge/core/control/price_history.h"
#include "edge/prices/fetch/price_fetcher.h"
#include "edge/prices/fetch/price_json.h"
#include "edge/records/log/ring_log.h"
#include "tests/support/fake_plant.h"
#include "tests/support/market_series.h"
#include "tools/simulators/market_sim/market_server.h"
#include "workstation/data/env/market_steps.h"

namespace bess {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// Prices as bess-sim serves them, stored as PriceReader stores them: the newest row of this
/// process. At a stale tick the answer is ten minutes old, so the newest row repeats.
class ServedPrices {
 public:
  ServedPrices(const MarketView& view, const std::vector<std::int64_t>& stale_ticks)
      : view_(view), stale_ticks_(stale_ticks) {}

  void request(std::int64_t minute_utc_s, std::int64_t, std::int64_t) {
    const std::int64_t tick_utc_s = minute_utc_s + 60;
    const bool is_stale = std::count(stale_ticks_.begin(), stale_ticks_.end(), tick_utc_s) > 0;
    const std::int64_t answer_utc_s = tick_utc_s - (is_stale ? 600 : 0);
    PriceRow row;
    report_.status =
        parse_newest_price(view_.records({.limit = 20}, answer_utc_s * kNanosecondsPerSecond),
                           PriceFields{}, tick_utc_s, row);
    if (report_.status != Status::kOk) return;
    if (report_.has_row && row.minute_utc_s < report_.minute_utc_s) return;
    report_.has_row = true;
    report_.minute_utc_s = row.minute_utc_s;
    report_.price_centi_eur_per_mwh = row.price_centi_eur_per_mwh;
  }
  static bool wait(std::int64_t) { return true; }
  [[nodiscard]] PriceReport latest() const { return report_; }

 private:
  const MarketView& view_;
  const std::vector<std::int64_t>& stale_ticks_;
  PriceReport report_;
};

/// Successive runs of the program, on one battery and one market.
class Replay {
 public:
  explicit Replay(const MinuteSeries& series) : series_(series), view_(series, 0) {
    clock_.now_ns = series.start_utc_s * kNanosecondsPerSecond;
    start(PriceLevel{});
  }

  void start(const PriceLevel& level) {
    prices_ = std::make_unique<ServedPrices>(view_, stale_ticks);
    loop_ = std::make_unique<Loop>(ControlSettings{.control = true, .guard = {}}, battery_,
                                   *prices_, clock_);
    loop_->take_over({.throughput = {}, .price_level = level});
  }
  void run_until(std::int64_t utc_s) {
    while (clock_.now_ns / kNanosecondsPerSecond < utc_s - kSecondsPerStep) {
      records.push_back(run_cycle(*loop_));
    }
  }
  /// The program ends; the next one starts later, from the record on disk.
  void restart_after(std::int64_t down_s) {
    RecordBytes bytes;
    encode_record(records.back(), records.size(), bytes);
    CycleRecord before;
    std::uint64_t number = 0;
    ASSERT_TRUE(decode_record(bytes, before, number));
    restart_with(before, down_s);
  }
  void restart_with(const CycleRecord& before, std::int64_t down_s) {
    clock_.now_ns += down_s * kNanosecondsPerSecond;
    const auto no_history = []() -> PriceLevel {
      ADD_FAILURE() << "the log has the level";
      return {};
    };
    const LevelStart found =
        find_start_level(ContextKind::kLevel, before.price_level,
                         clock_.now_ns / kNanosecondsPerSecond, std::nullopt, no_history);
    EXPECT_EQ(found.source, LevelSource::kLog);
    start(found.level);
  }
  [[nodiscard]] std::int64_t end_utc_s() const { return series_.utc_s(series_.size() - 1); }

  /// The minutes as this edge saw them: at most the newest of the rows between two decisions.
  [[nodiscard]] MinuteSeries seen() const {
    MinuteSeries seen = series_;
    std::int64_t before_utc_s =
        series_.start_utc_s - 60;  // newest row that a decision can have seen
    for (const CycleRecord& record : records) {
      if (was_stale(record.utc_s)) continue;
      bool has_newer = false;
      for (std::int64_t utc_s = record.utc_s - 60; utc_s > before_utc_s; utc_s -= 60) {
        double& price =
            seen.indicative[static_cast<std::size_t>((utc_s - series_.start_utc_s) / 60)];
        if (has_newer) price = kNaN;
        has_newer = has_newer || is_published(price);
      }
      before_utc_s = record.utc_s - 60;
    }
    return seen;
  }

  [[nodiscard]] bool was_stale(std::int64_t tick_utc_s) const {
    return std::count(stale_ticks.begin(), stale_ticks.end(), tick_utc_s) > 0;
  }
  static bool is_published(double price) { return std::abs(price) <= 100'000; }

  std::vector<std::int64_t> stale_ticks;
  std::vector<CycleRecord> records;

 private:
  using Loop = ControlLoop<FakeBattery, ServedPrices, FakeClock>;

  const MinuteSeries& series_;
  MarketView view_;
  FakeClock clock_;
  FakeBattery battery_{clock_, 0.5};
  std::unique_ptr<ServedPrices> prices_;
  std::unique_ptr<Loop> loop_;
};

/// The level after each tick, computed independently: the newest available row at the tick.
std::map<std::int64_t, PriceLevel> levels_by_hand(const MinuteSeries& series) {
  std::map<std::int64_t, PriceLevel> levels;
  PriceLevel level;
  std::int64_t newest = -1;
  for (std::size_t minute = 0; minute < series.size(); ++minute) {
    const std::int64_t tick_utc_s =
        series.utc_s(minute) + 60;  // the first instant of its availability
    if (Replay::is_published(series.indicative[minute])) newest = static_cast<std::int64_t>(minute);
    if (tick_utc_s % kSecondsPerStep != 0) continue;
    if (newest >= 0) {
      const auto row = static_cast<std::size_t>(newest);
      level.observe(series.utc_s(row),
                    static_cast<std::int32_t>(std::lround(series.indicative[row] * 100)));
    }
    levels[tick_utc_s] = level;
  }
  return levels;
}

/// Of the decisions on both sides, the required minimum.
void expect_equal_levels(const Replay& replay, std::size_t at_least) {
  const MinuteSeries seen = replay.seen();
  const MarketSteps market = make_market_steps(seen, MarketOptions{});
  const std::map<std::int64_t, PriceLevel> by_hand = levels_by_hand(seen);
  std::map<std::int64_t, std::int32_t> on_workstation;
  for (const MarketStep& step : market.steps) {
    on_workstation[step.utc_s] = step.level_centi_eur_per_mwh;
  }
  std::size_t compared = 0;
  for (const CycleRecord& record : replay.records) {
    if (replay.was_stale(record.utc_s)) continue;  // its row may count at the next tick only
    const std::string at(utc_text(record.utc_s).view());
    ASSERT_TRUE(by_hand.contains(record.utc_s)) << at;
    ASSERT_EQ(record.price_level.centi_q16, by_hand.at(record.utc_s).centi_q16) << at;
    const auto found = on_workstation.find(record.utc_s);
    if (found == on_workstation.end()) continue;  // not settled: no training data
    ASSERT_EQ(record.price_level.centi_eur_per_mwh(), found->second) << at;
    ++compared;
  }
  EXPECT_GE(compared, at_least);
}

/// Whole hundredths, as markets publish.
void round_prices(MinuteSeries& series) {
  for (double& price : series.indicative) price = std::round(price * 100) / 100;
}

/// Rows without a price for minutes (fewer than one answer has rows), no rows for hours, and prices
/// beyond the lattice and beyond plausibility.
void disturb(MinuteSeries& series, std::uint64_t seed) {
  Random random(seed);
  const auto at = [&](int minutes) {
    return static_cast<std::size_t>(random.uniform() *
                                    static_cast<double>(series.size() - minutes));
  };
  for (std::size_t begin = 0; begin + 60 < series.size();) {
    begin += 20 + static_cast<std::size_t>(random.uniform() * 180);
    const auto minutes = 1 + static_cast<std::size_t>(random.uniform() * 14);
    for (std::size_t i = 0; i < minutes && begin + i < series.size(); ++i) {
      series.indicative[begin + i] = kNaN;
    }
    begin += minutes;
  }
  for (int outage = 0; outage < 8; ++outage) {
    const int minutes = 60 + static_cast<int>(random.uniform() * 480);
    const std::size_t begin = at(minutes);
    for (int i = 0; i < minutes; ++i)
      series.indicative[begin + i] = series.settled[begin + i] = kNaN;
  }
  for (const double price :
       {1'500.0, 1'500.01, 2'548.0, 15'000.01, 25'907.54, 100'000.0, 100'000.01, 140'000.0}) {
    for (int i = 0; i < 20; ++i) {
      series.indicative[at(1)] = price;
      series.indicative[at(1)] = -price;
    }
  }
}

/// 32 days around the last Sunday of the month.
void replay_month(MinuteSeries series, std::uint64_t seed) {
  set_market_time_zone();
  round_prices(series);
  disturb(series, seed);
  Replay replay(series);
  Random random(seed + 1);
  std::int64_t next_utc_s = series.start_utc_s;
  // Seconds: within a step, over some steps, hours, more than a day.
  for (const std::int64_t down_s :
       {1, 90, 121, 600, 3'600, 33'333, 100'000, 240, 7'200, 30, 1'800}) {
    next_utc_s += 86'400 + static_cast<std::int64_t>(random.uniform() * 86'400);
    for (int i = 0; i < 3; ++i) {
      const auto steps = static_cast<std::int64_t>(random.uniform() * 700);
      replay.stale_ticks.push_back(next_tick_utc_s(next_utc_s) - kSecondsPerStep * (10 + steps));
    }
    replay.run_until(next_utc_s);
    replay.restart_after(down_s);
    next_utc_s += down_s;
  }
  replay.run_until(replay.end_utc_s());
  expect_equal_levels(replay, 19'000);  // of 23,040: the rest are outages
}

TEST(PriceLevelReplay, EqualsTheWorkstationsOverAMonthIntoSummerTime) {
  const MinuteSeries benchmark = read_benchmark();
  const std::int64_t start_utc_s = utc_of("2023-03-04T23:00:00Z");
  const auto begin = static_cast<std::ptrdiff_t>((start_utc_s - benchmark.start_utc_s) / 60);
  const std::ptrdiff_t minutes = 32 * kMinutesPerDay;
  const auto cut = [&](const std::vector<double>& prices) {
    return std::vector<double>(prices.begin() + begin, prices.begin() + begin + minutes);
  };
  replay_month({start_utc_s, cut(benchmark.indicative), cut(benchmark.settled)}, 26);
}

TEST(PriceLevelReplay, EqualsTheWorkstationsOverAMonthOutOfSummerTime) {
  replay_month(random_series("2023-10-07T22:01:00Z", 32 * kMinutesPerDay, 8), 29);
}

MinuteSeries four_days() {
  set_market_time_zone();
  MinuteSeries series = random_series("2023-03-23T23:00:00Z", 4 * kMinutesPerDay, 3);
  round_prices(series);
  return series;
}

TEST(PriceLevelHistory, FetchedFromBessSimEqualsTheWorkstations) {
  MinuteSeries series = four_days();
  disturb(series, 5);
  const std::int64_t now_utc_s = utc_of("2023-03-27T09:41:30Z");
  // In real time, which is late enough for three days of rows.
  const ScaledClock clock{
      .anchor_monotonic_ns = clock_ns(CLOCK_MONOTONIC), .anchor_utc_s = now_utc_s, .scale = 1};
  const MarketView view(series, 0);
  MarketServerSettings server_settings;
  server_settings.port = 0;
  MarketServer server(server_settings, view, clock);
  std::thread serving([&server] { server.run(); });
  const std::string root =
      "http://127.0.0.1:" + std::to_string(server.port()) + "/api/explore/v2.1/catalog/datasets/";
  const std::string order = "/records?order_by=datetime%20desc&limit=20&timezone=UTC";
  const auto config = std::make_unique<EdgeConfig>();
  config->clock = clock;
  config->price.feed.http.url = FixedText<511>(root + "ods161" + order);
  config->price.history.url = FixedText<511>(root + "ods133" + order);
  const PublishedHistory history = find_history(*config);
  EXPECT_EQ(history.status, Status::kOk);
  server.stop();
  serving.join();
  EXPECT_EQ(history.hours, 72);

  // The workstation has the same three days only.
  MinuteSeries known{.start_utc_s = PriceHistory(72, now_utc_s).first_minute_utc_s(),
                     .indicative = {},
                     .settled = {}};
  const auto begin = static_cast<std::ptrdiff_t>((known.start_utc_s - series.start_utc_s) / 60);
  const std::ptrdiff_t end = begin + 72 * 60 + kMinutesPerStep;  // the last tick's step is complete
  known.indicative.assign(series.indicative.begin() + begin, series.indicative.begin() + end);
  known.settled.assign(static_cast<std::size_t>(end - begin), 50.0);
  const MarketSteps market = make_market_steps(known, MarketOptions{});
  EXPECT_EQ(market.steps.back().utc_s, utc_of("2023-03-27T09:40:00Z"));
  EXPECT_EQ(market.steps.back().level_centi_eur_per_mwh, history.level.centi_eur_per_mwh());
  EXPECT_EQ(levels_by_hand(known).at(market.steps.back().utc_s), history.level);
}

}  // namespace
}  // namespace bess
