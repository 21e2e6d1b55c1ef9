// Parts of the page.
#include <gmock/gmock.h>

#include <random>

#include "edge/companions/page/controller_answers.h"
#include "edge/companions/page/page_server.h"
#include "edge/companions/page/page_settings.h"
#include "edge/core/control/policy.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/tokens.h"

namespace bess {
namespace {

TEST(RequestGuard, AnswersToItsOwnNamesAlone) {
  PageSettings settings;
  settings.hosts = {"battery.example.org"};
  for (const char* const ours : {"127.0.0.1", "127.0.0.1:8745", "localhost:8745", "LocalHost",
                                 "battery.example.org", "Battery.Example.ORG:443"}) {
    EXPECT_TRUE(is_our_host(ours, settings)) << ours;
  }
  for (const char* const others :
       {"", ":8745", "evil.example", "127.0.0.1.evil.example", "battery.example.org.evil.example",
        "192.168.1.9", "[::1", "xlocalhost", "evil.example:8745", "[::1]:8745"}) {
    EXPECT_FALSE(is_our_host(others, settings)) << others;
  }
  settings.host = "0.0.0.0";
  EXPECT_TRUE(is_our_host("192.168.1.9:8745", settings));
  EXPECT_TRUE(is_our_host("[fe80::1]:8745", settings));
  EXPECT_FALSE(is_our_host("evil.example", settings));
  EXPECT_FALSE(is_our_host("localhost", settings));
}

/// Integers of the map equal the student's: every price of drawn columns, in drawn contexts.
TEST(DecisionMap, IsTheStudentAtEveryPrice) {
  std::mt19937_64 random(7);
  const PriceThresholds thresholds;
  for (int i = 0; i < 12; ++i) {
    LatticeState at{};
    at.minute_of_quarter_hour = static_cast<std::int16_t>(random() % 15);
    at.quarter_hour = static_cast<std::int16_t>(random() % 96);
    at.context_class = static_cast<std::int16_t>(1 + random() % kContextClassCount);
    const DecisionMap map = make_decision_map(at, thresholds);
    for (int j = 0; j < 8; ++j) {
      at.soc_index = static_cast<std::int16_t>(random() % kSocCount);
      const Margins& column = map[static_cast<std::size_t>(at.soc_index)];
      for (int price = kLatticePriceMinEurPerMwh + 1; price < kLatticePriceMaxEurPerMwh; ++price) {
        at.price_eur_per_mwh = static_cast<std::int16_t>(price);
        const std::int32_t centi = price * kCentiPerEur;
        const Action shown = centi <= column.charge_up_to_centi     ? Action::kCharge
                             : centi >= column.discharge_from_centi ? Action::kDischarge
                                                                    : Action::kIdle;
        ASSERT_EQ(shown, decide_with_student(at)) << price << " at SoC " << at.soc_index / 2.0;
      }
    }
  }
}

TEST(DecisionMap, IsNoneWhereTheStudentWasNotAskedOrIsAnother) {
  const auto columns_of = [](const std::string& why) {
    return decision_map_of(Json::parse(why).value()).value()["columns"].size();
  };
  const std::string decided =
      R"({"utc": "2023-03-26T10:00:00Z", "context_class": 6, "margins": {})";
  EXPECT_EQ(columns_of(decided + R"(, "is_other_student": false})"),
            static_cast<std::size_t>(kSocCount));
  EXPECT_EQ(columns_of(decided + R"(, "is_other_student": true})"), 0U);
  EXPECT_EQ(columns_of(R"({"utc": "2023-03-26T10:00:00Z", "context_class": 99, "margins": {},
                          "is_other_student": false})"),
            0U);
  EXPECT_EQ(columns_of(R"({"margins": null})"), 0U);
  EXPECT_EQ(columns_of("{}"), 0U);
}

class PageSettingsTest : public ::testing::Test {
 protected:
  std::string error_of(const std::string& page) {
    settings_ = {};
    std::string error;
    const bool is_loaded =
        load_page_settings(folder_.write("edge.toml", "[page]\n" + page), settings_, error);
    EXPECT_EQ(is_loaded, error.empty());
    return error;
  }
  TemporaryFolder folder_;
  PageSettings settings_;
};

TEST_F(PageSettingsTest, AMistakeNamesFileLineAndCorrection) {
  EXPECT_EQ(error_of("port = 80\nhosts = [\"a.example\"]\n"), "");
  EXPECT_EQ(error_of(""), "");
  const std::pair<const char*, const char*> bad[] = {
      {"host = \"localhost\"\n", "host"},
      {"port = 70000\n", "port"},
      {"prot = 80\n", "prot"},
      {"hosts = [\"http://a.example\"]\n", "hosts"},
      {"hosts = [5]\n", "hosts"},
  };
  for (const auto& [page, key] : bad) {
    EXPECT_THAT(error_of(page), Names(std::string("edge.toml:2 ") + key)) << page;
  }
}

TEST_F(PageSettingsTest, KeysOfEarlierVersionsHaveNoEffect) {
  EXPECT_EQ(error_of("name = \"a\"\nrefresh_s = 0\nprogram = 1\ntoken_file = \"not there\"\n"), "");
}

}  // namespace
}  // namespace bess
