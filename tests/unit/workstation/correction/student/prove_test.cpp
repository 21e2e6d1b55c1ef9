// The prover's word: what it says yes and no to, and that nobody else can say yes.
#include "workstation/correction/student/prove.h"

#include <gtest/gtest.h>

#include <type_traits>

#include "shared/host/user_error.h"
#include "tests/support/proved_students.h"
#include "workstation/correction/student/export.h"

namespace bess {
namespace {

// Nobody else makes one,
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
static_assert(kReadsOnly<decltype(&ProvedStudent::net)>);
static_assert(kReadsOnly<decltype(&ProvedStudent::certificate)>);
static_assert(kReadsOnly<decltype(&ProvedStudent::provenance)>);
static_assert(kReadsOnly<decltype(&ProvedStudent::file)>);
// or exports anything else.
static_assert(std::is_invocable_v<decltype(format_weight_header), const ProvedStudent&>);
static_assert(!std::is_invocable_v<decltype(format_weight_header), const StudentFile&>);
static_assert(!std::is_invocable_v<decltype(format_weight_header), const Verdict&>);

TEST(Prove, AProvedStudentCarriesTheCertificateOfTheWholeLattice) {
  const ProvedStudent& student = crowded_student();
  EXPECT_EQ(student_weights_hash(student.net()), student_weights_hash(crowded_net()));
  EXPECT_EQ(student.provenance(), kCrowdedProvenance);
  const Certificate& certificate = student.certificate();
  EXPECT_EQ(certificate.thresholds, kCrowdedThresholds);
  EXPECT_EQ(certificate.states_checked, 6'950'033'280);
  EXPECT_EQ(certificate.states_evaluated, 0) << "bounds decide every box of this net";
  EXPECT_EQ(certificate.violations(), 0);
  EXPECT_TRUE(certificate.counterexamples.empty());
}

/// Whatever a file claims, its weights are looked at.
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
  EXPECT_FALSE(Certificate{}.covers_lattice_without_violation()) << "nobody has looked yet";
  Certificate quick_look = flawless_claim();
  quick_look.states_checked /= 2;
  EXPECT_FALSE(quick_look.covers_lattice_without_violation());
  for (int property = 1; property <= kPropertyCount; ++property) {
    Certificate broken = flawless_claim();
    broken.set_violations_of(property, 1);
    EXPECT_FALSE(broken.covers_lattice_without_violation());
  }
}

}  // namespace
}  // namespace bess
