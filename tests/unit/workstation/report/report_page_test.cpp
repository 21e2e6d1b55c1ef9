#include "workstation/report/figures/html.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <stdexcept>

#include "tests/support/rule_sets.h"
#include "tests/support/tokens.h"
#include "workstation/report/page_data.h"
#include "workstation/report/report_tables.h"

namespace bess {
namespace {

using testing::HasSubstr;

TEST(ReportPage, PlaceholdersAreFilledOnce) {
  EXPECT_EQ(filled_in("a{{x}}b{{y}}{{x}}", {{"x", "1"}, {"y", "{{x}}"}}), "a1b{{x}}1");
  EXPECT_EQ(filled_in("nothing", {}), "nothing");
  EXPECT_THROW((void)filled_in("{{z}}", {}), std::logic_error);
}

TEST(ReportPage, DataCannotEndItsScript) {
  EXPECT_EQ(script_safe(R"({"a":"</script><b>"})"), R"({"a":"\u003c/script>\u003cb>"})");
}

TEST(ReportTables, AProofIsClaimedOfTheWholeLatticeOnly) {
  Certificate certificate;
  certificate.states_checked = kLatticeStateCount;
  EXPECT_THAT(proof_sentence(certificate), Names("6,950,033,280"));
  certificate.states_checked = 1000;
  EXPECT_THAT(proof_sentence(certificate), Names("1,000"));
  certificate.set_violations_of(1, 1);
  EXPECT_THAT(proof_sentence(certificate), testing::Not(Names("1,000")));
}

/// Two rules, one of them only in the guard.
Certificate ruled_certificate(std::int64_t violations) {
  Certificate certificate;
  certificate.states_checked = kLatticeStateCount;
  certificate.rules = one_rule("price_min = 0\nprice_max = 9\nis = \"idle\"", "rest");
  certificate.rules.rules.push_back(one_rule("power_max = 0.5\nenforce = true", "cap").rules[0]);
  certificate.counts = {{}, {}, {}, {}, {true, 1234, violations}, {}};
  return certificate;
}

TEST(ReportTables, AProofIncludesTheRules) {
  EXPECT_THAT(proof_sentence(ruled_certificate(0)), Names("1 6,950,033,280"));
  EXPECT_THAT(proof_sentence(ruled_certificate(7)), Names("7 \"rest\""));
}

TEST(ReportTables, RulesAreShownWithTheirScopeAndViolations) {
  const Certificate plain = ruled_certificate(1000);
  const Certificate corrected = ruled_certificate(0);
  RulePrices prices{};
  prices.rules.push_back({"", "rest", {PairedDifference{-109.5, {2}}, PairedDifference{-80, {3}}}});
  const std::string html = rules_html(plain, corrected, ContextKind::kLevel, &prices);
  for (const char* said : {"rest \u2013 ", ">81.04</td>", ">1,234</td>", ">0</td>", ">student</td>",
                           ">guard</td>", ">rest, alone</th>", "\u2212109.5 \u00b1 2.0"}) {
    EXPECT_THAT(html, HasSubstr(said));
  }
  const Certificate without;
  EXPECT_EQ(rules_html(without, without, ContextKind::kLevel, nullptr), "");
}

TEST(ReportTables, AFailedProofNamesDemandStateAndRemedy) {
  const BrokenDemand broken{{"rest", "always: the action is idle", true, true, 10, 1'234},
                            "charge at class 3 <",
                            "leave more room"};
  const std::string html = failure_html({broken});
  for (const char* said :
       {"&quot;rest&quot;", "1,234", "charge at class 3 &lt;", "leave more room"}) {
    EXPECT_THAT(html, HasSubstr(said));
  }
  EXPECT_EQ(failure_html({}), "");
}

NamedEvaluation earning(const std::string& name, double eur) {
  Evaluation evaluation;
  evaluation.capacity_mwh = 8;
  evaluation.days = {{"2023-01-26", eur, 0, 0, 0}, {"2023-01-27", -eur / 2, 0, 0, 0}};
  return {name, evaluation, evaluation};
}

TEST(ComparisonNotes, TheWholeBatteryIsCapacityTimesWhatAMwhEarns) {
  const std::vector<NamedEvaluation> evaluations{earning("rbc", -80),
                                                 earning("corrected student", 4000)};
  EXPECT_THAT(whole_battery_text(evaluations), Names("8 MWh 1000.0 EUR power_w capacity_wh"));
  std::vector<NamedEvaluation> house{earning("corrected student", 4)};
  house[0].day_reset.capacity_mwh = house[0].carried_over.capacity_mwh = 0.008;
  EXPECT_THAT(whole_battery_text(house), Names("8 kWh 1.00 EUR"));
  const std::string html = whole_battery_html(evaluations);
  EXPECT_THAT(html, HasSubstr(">1000.0</td>"));
  EXPECT_NE(html.find(">\u221220.0</td>"), std::string::npos) << "a true minus";
  EXPECT_EQ(whole_battery_text({earning("rbc", 1)}), "");
  EXPECT_EQ(whole_battery_html({}), "");
}

TEST(ComparisonNotes, AProgramAndItsTeacherAreExplainedWhereTheyAreTheSame) {
  EXPECT_THAT(same_program_text({earning("sdp", 5), earning("sdp teacher", 5)}), Names("sdp"));
  EXPECT_EQ(same_program_text({earning("sdp", 5), earning("sdp teacher", 5.0000001)}), "");
  EXPECT_THAT(same_program_text({earning("sdp", 5), earning("c51 teacher", 5)}), Names("sdp c51"));
  EXPECT_EQ(same_program_text({earning("sdp", 5), earning("c51 teacher", 6)}), "");
  EXPECT_EQ(same_program_text({earning("sdp", 5), earning("plain student", 5)}), "");
}

TEST(StepArchive, Base64IsThatOfTheStandard) {
  // RFC 4648, section 10.
  EXPECT_EQ(base64(""), "");
  EXPECT_EQ(base64("f"), "Zg==");
  EXPECT_EQ(base64("fo"), "Zm8=");
  EXPECT_EQ(base64("foo"), "Zm9v");
  EXPECT_EQ(base64("foobar"), "Zm9vYmFy");
  EXPECT_EQ(base64("\xff\xfe\x00"), "//4=");  // the literal ends at its zero
}

TEST(StepArchive, FewDaysAreAllKept) {
  EXPECT_EQ(days_with_steps({3, 1, 2}, 5), (std::vector<std::size_t>{0, 1, 2}));
  EXPECT_TRUE(days_with_steps({}, 5).empty());
}

TEST(StepArchive, OfManyTheWorstAndTheNewestAreKept) {
  std::vector<double> profits(400, 100.0);
  profits[7] = -50;
  profits[3] = -60;
  const std::vector<std::size_t> kept = days_with_steps(profits, 100);
  ASSERT_EQ(kept.size(), 100u);
  EXPECT_TRUE(std::ranges::is_sorted(kept));
  EXPECT_NE(std::ranges::find(kept, 7u), kept.end());
  EXPECT_NE(std::ranges::find(kept, 3u), kept.end());
  EXPECT_EQ(kept.back(), 399u);
  EXPECT_EQ(kept[kWorstDaysKept], 400u - (100 - kWorstDaysKept));  // the newest from here on
}

}  // namespace
}  // namespace bess
