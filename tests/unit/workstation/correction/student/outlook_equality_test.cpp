// Workstation side of the equality with the edge
// (tests/unit/edge/outlook/outlook_decisions_test.cpp): the same drawn weeks through market,
// publication, plan cache and student file.
//   BESS_THOROUGH=1 BESS_UPDATE_GOLDEN=1 build/student_test --gtest_filter='OutlookEquality.*'
#include <gtest/gtest.h>

#include <cmath>

#include "shared/host/file.h"
#include "tests/support/outlook_inputs.h"
#include "tests/support/thorough.h"
#include "workstation/correction/student/student_file.h"
#include "workstation/correction/student/student_policy.h"

namespace bess {
namespace {

double eur(std::int32_t centi) { return static_cast<double>(centi) / kCentiPerEur; }

MarketSteps market_of(const OutlookInputs& inputs) {
  MinuteSeries minutes{inputs.start_utc_s, {}, {}};
  for (const std::int32_t centi : inputs.minute_centi) {
    minutes.indicative.push_back(centi == OutlookInputs::kNoRow ? std::nan("") : eur(centi));
    minutes.settled.push_back(50);
  }
  DayAheadSeries ahead;
  std::map<std::int64_t, DayAheadRow> by_time;
  for (const DrawnAnswer& answer : inputs.answers) {
    for (std::size_t q = 0; q < answer.centi.size(); ++q) {
      const std::int64_t t =
          answer.first_utc_s + static_cast<std::int64_t>(q) * kSecondsPerQuarterHour;
      by_time.try_emplace(t, DayAheadRow{t, eur(answer.centi[q]), 15, answer.received_utc_s});
    }
  }
  for (const auto& [t, price] : by_time) EXPECT_TRUE(append_day_ahead(ahead, price));
  MarketSteps market = make_market_steps(minutes, {});
  attach_day_ahead(market, std::make_shared<DayAheadPublication>(ahead));
  return market;
}

std::vector<std::string> decided(const OutlookInputs& inputs) {
  const StudentFile student =
      load_student(BESS_SOURCE_DIR "/tests/data/golden/outlook_student/student.json");
  const MarketSteps market = market_of(inputs);
  const StudentPolicy policy(student.net, student.outlook);
  DecisionDigest digest;
  for (const MarketStep& step : market.steps) {
    const double soc_frac = OutlookInputs::soc_e4(step.utc_s) / double{kSocFullE4};
    const std::int32_t break_even = student.outlook->break_even_centi(step, soc_frac);
    digest.add(step.utc_s, break_even, student.net.context.class_of(step.month, break_even),
               policy.decide(step, 0, soc_frac));
  }
  return digest.lines();
}

TEST(OutlookEquality, OfWeeksAndTheEdges) {
  const std::vector<std::string> found = decided(drawn_weeks());
  if (std::getenv("BESS_UPDATE_GOLDEN") != nullptr && few_or_all(0, 1) == 1) {
    std::string text =
        "# generator student_test, version 1, integers drawn from 20261125, command: "
        "BESS_THOROUGH=1 "
        "BESS_UPDATE_GOLDEN=1 student_test --gtest_filter=OutlookEquality.*\n";
    for (const auto& lines : {found, decided(drawn_months())}) {
      for (const std::string& line : lines) text += line + "\n";
    }
    write_file(outlook_golden_path(), text);
  }
  EXPECT_EQ(found, golden_lines_of(found));
  EXPECT_EQ(found.size(), 14U);
}

// Long (tests/unit/workstation/CMakeLists.txt).
TEST(OutlookMonthsEquality, AndTheEdges) {
  const std::vector<std::string> found = decided(drawn_months());
  EXPECT_EQ(found, golden_lines_of(found));
  EXPECT_EQ(found.size(), 91U);
}

}  // namespace
}  // namespace bess
