// Prover: its yes and no, its exclusive right to a yes, and what a failed proof names: the
// violation, its state, and the change.
#include "workstation/correction/student/prove.h"

#include <gmock/gmock.h>

#include <type_traits>

#include "shared/host/user_error.h"
#include "tests/support/proved_students.h"
#include "tests/support/rule_sets.h"
#include "tests/support/student_nets.h"
#include "tests/support/tokens.h"
#include "workstation/correction/student/certificate.h"
#include "workstation/correction/student/export.h"

namespace bess {
namespace {

using testing::AllOf;

// No other code makes one,
static_assert(!std::is_default_constructible_v<ProvedStudent>);
static_assert(!std::is_aggregate_v<ProvedStudent>);
static_assert(!std::is_constructible_v<ProvedStudent, StudentFile>);
static_assert(!std::is_constructible_v<ProvedStudent, const StudentFile&>);
static_assert(!std::is_constructible_v<ProvedStudent, StudentNet, Certificate>);
static_assert(!std::is_constructible_v<ProvedStudent, StudentNet, Certificate, std::string>);
static_assert(!std::is_assignable_v<ProvedStudent&, StudentFile>);
// changes one afterwards,
template <typename Getter>
constexpr bool kReadsOnly =
    std::is_const_v<std::remove_reference_t<std::invoke_result_t<Getter, ProvedStudent&>>>;
static_assert(kReadsOnly<decltype(&ProvedStudent::file)>);
// or exports anything else.
static_assert(std::is_invocable_v<decltype(format_weight_header), const ProvedStudent&>);
static_assert(!std::is_invocable_v<decltype(format_weight_header), const StudentFile&>);
static_assert(!std::is_invocable_v<decltype(format_weight_header), const Verdict&>);

TEST(Prove, AProvedStudentCarriesTheCertificateOfTheWholeLattice) {
  const StudentFile& student = crowded_student().file();
  EXPECT_EQ(student_weights_hash(student.net), student_weights_hash(crowded_net()));
  EXPECT_EQ(student.provenance, kCrowdedProvenance);
  const Certificate& certificate = student.certificate;
  EXPECT_EQ(certificate.thresholds, kCrowdedThresholds);
  EXPECT_EQ(certificate.states_checked, 6'950'033'280);
  EXPECT_EQ(certificate.states_evaluated, 0) << "bounds decide every box of this net";
  EXPECT_EQ(certificate.violations(), 0);
  EXPECT_TRUE(certificate.counterexamples.empty());
}

/// Weights are checked, whatever the file claims.
TEST(Prove, AForgedCertificateIsReplacedByWhatIsFound) {
  const StudentFile forged{LinearNet{.charge_below = 0}.net(), flawless_claim(), "never charges"};
  ASSERT_TRUE(forged.certificate.covers_lattice_without_violation());
  const Verdict verdict = prove(forged, 2);
  ASSERT_FALSE(std::holds_alternative<ProvedStudent>(verdict));
  const StudentFile& left = student_of(verdict);
  EXPECT_EQ(student_weights_hash(left.net), student_weights_hash(forged.net));
  EXPECT_EQ(left.certificate.states_checked, kLatticeStateCount);
  EXPECT_EQ(left.certificate.violations_of(1), kContextCount * kSocCount);
  EXPECT_EQ(left.certificate.violations_of(2), 0);
  EXPECT_EQ(left.certificate.violations_of(3), 0);
  EXPECT_FALSE(left.certificate.counterexamples.empty());
  for (const LatticeState& state : left.certificate.counterexamples) {
    ASSERT_EQ(state.price_eur_per_mwh, kLatticePriceMinEurPerMwh);
  }
}

TEST(Prove, NetsThatTheBoundsDoNotHoldForAreNoMatterOfProof) {
  StudentFile falling{LinearNet{}.net(), {}, ""};
  std::swap(falling.net.price_map[100], falling.net.price_map[101]);
  EXPECT_THROW(static_cast<void>(prove(falling, 2)), UserError);
  StudentFile overflowing{LinearNet{}.net(), {}, ""};
  overflowing.net.layer1.bias[0] = INT32_MAX;
  EXPECT_THROW(static_cast<void>(prove(overflowing, 2)), UserError);
}

TEST(Prove, ASampleCountsInEverySeventhContextAndProvesNothing) {
  constexpr std::int64_t kContexts = (kContextCount + kSampleStride - 1) / kSampleStride;
  const StudentFile never_charges{LinearNet{.charge_below = 0}.net(), flawless_claim(), ""};
  const Certificate sample = sample_violations(never_charges, 2).certificate;
  EXPECT_EQ(sample.states_checked, kContexts * kSocCount * kPriceCount);
  EXPECT_EQ(sample.violations_of(1), kContexts * kSocCount);
  EXPECT_EQ(sample.violations(), sample.violations_of(1));
  const StudentFile flawless{crowded_net(), {.thresholds = kCrowdedThresholds}, ""};
  const Certificate no_proof = sample_violations(flawless, 2).certificate;
  EXPECT_EQ(no_proof.violations(), 0);
  EXPECT_FALSE(no_proof.covers_lattice_without_violation());
}

TEST(Certificate, CoversTheLatticeOnlyAsAWhole) {
  EXPECT_TRUE(flawless_claim().covers_lattice_without_violation());
  EXPECT_FALSE(Certificate{}.covers_lattice_without_violation()) << "not proved yet";
  Certificate quick_look = flawless_claim();
  quick_look.states_checked /= 2;
  EXPECT_FALSE(quick_look.covers_lattice_without_violation());
  for (int property = 1; property <= kPropertyCount; ++property) {
    Certificate broken = flawless_claim();
    broken.set_violations_of(property, 1);
    EXPECT_FALSE(broken.covers_lattice_without_violation());
  }
}

/// Counted in the first context only: faster, and equally wrong.
StudentFile counted(const StudentNet& net, const PriceThresholds& thresholds,
                    const RuleSet& rules) {
  return {net,
          verify_student(net, {.thresholds = thresholds,
                               .rules = rules,
                               .context_stride = kContextCount,
                               .threads = 1}),
          ""};
}

/// LinearNet charges below 0, idles to 1000 and discharges from there: each demand is violated in a
/// known state.
TEST(FailedProof, NamesTheRuleAStateItsActionAndTheRemedy) {
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

TEST(StudentCheckpoints, ReadBackWhatWasWritten) {
  const std::vector<StudentCheckpoint> written{{1, 300, 486.25, CheckpointState::kDisobeys},
                                               {1, 600, -3.5, CheckpointState::kPassedOver},
                                               {2, 640, 485, CheckpointState::kChosen}};
  const std::string text = student_checkpoints_csv(written);
  EXPECT_NE(text.find("1,300,486.2500,disobeys\n"), std::string::npos) << text;
  const auto read = parse_student_checkpoints_csv(text, "checkpoints.csv");
  ASSERT_EQ(read.size(), written.size());
  for (std::size_t i = 0; i < read.size(); ++i) {
    EXPECT_EQ(read[i].round, written[i].round);
    EXPECT_EQ(read[i].epoch, written[i].epoch);
    EXPECT_EQ(read[i].validation_eur_per_day_per_mwh, written[i].validation_eur_per_day_per_mwh);
    EXPECT_EQ(read[i].state, written[i].state);
  }
  EXPECT_TRUE(parse_student_checkpoints_csv(student_checkpoints_csv({}), "none.csv").empty());
}

TEST(StudentCheckpoints, AStrangeStateNamesFileAndLine) {
  EXPECT_THAT(
      [] {
        (void)parse_student_checkpoints_csv(
            "round,epoch,validation_eur_per_day_per_mwh,state\n1,2,3,taken\n", "checkpoints.csv");
      },
      testing::ThrowsMessage<UserError>(Names("checkpoints.csv:2 \"taken\"")));
}

}  // namespace
}  // namespace bess
