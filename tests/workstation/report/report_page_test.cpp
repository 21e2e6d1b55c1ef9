#include "workstation/report/report_page.h"

#include <gtest/gtest.h>

#include <stdexcept>

#include "workstation/report/page_files.h"
#include "workstation/report/report_tables.h"

namespace bess {
namespace {

TEST(ReportPage, PlaceholdersAreFilledOnce) {
  EXPECT_EQ(filled_in("a{{x}}b{{y}}{{x}}", {{"x", "1"}, {"y", "{{x}}"}}), "a1b{{x}}1");
  EXPECT_EQ(filled_in("nothing", {}), "nothing");
  EXPECT_THROW((void)filled_in("{{z}}", {}), std::logic_error);
}

TEST(ReportPage, DataCannotEndItsScript) {
  EXPECT_EQ(script_safe(R"({"a":"</script><b>"})"), R"({"a":"\u003c/script>\u003cb>"})");
}

TEST(ReportPage, FilesAreEmbeddedWhole) {
  EXPECT_TRUE(page_file("student.js").starts_with("// The edge's student"));
  EXPECT_TRUE(page_file("student.js").ends_with("}\n"));
  EXPECT_NE(page_file("chart.min.js").find("Chart.js v3.9"), std::string_view::npos);
  EXPECT_THROW((void)page_file("no.js"), std::logic_error);
}

TEST(ReportPage, NoScriptEndsEarly) {
  for (const char* name : {"chart.min.js", "student.js", "archive.js", "charts.js", "tear_sheet.js",
                           "day.js", "policy_map.js", "learning.js", "page.js"}) {
    EXPECT_EQ(page_file(name).find("</script"), std::string_view::npos) << name;
  }
}

TEST(ReportTables, AProofIsClaimedOfTheWholeLatticeOnly) {
  Certificate certificate;
  certificate.states_checked = kLatticeStateCount;
  EXPECT_EQ(proof_sentence(certificate), "Proved: no violation in 6,950,033,280 states");
  certificate.states_checked = 1000;
  EXPECT_EQ(proof_sentence(certificate), "Looked at in part: no violation in 1,000 states");
  certificate.violations_property_1 = 1;
  EXPECT_EQ(proof_sentence(certificate),
            "Not proved: it still breaks its constraints 1 times and may not be exported");
}

TEST(ReportTables, FactsAreEscaped) {
  const std::string html = provenance_html({{"command", "a <b> & c"}}, "x<y");
  EXPECT_NE(html.find("<dt>command</dt><dd>a &lt;b&gt; &amp; c</dd>"), std::string::npos);
  EXPECT_NE(html.find("<pre>x&lt;y</pre>"), std::string::npos);
}

}  // namespace
}  // namespace bess
