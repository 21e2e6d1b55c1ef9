#include "workstation/report/report.h"

#include <fmt/core.h>
#include <gmock/gmock.h>

#include "shared/host/csv.h"
#include "shared/host/file.h"
#include "shared/host/user_error.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/tokens.h"
#include "tests/unit/workstation/report/report_test_support.h"
#include "workstation/report/headline.h"

namespace bess {
namespace {

namespace fs = std::filesystem;

/// Teacher and student of a run.
struct FinishedRun {
  Teacher teacher = untrained_teacher();
  StudentFile student{untrained_student(), failed_certificate(), "seed 1 <untrained> & small"};

  static Certificate failed_certificate() {
    Certificate certificate;
    certificate.states_checked = 6'950'033'280;
    certificate.set_violations_of(3, 42);
    certificate.counterexamples = {{3, 20, 2, 100, 50}};
    return certificate;
  }

  [[nodiscard]] RunResults inputs() const {
    RuleBasedPolicy rule(kPaperRuleLowEurPerMwh, kPaperRuleHighEurPerMwh);
    TeacherPolicy taught(teacher);
    RunResults in{
        .market = small_market(), .teacher = teacher, .plain = student, .corrected = student};
    in.evaluations = {named_evaluation("rule-based", rule), named_evaluation("teacher", taught)};
    in.training_curve = {{0, 0, 100, 0}, {500, 3.0, 140, 0, 5}, {750, 2.9, 160, 0, -5}};
    in.distil_curve = {{1, 1.0, 0.1, 0.9}, {2, 0.5, 0.01, 0.4}, {3, 0.3, 0, 0.2}};
    return in;
  }
};

std::string html_of(const RunResults& inputs, const fs::path& folder) {
  write_report(inputs, folder);
  return read_file(folder / "report.html");
}

/// The page without its scripts and their data.
std::string markup_of(std::string html) {
  for (auto at = html.find("<script"); at != std::string::npos; at = html.find("<script", at)) {
    html.erase(at, html.find("</script>", at) + 9 - at);
  }
  return html;
}

TEST(Report, TheNumbersOfItsPicturesAreNextToThePage) {
  const TemporaryFolder folder;
  const FinishedRun run;
  for (const std::string& name : write_report(run.inputs(), folder.file("run"))) {
    EXPECT_TRUE(fs::exists(folder.file("run/" + name))) << name;
  }
  for (const char* name : {"policy_map", "prices_seen"}) {
    EXPECT_GT(CsvTable::read(folder.file(fmt::format("run/{}.csv", name))).row_count(), 0U) << name;
  }
}

/// Contents of a picture's file: a map's stretches contain the states of its grid, each once.
TEST(Report, TheNumbersOfAMapAreItsStates) {
  const TemporaryFolder folder;
  const FinishedRun run;
  write_report(run.inputs(), folder.file("run"));
  const CsvTable table = CsvTable::read(folder.file("run/policy_map.csv"));
  const auto number = [&](std::size_t row, const char* column) {
    return static_cast<std::int16_t>(table.number(row, table.column(column)));
  };
  LatticeState state{number(0, "minute"), number(0, "quarter_hour"), number(0, "context_class"), 0,
                     0};
  std::string drawn;
  for (std::size_t row = 0; row < table.row_count(); ++row) {
    if (table.text(row, table.column("student")) != table.text(0, table.column("student"))) break;
    const std::string action(table.text(row, table.column("action")));
    const int prices =
        number(row, "price_to_eur_per_mwh") - number(row, "price_from_eur_per_mwh") + 1;
    drawn.append(static_cast<std::size_t>(prices), action.front());
  }
  std::string expected;
  for (std::int16_t soc = 0; soc < kSocCount; ++soc) {
    for (int price = kLatticePriceMinEurPerMwh; price <= kLatticePriceMaxEurPerMwh; ++price) {
      state.soc_index = soc;
      state.price_eur_per_mwh = static_cast<std::int16_t>(price);
      expected += action_name(run.student.net.decide(state)).front();
    }
  }
  EXPECT_EQ(drawn, expected);
}

TEST(Report, ThePageHoldsAllAndFetchesNothing) {
  const TemporaryFolder folder;
  const FinishedRun run;
  const std::string html = html_of(run.inputs(), folder.file("run"));
  const std::string markup = markup_of(html);
  EXPECT_EQ(first_unbalanced_tag(markup), "");
  for (const char* outside : {"src=", "url(", "http:", "https:", "@import", "<link"}) {
    EXPECT_EQ(count_of(markup, outside), 0U) << outside;
  }
  EXPECT_EQ(count_of(html, "Content-Security-Policy"), 1U);
  EXPECT_EQ(count_of(markup, "{{"), 0U);
  EXPECT_THAT(markup, testing::HasSubstr("seed 1 &lt;untrained&gt; &amp; small"));
  EXPECT_EQ(count_of(html, "\"marks\":[]"), 1U) << "no price regime begins in these days";
  EXPECT_LT(html.size(), 5'000'000u);
}

/// In a run with a failed proof nothing is called corrected, and each violated demand links to its
/// state on the map.
TEST(Report, APageOfAFailedProofIsAboutTheUnprovedStudent) {
  const TemporaryFolder folder;
  const FinishedRun run;
  RunResults in = run.inputs();
  RuleBasedPolicy policy(kPaperRuleLowEurPerMwh, kPaperRuleHighEurPerMwh);
  in.evaluations.push_back(named_evaluation(kPlainName, policy));
  in.evaluations.push_back(named_evaluation(kUnprovedName, policy));
  in.broken = {
      {{"property 3", "monotone", false, true, 9, 42}, "charge at dawn", "more effort"},
      {{"rest", "idle", true, true, 9, 7}, "sells", "more room", LatticeState{1, 2, 3, 4, 5}}};
  const std::string html = html_of(in, folder.file("run"));
  const std::string markup = markup_of(html);
  EXPECT_EQ(first_unbalanced_tag(markup), "");
  for (const char* untrue : {"orrected student", "effect-of-correction"}) {
    EXPECT_EQ(count_of(markup, untrue), 0U) << untrue;
  }
  for (const char* said : {"href=\"#failure\"", "unproved student</th>", "data-broken=\"1\""}) {
    EXPECT_GT(count_of(markup, said), 0U) << said;
  }
  EXPECT_EQ(count_of(markup, "data-broken=\"0\""), 0U) << "no state of it is known";
  EXPECT_THAT(html, testing::HasSubstr("\"broken\":[null,[1,2,3,4,5]]"));
  EXPECT_THAT(html, testing::HasSubstr("\"exported\":\"unproved student\""));
  EXPECT_THAT(html, testing::HasSubstr("\"counterexamples_of\":\"unproved student\""));
  in.broken.clear();
  in.corrected.certificate.set_violations_of(3, 0);
  in.corrected.certificate.counterexamples.clear();
  EXPECT_EQ(count_of(html_of(in, folder.file("proved")), "href=\"#failure\""), 0U);
}

TEST(Report, NoTestDaysAreRefused) {
  const TemporaryFolder folder;
  MarketSteps market = small_market();
  std::erase_if(market.days, [](const MarketDay& day) { return day.split == Split::kTest; });
  const FinishedRun run;
  EXPECT_THROW(write_report({.market = market,
                             .teacher = run.teacher,
                             .plain = run.student,
                             .corrected = run.student},
                            folder.file("run")),
               UserError);
}

TEST(Report, TitleAndHeadingNameRunPricesBatteryAndDate) {
  const TemporaryFolder folder;
  const FinishedRun run;
  RunResults in = run.inputs();
  in.facts = {{"date", "2026-11-23T12:00Z"}, {"run", "<first>"}, {"prices", "a.csv: crc32 1"}};
  const std::string html = html_of(in, folder.file("run"));
  EXPECT_EQ(count_of(html, ">&lt;first&gt;, a.csv, 4 MW, 8 MWh, 2026-11-23</"), 2U);
  EXPECT_THAT(html, testing::HasSubstr("\"training\":[[0,100,0,0],[500,140,1,3],[750,160,0,2.9]]"));
}

}  // namespace
}  // namespace bess
