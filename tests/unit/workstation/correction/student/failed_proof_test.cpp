// A proof that failed names what is broken, where, and what to change.
#include "workstation/correction/student/prove.h"

#include <gmock/gmock.h>

#include "shared/host/user_error.h"
#include "tests/support/rule_sets.h"
#include "tests/support/student_nets.h"
#include "tests/support/tokens.h"
#include "workstation/correction/student/verify.h"

namespace bess {
namespace {

using testing::AllOf;

/// Counted in the first context alone: quick, and no less broken.
StudentFile counted(const StudentNet& net, const PriceThresholds& thresholds,
                    const RuleSet& rules) {
  return {net,
          verify_student(net, {.thresholds = thresholds,
                               .rules = rules,
                               .context_stride = kContextCount,
                               .threads = 1}),
          ""};
}

/// LinearNet charges below 0, idles to 1000 and discharges from there: each demand is broken by a
/// known state.
TEST(FailedProof, NamesTheRuleAStateWhatIsDoneThereAndTheMend) {
  RuleSet rules = one_rule("price_max = 1400\nat_least = \"idle\"", "never sell");
  rules.rules.push_back(
      one_rule("price_max = 1450\nsoc_min = 0.5\nat_least = \"idle\"", "b").rules[0]);
  rules.rules.push_back(one_rule("price_min = 900\nis = \"discharge\"", "kept").rules[0]);
  rules.rules.erase(rules.rules.begin() + 2);
  const StudentFile student = counted(LinearNet{}.net(), {-500, 1500}, rules);
  const auto broken = broken_demands(student, CorrectionMethod::kConstruction);
  ASSERT_EQ(broken.size(), 2U);
  EXPECT_EQ(broken[0].count.label(), "rule \"never sell\"");
  EXPECT_THAT(broken[0].example, Names("discharge 1, 00:00, 0, SoC 1400 EUR/MWh"));
  EXPECT_THAT(broken[0].advice,
              Names("100 EUR/MWh [correction] high_price_eur_per_mwh [distil] repair_rounds"));
  const std::string text = describe_failed_proof(student, {round_of(student.certificate)},
                                                 CorrectionMethod::kConstruction, "June: ");
  EXPECT_THAT(text, Names("June: 1 \"never sell\" 1400 EUR/MWh"));
}

/// Where what asks the opposite is far away, room is not what is missing.
TEST(FailedProof, OnlyAnOppositeThatIsNearIsGivenMoreRoom) {
  for (const auto& [price_min, is_near] : {std::pair{-450, true}, std::pair{-250, false}}) {
    RuleSet rules = one_rule("price_min = -450\nprice_max = 300\nis = \"idle\"", "rest");
    rules.rules[0].box.price_min_eur_per_mwh = price_min;
    const StudentFile student = counted(LinearNet{}.net(), {-500, 1500}, rules);
    const auto broken = broken_demands(student, CorrectionMethod::kConstruction);
    ASSERT_EQ(broken.size(), 1U);
    ASSERT_TRUE(broken[0].state);
    EXPECT_EQ(student.net.decide(*broken[0].state), Action::kCharge);
    EXPECT_THAT(broken[0].advice, Names("[distil]"));
    EXPECT_EQ(has_code(broken[0].advice, "50 EUR/MWh"), is_near) << broken[0].advice;
  }
}

TEST(FailedProof, ADirectionIsBrokenBetweenTwoStates) {
  StudentNet rising = LinearNet{.soc_weight = -40, .offset = 9000}.net();
  const StudentFile student = counted(rising, {-501, 1501}, {});
  const auto broken = broken_demands(student, CorrectionMethod::kLayer);
  ASSERT_EQ(broken.size(), 1U);
  EXPECT_EQ(broken[0].count.name, "property 3");
  EXPECT_THAT(broken[0].example, Names("SoC EUR/MWh"));
  EXPECT_THAT(broken[0].advice, Names("[correction] price_slope soc_slope"));
}

TEST(FailedProof, WhatTheLayerCannotLearnIsSentToTheConstruction) {
  const StudentFile student =
      counted(LinearNet{}.net(), {-501, 1501}, one_rule("is_not = \"idle\"", "restless"));
  const auto broken = broken_demands(student, CorrectionMethod::kLayer);
  ASSERT_EQ(broken.size(), 1U);
  EXPECT_THAT(broken[0].example, Names("idle"));
  EXPECT_THAT(broken[0].advice, Names("method = \"construction\""));
}

TEST(ProofRounds, AreWrittenByDemandAndReadBack) {
  const std::vector<ProofRound> rounds{{false, {{"property 1", 2}, {"rule \"a, b\"", 720}}},
                                       {true, {{"property 1", 0}, {"rule \"a, b\"", 9'591'998}}}};
  const std::string csv = proof_rounds_csv(rounds);
  const auto read = parse_proof_rounds_csv(csv, "rounds.csv");
  EXPECT_EQ(proof_rounds_csv(read), csv);
  ASSERT_EQ(read.size(), 2U);
  EXPECT_EQ(read[0].violations(), 722);
  EXPECT_FALSE(read[0].is_whole);
  EXPECT_EQ(read[1].text(), "rule \"a, b\": 9591998");
  EXPECT_THROW(parse_proof_rounds_csv("round,looked_at,demand,violations\n1,moon,x,3\n", "r.csv"),
               UserError);
  EXPECT_THROW(
      parse_proof_rounds_csv("round,looked_at,demand,violations\n2,lattice,x,3\n", "r.csv"),
      UserError);
}

TEST(ProofRounds, ALineNumbersTheRoundAndSaysHowLongTheOthersMayTake) {
  const ProofRound round{false, {{"property 1", 0}, {"rule \"rest\"", 23'994}}};
  EXPECT_THAT(round_line(round, {2, 13, 240}), Names("2 13 \"rest\" 23994 4"));
  const std::string last = round_line({true, {{"property 1", 4}}}, {13, 13, 540});
  EXPECT_THAT(last, AllOf(Names("13 property 1: 4"), testing::Not(Names("9"))));
  EXPECT_THAT(round_line({true, {{"property 1", 0}}}, {1, 13, 9}),
              AllOf(Names("1 13"), testing::Not(Names("property"))));
}

}  // namespace
}  // namespace bess
