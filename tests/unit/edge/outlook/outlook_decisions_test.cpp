// Edge side of the equality with the workstation: drawn weeks go through the day-ahead store, the
// planner, the exchange and a student by outlook (tests/data/golden/outlook_student), and every
// day's decisions have the workstation's checksum (workstation/correction/student/
// outlook_student_test.cpp, which also writes the golden file).
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>

#include "edge/core/control/policy.h"
#include "edge/prices/fetch/outlook_fetcher.h"
#include "shared/features.h"
#include "shared/price_level.h"
#include "tests/support/market_zone.h"
#include "tests/support/outlook_inputs.h"

namespace bess {
namespace {

class Edge {
 public:
  explicit Edge(const OutlookInputs& inputs) : inputs_(inputs) {}

  DecisionDigest decide_all() {
    for (std::int64_t t = inputs_.start_utc_s + kSecondsPerStep; t < inputs_.end_utc_s;
         t += kSecondsPerStep) {
      take_answers(t);
      planner_.plan({.tick_utc_s = t, .level_centi = level_.centi_eur_per_mwh()},
                    store_.days_at(t));
      if (see_newest_row(t)) decide(t);
    }
    return digest_;
  }
  [[nodiscard]] int sources(OutlookSource source) const {
    return sources_[static_cast<std::size_t>(source)];
  }

 private:
  void take_answers(std::int64_t t) {
    for (; next_ < inputs_.answers.size() && inputs_.answers[next_].received_utc_s <= t; ++next_) {
      const DrawnAnswer& answer = inputs_.answers[next_];
      std::vector<DayAheadRow> rows;
      for (std::size_t q = 0; q < answer.centi.size(); ++q) {
        rows.push_back({answer.first_utc_s + static_cast<std::int64_t>(q) * kSecondsPerQuarterHour,
                        answer.centi[q] / 100.0});
      }
      ASSERT_EQ(store_.take(lay_out_day_ahead(rows).days, answer.received_utc_s), Status::kOk);
    }
  }
  bool see_newest_row(std::int64_t t) {
    auto row = static_cast<std::ptrdiff_t>((t - inputs_.start_utc_s) / 60 - 1);
    while (row >= 0 &&
           inputs_.minute_centi[static_cast<std::size_t>(row)] == OutlookInputs::kNoRow) {
      --row;
    }
    if (row < 0) return false;
    price_centi_ = inputs_.minute_centi[static_cast<std::size_t>(row)];
    level_.observe(inputs_.start_utc_s + row * 60, price_centi_);
    return true;
  }
  void decide(std::int64_t t) {
    const std::int32_t soc_e4 = OutlookInputs::soc_e4(t);
    const OutlookReport report = outlook_at(exchange_, t, soc_e4, level_.centi_eur_per_mwh());
    ++sources_[static_cast<std::size_t>(report.source)];
    const LocalMinute now = local_minute_of(t);
    const std::int16_t context_class = student_context_class(now, report.break_even_centi);
    digest_.add(t, report.break_even_centi, context_class,
                decide_with_student(make_lattice_state(now, context_class, soc_e4, price_centi_)));
  }

  const OutlookInputs& inputs_;
  DayAheadStore store_;
  OutlookExchange exchange_;
  OutlookPlanner planner_{*student_outlook(), exchange_};
  PriceLevel level_;
  std::int32_t price_centi_ = 0;
  std::size_t next_ = 0;
  int sources_[kOutlookSourceCount] = {};
  DecisionDigest digest_;
};

#ifdef BESS_SANITIZED
constexpr int kDaysMax = 4;  // ten times as slow
#else
constexpr int kDaysMax = 1'000;
#endif

void expect_golden(OutlookInputs inputs) {
  inputs.end_utc_s =
      std::min<std::int64_t>(inputs.end_utc_s, inputs.start_utc_s + kDaysMax * 86'400);
  const auto edge = std::make_unique<Edge>(inputs);
  const std::vector<std::string> found = edge->decide_all().lines();
  EXPECT_EQ(found, golden_lines_of(found));
  EXPECT_GT(edge->sources(OutlookSource::kPlanned), 1'000);
  EXPECT_GT(edge->sources(OutlookSource::kUsual), 100);
  // Only the very first price moves the level further than a decision can.
  EXPECT_LE(edge->sources(OutlookSource::kLate), 1);
  EXPECT_EQ(edge->sources(OutlookSource::kMissing), 0);
}

class OutlookDecisions : public InMarketZone, public testing::Test {};

TEST_F(OutlookDecisions, OfWeeksAreTheWorkstations) { expect_golden(drawn_weeks()); }

using OutlookMonths = OutlookDecisions;  // long (tests/unit/edge/CMakeLists.txt)

TEST_F(OutlookMonths, AreTheWorkstations) { expect_golden(drawn_months()); }

TEST_F(OutlookDecisions, TheSelfCheckOfTheHeaderHolds) {
  EXPECT_EQ(count_student_self_check_failures(), 0);
  EXPECT_TRUE(student_context().is_outlook());
}

}  // namespace
}  // namespace bess
