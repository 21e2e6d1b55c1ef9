// Student by outlook in the chain: trained by a program that plans on day-ahead prices, monotone in
// its break-even price by construction, stored in files, and exported with the integers of its
// plan.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "shared/host/file.h"
#include "tests/support/outlook_inputs.h"
#include "tests/support/outlook_market.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/thorough.h"
#include "tests/support/tokens.h"
#include "tests/support/user_error_of.h"
#include "workstation/correction/distillation/monotone_distil.h"
#include "workstation/correction/rules/rule.h"
#include "workstation/correction/student/correct_and_prove.h"
#include "workstation/correction/student/student_file.h"
#include "workstation/correction/student/student_policy.h"
#include "workstation/data/env/evaluate.h"
#include "workstation/policy/rl/train.h"

namespace bess {
namespace {

using testing::HasSubstr;

struct School {
  MarketSteps market = outlook_market({2025, 3, 1}, 31).steps();
  Teacher teacher = train_teacher(market, {}, options(), [] { return false; }).teacher;

  static TrainOptions options() {
    TrainOptions o;
    o.method = Method::kSdp;
    o.context = ContextKind::kOutlook;
    return o;
  }
  static DistilOptions distil_options() {
    DistilOptions o;
    o.epochs = 30;
    o.rules = with_outlook_rule({});
    return o;
  }
  [[nodiscard]] StudentFile student() const {
    const DistilOptions o = distil_options();
    const TrainingBatch states =
        make_training_states(teacher, visited_inputs(teacher, market, {}, o), o);
    MonotoneDistiller distiller(teacher, states, o);
    distiller.run(o.epochs, {}, false, [](double) {});
    StudentFile file{};
    file.net = quantise_student(distiller.parameters(), teacher.price_map, kSaturation);
    file.net.context = teacher.context;
    file.outlook = teacher.plan_cache;
    file.certificate.rules = o.rules;
    return file;
  }
};

const School& school() {
  static const School made;
  return made;
}
const StudentFile& student() {
  static const StudentFile made = school().student();
  return made;
}

Evaluation earned(Policy& policy) {
  return evaluate(school().market, school().market.days_of(Split::kHeldOut), policy, {});
}

TEST(OutlookStudent, EarnsMostOfWhatItsTeacherDoes) {
  TeacherPolicy teacher(school().teacher);
  const auto policy = exported_policy(student());
  EXPECT_GT(earned(*policy).profit_eur_per_day_per_mwh(),
            0.9 * earned(teacher).profit_eur_per_day_per_mwh());
}

// The plan's break-even price never rises with SoC, and the net's action never falls with it nor
// rises with SoC: so the whole never rises with SoC, nor with the price.
TEST(OutlookStudent, AsAWholeNeverRisesWithSocOrPrice) {
  const auto policy = exported_policy(student());
  for (std::size_t i = 5000; i < school().market.steps.size(); i += 977) {
    MarketStep step = school().market.steps[i];
    for (double price = -300; price <= 600; price += 30) {
      step.observed_eur_per_mwh = price;
      Action before = Action::kCharge;
      for (int soc = 0; soc < kSocCount; ++soc) {
        const Action now = policy->decide(step, 0, static_cast<double>(soc) / (kSocCount - 1));
        ASSERT_LE(now, before) << i << " " << price << " " << soc;
        before = now;
        step.observed_eur_per_mwh = price + 30;
        ASSERT_LE(policy->decide(step, 0, static_cast<double>(soc) / (kSocCount - 1)), now);
        step.observed_eur_per_mwh = price;
      }
    }
  }
}

TEST(OutlookStudent, NeverFallsWithTheClassOverAQuarterHoursLattice) {
  LatticeState state{7, 50, 1, 0, 0};
  for (state.soc_index = 0; state.soc_index < kSocCount; state.soc_index += 8) {
    for (int price = kLatticePriceMinEurPerMwh; price <= kLatticePriceMaxEurPerMwh; price += 3) {
      state.price_eur_per_mwh = static_cast<std::int16_t>(price);
      Action before = Action::kDischarge;
      for (state.context_class = 1; state.context_class <= kContextClassCount;
           ++state.context_class) {
        const Action now = student().net.decide(state);
        ASSERT_GE(now, before);
        before = now;
      }
    }
  }
}

TEST(OutlookStudent, IsReadBackFromItsFileAndDecidesTheSame) {
  const TemporaryFolder folder;
  const auto path = folder.file("student.json");
  save_student(path, student());
  const StudentFile read = load_student(path);
  ASSERT_NE(read.outlook, nullptr);
  EXPECT_EQ(read.net.context, student().net.context);
  EXPECT_EQ(read.certificate.rules.rules.size(), 1U);
  const auto policy = exported_policy(student());
  const auto again = exported_policy(read);
  for (std::size_t i = 0; i < school().market.steps.size(); i += 1511) {
    const MarketStep& step = school().market.steps[i];
    ASSERT_EQ(policy->decide(step, 0, 0.6), again->decide(step, 0, 0.6));
  }
}

TEST(OutlookStudent, ADamagedPlanIsRefused) {
  const TemporaryFolder folder;
  const auto path = folder.file("student.json");
  save_student(path, student());
  std::string text = read_file(path);
  const std::size_t at = text.find("\"discount_q15\"");
  ASSERT_NE(at, text.npos);
  const std::size_t digit = text.find_first_of("0123456789", at + 15);
  text[digit] = '1';
  EXPECT_THAT(refusal_of([&] { parse_student(text, "mine.json"); }), Names("mine.json"));
}

TEST(OutlookStudent, OwesTheDemandOnItsClassesWhateverItsFileSays) {
  StudentFile claimed = student();
  claimed.certificate.rules = {};
  const RuleSet owed = sample_violations(claimed, 2).certificate.rules;
  ASSERT_EQ(owed.rules.size(), 1U);
  EXPECT_EQ(owed.rules[0].demand->direction(), (Direction{RuleInput::kContextClass, 1}));
}

TEST(OutlookStudent, WhatItCannotDoIsSaid) {
  const auto never = [] { return false; };
  MarketSteps blind = school().market;
  blind.day_ahead = nullptr;
  EXPECT_THAT(refusal_of([&] { train_teacher(blind, {}, School::options(), never); }),
              HasSubstr("--day-ahead"));
  EXPECT_THAT(
      refusal_of([&] { visited_inputs(school().teacher, blind, {}, School::distil_options()); }),
      HasSubstr("--day-ahead"));
  MlpTile tile;
  EXPECT_THAT(
      refusal_of([&] { static_cast<void>(school().teacher.action_values(Matrix(5, 1), tile)); }),
      testing::Ne(""));
  DistilOptions layer = School::distil_options();
  layer.method = CorrectionMethod::kLayer;
  EXPECT_THAT(refusal_of([&] { correct_and_prove(school().teacher, Matrix(8, 1), layer, false); }),
              Names("[distil] method \"construction\""));
  const RuleSet named =
      parse_rules("[[rule]]\nname = \"dear\"\ncontext_classes = [3]\nis = \"idle\"\n", "mine.toml");
  EXPECT_THAT(refusal_of([&] { with_outlook_rule(named); }), Names("mine.toml:1 \"dear\""));
}

// Workstation side of the equality with the edge
// (tests/unit/edge/outlook/outlook_decisions_test.cpp): the same drawn weeks through market,
// publication, plan cache and student file.
//   BESS_THOROUGH=1 BESS_UPDATE_GOLDEN=1 build/student_test --gtest_filter='OutlookEquality.*'

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
