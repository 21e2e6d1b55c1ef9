// Margins against the student itself: over whole columns of the lattice for drawn states, at their
// edges for every context, and against the guard in hundredths of EUR/MWh.
#include "edge/records/why/margins.h"

#include <gtest/gtest.h>

#include <random>

#include "edge/core/control/policy.h"
#include "edge/core/control/safety_guard.h"
#include "tests/support/guard_inputs.h"
#include "tests/support/thorough.h"

namespace bess {
namespace {

constexpr PriceThresholds kThresholds;

std::int16_t drawn(std::mt19937_64& random, int first, int last) {
  return static_cast<std::int16_t>(std::uniform_int_distribution<int>(first, last)(random));
}

LatticeState drawn_state(std::mt19937_64& random) {
  return {.minute_of_quarter_hour = drawn(random, 0, kMinutesPerQuarterHour - 1),
          .quarter_hour = drawn(random, 0, kQuarterHourCount - 1),
          .context_class = drawn(random, 1, kContextClassCount),
          .soc_index = drawn(random, 0, kSocCount - 1),
          .price_eur_per_mwh = drawn(random, kLatticePriceMinEurPerMwh, kLatticePriceMaxEurPerMwh)};
}

/// Joint decision of thresholds and student at a price.
Action requested_action_at(LatticeState state, std::int32_t price_centi,
                           const PriceThresholds& thresholds, Policy policy = decide_with_student) {
  if (price_centi <= thresholds.low_eur_per_mwh * kCentiPerEur) return Action::kCharge;
  if (price_centi >= thresholds.high_eur_per_mwh * kCentiPerEur) return Action::kDischarge;
  state.price_eur_per_mwh = lattice_price_of(price_centi);
  return policy(state);
}

Action said_of_price(const Margins& margins, std::int32_t price_centi) {
  if (price_centi <= margins.charge_up_to_centi) return Action::kCharge;
  return price_centi >= margins.discharge_from_centi ? Action::kDischarge : Action::kIdle;
}

Action said_of_soc(const Margins& margins, std::int32_t soc_e4) {
  if (margins.charges_at_some_soc && soc_e4 <= margins.charge_up_to_soc_e4) return Action::kCharge;
  const bool discharges = margins.discharges_at_some_soc && soc_e4 >= margins.discharge_from_soc_e4;
  return discharges ? Action::kDischarge : Action::kIdle;
}

TEST(Margins, AreWholeColumnsOfTheLatticeForDrawnStates) {
  std::mt19937_64 random(20'261'123);
  const int states = few_or_all(150, 10'000);
  for (int i = 0; i < states; ++i) {
    const LatticeState state = drawn_state(random);
    const std::int32_t price_centi = state.price_eur_per_mwh * kCentiPerEur;
    const Margins margins = find_margins(state, price_centi, kThresholds, decide_with_student);
    for (int price = kLatticePriceMinEurPerMwh; price <= kLatticePriceMaxEurPerMwh; ++price) {
      ASSERT_EQ(said_of_price(margins, price * kCentiPerEur),
                requested_action_at(state, price * kCentiPerEur, kThresholds))
          << "state " << i << " at " << price;
    }
    for (int soc_index = 0; soc_index < kSocCount; ++soc_index) {
      LatticeState at = state;
      at.soc_index = static_cast<std::int16_t>(soc_index);
      ASSERT_EQ(said_of_soc(margins, soc_index * kSocE4PerLatticeStep),
                requested_action_at(at, price_centi, kThresholds))
          << "state " << i << " at SoC index " << soc_index;
    }
  }
}

/// The student is proved to be monotone, so only its edges can be wrong.
TEST(Margins, TurnWhereTheStudentDoesInEveryContext) {
  std::mt19937_64 random(17'280);
  for (int context = 0; context < kContextCount; ++context) {
    LatticeState state = drawn_state(random);
    state.minute_of_quarter_hour = static_cast<std::int16_t>(context % kMinutesPerQuarterHour);
    state.quarter_hour =
        static_cast<std::int16_t>(context / kMinutesPerQuarterHour % kQuarterHourCount);
    state.context_class = static_cast<std::int16_t>(
        context / (kMinutesPerQuarterHour * kQuarterHourCount) % kContextClassCount + 1);
    const std::int32_t price_centi = state.price_eur_per_mwh * kCentiPerEur;
    const Margins margins = find_margins(state, price_centi, kThresholds, decide_with_student);
    for (const std::int32_t edge_centi :
         {margins.charge_up_to_centi, margins.charge_up_to_centi + 1,
          margins.discharge_from_centi - 1, margins.discharge_from_centi}) {
      ASSERT_EQ(said_of_price(margins, edge_centi),
                requested_action_at(state, edge_centi, kThresholds))
          << "context " << context << " at " << edge_centi;
    }
    for (const std::int32_t edge_e4 :
         {margins.charge_up_to_soc_e4, margins.charge_up_to_soc_e4 + 1,
          margins.discharge_from_soc_e4 - 1, margins.discharge_from_soc_e4}) {
      if (edge_e4 < 0 || edge_e4 > kSocFullE4) continue;
      LatticeState at = state;
      at.soc_index = soc_index_of(edge_e4);
      ASSERT_EQ(said_of_soc(margins, edge_e4), requested_action_at(at, price_centi, kThresholds))
          << "context " << context << " at SoC " << edge_e4;
    }
  }
}

// Hand-made students, with kinks where rounding, ends and thresholds meet.
Action always_charge(const LatticeState&) { return Action::kCharge; }
Action always_rest(const LatticeState&) { return Action::kIdle; }
Action always_discharge(const LatticeState&) { return Action::kDischarge; }
Action turn_at_zero(const LatticeState& at) {
  return at.price_eur_per_mwh < 0 ? Action::kCharge : Action::kDischarge;
}
Action charge_below_ends(const LatticeState& at) {
  if (at.price_eur_per_mwh < kLatticePriceMaxEurPerMwh) return Action::kCharge;
  return Action::kIdle;
}
Action turn_at_half_full(const LatticeState& at) {
  return at.soc_index <= 100 ? Action::kCharge : Action::kIdle;
}
constexpr std::int16_t kSocIndices[] = {0, 99, 100, 101, 200};
constexpr Policy kByHand[] = {always_charge, always_rest,       always_discharge,
                              turn_at_zero,  charge_below_ends, turn_at_half_full};

TEST(Margins, AreThoseOfTheGuardWhateverItsThresholds) {
  for (const PriceThresholds thresholds :
       {PriceThresholds{}, PriceThresholds{-1, 1}, PriceThresholds{0, 1},
        PriceThresholds{-15'000, 15'000}, PriceThresholds{-100, 1'500},
        PriceThresholds{1'499, 1'501}}) {
    GuardSettings settings;
    settings.thresholds = thresholds;
    for (const Policy policy : kByHand) {
      for (const std::int16_t soc_index : kSocIndices) {
        const LatticeState state{.minute_of_quarter_hour = 3,
                                 .quarter_hour = 40,
                                 .context_class = 5,
                                 .soc_index = soc_index,
                                 .price_eur_per_mwh = 0};
        const Margins margins = find_margins(state, 0, thresholds, policy);
        for (std::int32_t price_centi :
             {margins.charge_up_to_centi, margins.charge_up_to_centi + 1,
              margins.discharge_from_centi - 1, margins.discharge_from_centi, -1'500'000, 1'500'000,
              -51, -50, -49, 0, 49, 50, 51, -50'050, 150'049}) {
          GuardInputs in = healthy(requested_action_at(state, price_centi, thresholds, policy));
          in.price_centi_eur_per_mwh = price_centi;
          LatticeState at = state;
          at.price_eur_per_mwh = lattice_price_of(price_centi);
          in.student_action = policy(at);
          const std::int32_t ordered_w = SafetyGuard(settings).decide(in).power_w;
          EXPECT_EQ(power_sign(said_of_price(margins, price_centi)) * settings.power_w, ordered_w)
              << "thresholds " << thresholds.low_eur_per_mwh << " " << thresholds.high_eur_per_mwh
              << " price " << price_centi << " SoC index " << soc_index;
        }
      }
    }
  }
}

TEST(Margins, SayWhichActionNeverComesAtThisPrice) {
  const LatticeState state{.minute_of_quarter_hour = 0,
                           .quarter_hour = 0,
                           .context_class = 1,
                           .soc_index = 50,
                           .price_eur_per_mwh = 20};
  const Margins half = find_margins(state, 2'000, kThresholds, turn_at_half_full);
  EXPECT_TRUE(half.charges_at_some_soc);
  EXPECT_FALSE(half.discharges_at_some_soc);
  EXPECT_EQ(half.charge_up_to_soc_e4, 5'024);
  const Margins beyond = find_margins(state, 150'000, kThresholds, turn_at_half_full);
  EXPECT_FALSE(beyond.charges_at_some_soc);
  EXPECT_TRUE(beyond.discharges_at_some_soc);
  EXPECT_EQ(beyond.discharge_from_soc_e4, 0);
}

}  // namespace
}  // namespace bess
