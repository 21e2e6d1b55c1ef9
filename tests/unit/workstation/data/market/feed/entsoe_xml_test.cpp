// ENTSO-E A85 documents.
#include "workstation/data/market/feed/market_files.h"

#include <gmock/gmock.h>

#include <cmath>
#include <regex>

#include "tests/support/market_test_support.h"
#include "tests/support/tokens.h"
#include "workstation/data/market/model/simulated_market.h"

namespace bess {
namespace {

std::string point(int position, const std::string& amount, const std::string& category) {
  return "<Point><position>" + std::to_string(position) + "</position><imbalance_Price.amount>" +
         amount + "</imbalance_Price.amount><imbalance_Price.category>" + category +
         "</imbalance_Price.category></Point>";
}

std::string document(const std::string& points, const std::string& curve = "A01",
                     const std::string& resolution = "PT15M") {
  return "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<Balancing_MarketDocument xmlns=\"urn:x\">\n"
         "<!-- <Point> --><mRID>1</mRID><TimeSeries><curveType>" +
         curve +
         "</curveType><Period><timeInterval><start>2023-01-01T00:00Z</start>"
         "<end>2023-01-01T01:00Z</end></timeInterval><resolution>" +
         resolution + "</resolution>" + points +
         "</Period></TimeSeries></Balancing_MarketDocument>\n";
}

std::vector<double> prices(const std::string& text) {
  std::vector<double> values;
  for (const QuarterHour& row : parse_market_text(text, "a85.xml").quarter_hours) {
    values.push_back(row.price_eur_per_mwh);
  }
  return values;
}

TEST(EntsoeXml, SinglePriceInBothCategories) {
  const std::string text =
      document(point(1, "-11.28", "A04") + point(1, "-11.28", "A05") + point(2, "5", "A04") +
               point(2, "5", "A05") + point(4, "7.5", "A04"));
  const MarketRows rows = parse_market_text(text, "a85.xml");
  ASSERT_EQ(rows.quarter_hours.size(), 3u);
  EXPECT_EQ(rows.quarter_hours[0].utc_s, 1'672'531'200);
  EXPECT_EQ(rows.quarter_hours[0].price_eur_per_mwh, -11.28);
  EXPECT_EQ(rows.quarter_hours[2].utc_s, 1'672'531'200 + 2700);  // position 3 is a gap
  EXPECT_TRUE(rows.dual_priced_quarter_hours.empty());
  EXPECT_THAT(rows.sources, testing::ElementsAre(MarketSource::kEntsoe));
}

TEST(EntsoeXml, CurveTypeA03RepeatsThePointBefore) {
  EXPECT_THAT(prices(document(point(1, "3", "A04") + point(3, "4", "A04"), "A03")),
              testing::ElementsAre(3, 3, 4, 4));
}

TEST(EntsoeXml, LongerIntervalsBecomeQuarterHours) {
  EXPECT_THAT(prices(document(point(1, "3", "A04") + point(2, "4", "A04"), "A01", "PT30M")),
              testing::ElementsAre(3, 3, 4, 4));
  EXPECT_THAT(prices(document(point(1, "9", "A04"), "A01", "PT60M")),
              testing::ElementsAre(9, 9, 9, 9));
}

TEST(EntsoeXml, TwoPricesAreNotOne) {
  const MarketRows rows =
      parse_market_text(document(point(1, "3", "A04") + point(1, "9", "A05")), "a85.xml");
  ASSERT_EQ(rows.quarter_hours.size(), 1u);
  EXPECT_TRUE(std::isnan(rows.quarter_hours[0].price_eur_per_mwh));
  EXPECT_EQ(rows.dual_priced_quarter_hours.size(), 1u);
}

/// An entity defined by the document, which is not expanded.
std::string replaced_entity() {
  std::string text = document(point(1, "&price;", "A04"));
  return text.insert(text.find("<Balancing"), "<!DOCTYPE x [<!ENTITY price \"3\">]>\n");
}

TEST(EntsoeXml, BadDocumentsAreOneClearLine) {
  const auto error_of = [](const std::string& text) {
    return user_error_of([&] { (void)parse_market_text(text, "f.xml"); });
  };
  const std::string good = document(point(1, "3", "A04"));
  const auto with = [&good](const std::string& what, const std::string& instead) {
    std::string text = good;
    return text.replace(text.find(what), what.size(), instead);
  };
  const auto without = [&good](const std::string& name) {
    const std::string closing = "</" + name + ">";
    std::string text = good;
    const std::size_t first = text.find("<" + name + ">");
    return text.erase(first, text.find(closing) + closing.size() - first);
  };
  const std::pair<std::string, const char*> cases[] = {
      {"<html><body>x</body></html>", "f.xml"},
      {"<Publication_MarketDocument/><a>", "f.xml A85 \"Publication_MarketDocument\""},
      {good.substr(0, good.size() - 40), "f.xml:3"},
      {document(point(1, "x", "A04")), "f.xml:3 \"x\""},
      {document(point(5, "3", "A04")), "f.xml:3 5 4"},
      {document(point(0, "3", "A04")), "f.xml:3 0 4"},
      {document(point(1, "3", "A04"), "A01", "P1Y"), "f.xml:3 \"P1Y\""},
      {document(""), "f.xml"},
      {without("timeInterval"), "f.xml:3 timeInterval"},
      {without("start"), "f.xml:3 start"},
      {without("end"), "f.xml:3 end"},
      {without("resolution"), "f.xml:3 resolution"},
      {without("position"), "f.xml:3 position"},
      {with("<end>2023", "<end>9999"), "f.xml:3 251698237200 s"},
      {with("<Period>", "<currency_Unit.name>BGN</currency_Unit.name><Period>"), "\"BGN\" EUR"},
      {with("<Period>", "<price_Measure_Unit.name>KWH</price_Measure_Unit.name><Period>"),
       "\"KWH\" MWH"},
      {replaced_entity(), "f.xml:4 \"&price;\""},
      {"<?xml version=\"1.0\"?><Acknowledgement_MarketDocument xmlns=\"x\"><Reason>"
       "<code>999</code><text>No matching\n data found</text></Reason>"
       "</Acknowledgement_MarketDocument>",
       "f.xml \"No matching data found\""}};
  for (const auto& [text, names] : cases) EXPECT_THAT(error_of(text), Names(names)) << text;
}

TEST(EntsoeXml, NamespacesMayHaveAPrefix) {
  const std::string text = document(point(1, "3", "A04") + point(2, "4", "A04"));
  EXPECT_THAT(prices(std::regex_replace(text, std::regex("<(/?)(?=[A-Za-z])"), "<$1ns0:")),
              testing::ElementsAre(3, 4));
}

TEST(EntsoeXml, MinutesAreDrawnWithoutAPublishedImbalance) {
  auto rows = parse_market_text(document(point(1, "50", "A04") + point(2, "90", "A04") +
                                         point(3, "-20", "A04") + point(4, "60", "A04")),
                                "a85.xml")
                  .quarter_hours;
  EXPECT_EQ(infer_missing_imbalances(rows), 4u);
  EXPECT_GT(rows[2].system_imbalance_mw, 0);  // cheapest of the day: long
  const MinuteSeries series = minutes_on_quarter_hours(rows, 1);
  for (std::size_t m = 14; m < 60; m += 15) EXPECT_EQ(series.indicative[m], series.settled[m]);
  for (const double price : series.indicative) EXPECT_TRUE(std::isfinite(price));
}

}  // namespace
}  // namespace bess
