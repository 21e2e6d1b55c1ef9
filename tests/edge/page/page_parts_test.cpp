// What the page is made of, each by itself.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "edge/companion/orders.h"
#include "edge/control/policy.h"
#include "edge/page/access_tokens.h"
#include "edge/page/day_chart.h"
#include "edge/page/decision_map.h"
#include "edge/page/html_number.h"
#include "edge/page/page_html.h"
#include "edge/page/request_guard.h"
#include "edge/page/svg.h"
#include "shared/local_time.h"
#include "shared/scaled_clock.h"
#include "tests/edge/page/page_site.h"

namespace bess {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

TEST(AccessTokens, AreANameAndAToken) {
  AccessTokens tokens;
  std::string trouble;
  ASSERT_TRUE(
      tokens.parse("# who\n\nanna 0123456789abcdef\r\n  bob\t fedcba9876543210  \n", trouble));
  EXPECT_EQ(tokens.owner_of("0123456789abcdef"), "anna");
  EXPECT_EQ(tokens.owner_of("fedcba9876543210"), "bob");
  for (const char* const wrong :
       {"", "0123456789abcde", "0123456789abcdef0", "0123456789abcdeF", "anna"}) {
    EXPECT_EQ(tokens.owner_of(wrong), "") << wrong;
  }
}

TEST(AccessTokens, WhatIsNoneIsRefusedWithoutQuotingIt) {
  for (const char* const text : {"", "# nobody\n", "anna\n", "anna short\n",
                                 "anna 0123456789abcdef more\n", "anna 0123456789\tabcdef0\n",
                                 "anna 01234567\x7f"
                                 "89abcdef\n"}) {
    AccessTokens tokens;
    std::string trouble;
    EXPECT_FALSE(tokens.parse(text, trouble)) << text;
    EXPECT_THAT(trouble, Not(IsEmpty()));
    EXPECT_THAT(trouble, Not(HasSubstr("0123456789abcdef"))) << text;
    EXPECT_EQ(tokens.owner_of(""), "");
  }
}

TEST(PageOrders, AreCommandsOfBessEdge) {
  EXPECT_THAT(read_order({{"order", "hold"}, {"power_w", "-2000"}, {"minutes", "90"}}).words,
              ElementsAre("hold", "-2000", "--for", "90m"));
  EXPECT_THAT(read_order({{"order", "release"}}).words, ElementsAre("hold", "--release"));
  EXPECT_THAT(read_order({{"order", "limit"}, {"charge_w", "0"}, {"minutes", "15"}}).words,
              ElementsAre("limit", "--charge", "0", "--for", "15m"));
  EXPECT_THAT(
      read_order({{"order", "limit"}, {"charge_w", "1"}, {"discharge_w", "2"}, {"minutes", "1"}})
          .words,
      ElementsAre("limit", "--charge", "1", "--discharge", "2", "--for", "1m"));
  EXPECT_THAT(read_order({{"order", "unlimit"}}).words, ElementsAre("limit", "--clear"));
  EXPECT_THAT(read_order({{"order", "clear"}}).words, ElementsAre("clear", "--yes"));
}

TEST(PageOrders, WhatIsNoneIsRefused) {
  const OrderFields bad[] = {
      {},
      {{"order", "commission"}},
      {{"order", "hold"}},
      {{"order", "hold"}, {"power_w", "--yes"}, {"minutes", "5"}},
      {{"order", "hold"}, {"power_w", "5 "}, {"minutes", "5"}},
      {{"order", "hold"}, {"power_w", "5.5"}, {"minutes", "5"}},
      {{"order", "hold"}, {"power_w", "99999999999999999999"}, {"minutes", "5"}},
      {{"order", "hold"}, {"power_w", "5"}, {"minutes", "1"}},
      {{"order", "hold"}, {"power_w", "5"}, {"minutes", "10081"}},
      {{"order", "hold"}, {"power_w", "5"}, {"minutes", "5m; reboot"}},
      {{"order", "limit"}, {"minutes", "5"}},
      {{"order", "limit"}, {"charge_w", "-1"}, {"minutes", "5"}},
      {{"order", "limit"}, {"charge_w", "5"}},
  };
  for (const OrderFields& fields : bad) {
    const Order order = read_order(fields);
    EXPECT_THAT(order.words, IsEmpty());
    EXPECT_THAT(order.complaint, Not(IsEmpty()));
  }
}

TEST(RequestGuard, AnswersToItsOwnNamesAlone) {
  PageSettings settings;
  settings.hosts = {"battery.example.org"};
  for (const char* const ours : {"127.0.0.1", "127.0.0.1:8745", "localhost:8745", "LocalHost",
                                 "battery.example.org", "Battery.Example.ORG:443"}) {
    EXPECT_TRUE(is_our_host(ours, settings)) << ours;
    EXPECT_TRUE(is_our_origin(std::string("http://") + ours, settings)) << ours;
    EXPECT_TRUE(is_our_origin(std::string("https://") + ours, settings)) << ours;
  }
  for (const char* const others :
       {"", ":8745", "evil.example", "127.0.0.1.evil.example", "battery.example.org.evil.example",
        "192.168.1.9", "[::1", "xlocalhost", "evil.example:8745", "[::1]:8745"}) {
    EXPECT_FALSE(is_our_host(others, settings)) << others;
    EXPECT_FALSE(is_our_origin(std::string("http://") + others, settings)) << others;
  }
  EXPECT_TRUE(is_our_origin("", settings));  // no browser
  EXPECT_FALSE(is_our_origin("null", settings));
  EXPECT_FALSE(is_our_origin("file://localhost", settings));
  settings.host = "0.0.0.0";
  EXPECT_TRUE(is_our_host("192.168.1.9:8745", settings));
  EXPECT_TRUE(is_our_host("[fe80::1]:8745", settings));
  EXPECT_FALSE(is_our_host("evil.example", settings));
  EXPECT_FALSE(is_our_host("localhost", settings));
}

TEST(RequestGuard, FiveWrongTokensAMinute) {
  WrongTokens wrong;
  std::int64_t now_ns = 1'000'000'000;
  for (int i = 0; i < WrongTokens::kMax; ++i, ++now_ns) {
    EXPECT_FALSE(wrong.are_too_many(now_ns));
    wrong.count(now_ns);
  }
  EXPECT_TRUE(wrong.are_too_many(now_ns));
  now_ns += 60 * kNanosecondsPerSecond;
  EXPECT_FALSE(wrong.are_too_many(now_ns));
  wrong.count(now_ns);
  EXPECT_FALSE(wrong.are_too_many(now_ns));
}

TEST(Svg, TicksAreRoundFewAndInside) {
  std::mt19937_64 random(31);
  for (int i = 0; i < 10'000; ++i) {
    const double low = std::uniform_real_distribution<>(-5'000, 5'000)(random);
    const double high = low + std::exp(std::uniform_real_distribution<>(-4, 9)(random));
    const int count_max = std::uniform_int_distribution<>(5, 9)(random);
    const std::vector<double> ticks = round_ticks(low, high, count_max);
    ASSERT_GE(ticks.size(), 2U) << low << " to " << high;
    ASSERT_LE(ticks.size(), static_cast<std::size_t>(count_max)) << low << " to " << high;
    ASSERT_GE(ticks.front(), low);
    ASSERT_LE(ticks.back(), high + 1e-9 * std::abs(high));
  }
  EXPECT_THAT(round_ticks(-4, 4, 5), ElementsAre(-4, -2, 0, 2, 4));
  EXPECT_THAT(round_ticks(1, 1, 5), IsEmpty());
}

TEST(HtmlNumber, NamesItsSource) {
  const Json json = Json::parse(R"({"soc_e4": 4242, "loss": -0.4, "text": "<b>"})");
  EXPECT_EQ(html_number(json.value()["soc_e4"], "status/last/soc_e4", {1, 100, "%"}),
            "<span class=\"with-unit\"><data value=\"4242\" data-of=\"status/last/soc_e4\" "
            "data-divisor=\"100\">42.4</data>&#160;%</span>");
  EXPECT_THAT(html_number(json.value()["loss"], "x", {0, 1, "", true}), HasSubstr(">0</data>"));
  EXPECT_THAT(html_number(json.value()["loss"], "x", {1, 1, "", true}),
              HasSubstr(">\u22120.4</data>"));
  EXPECT_EQ(html_number(json.value()["text"], "x", {}), "\u2013");
  EXPECT_EQ(html_number(json.value()["nothing"], "x", {}), "\u2013");
}

TEST(DaySpan, IsTheLocalDay) {
  set_market_time_zone();
  const std::int64_t short_day = 1'679'785'200;  // 2023-03-26, 23 hours
  const std::int64_t long_day = 1'698'530'400;   // 2023-10-29, 25 hours
  for (const auto& [start, hours] :
       {std::pair(short_day, 23), std::pair(long_day, 25), std::pair(long_day + 25 * 3'600, 24)}) {
    for (const std::int64_t at :
         {start, start + 7'200, start + 10'800, start + hours * 3'600 - 1}) {
      EXPECT_EQ(day_span_at(at).start_utc_s, start) << at;
      EXPECT_EQ(day_span_at(at).end_utc_s, start + hours * 3'600) << at;
    }
  }
}

/// The map's integers are the student's: every price of drawn columns, in drawn contexts.
TEST(DecisionMap, IsTheStudentAtEveryPrice) {
  std::mt19937_64 random(7);
  const PriceThresholds thresholds;
  for (int i = 0; i < 12; ++i) {
    LatticeState at{};
    at.minute_of_quarter_hour = static_cast<std::int16_t>(random() % 15);
    at.quarter_hour = static_cast<std::int16_t>(random() % 96);
    at.context_class = static_cast<std::int16_t>(1 + random() % kContextClassCount);
    const DecisionMap map = make_decision_map(at, thresholds, decide_with_student);
    for (int j = 0; j < 8; ++j) {
      at.soc_index = static_cast<std::int16_t>(random() % kSocCount);
      const DecisionMap::Column& column = map.columns[static_cast<std::size_t>(at.soc_index)];
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

class PageSettingsTest : public ::testing::Test {
 protected:
  std::string error_of(const std::string& page) {
    const std::string tokens = folder_.write("tokens", "anna 0123456789abcdef\n");
    EXPECT_EQ(chmod(tokens.c_str(), 0600), 0);
    const std::string open = folder_.write("open", "anna 0123456789abcdef\n");
    EXPECT_EQ(chmod(open.c_str(), 0644), 0);
    PageSettings settings;
    std::string error;
    const bool is_loaded =
        load_page_settings(folder_.write("edge.toml", "[page]\n" + page), settings, error);
    EXPECT_EQ(is_loaded, error.empty());
    return error;
  }
  TemporaryFolder folder_;
};

TEST_F(PageSettingsTest, WhatIsWrongNamesFileLineAndMend) {
  EXPECT_EQ(error_of("token_file = \"tokens\"\nport = 80\nhosts = [\"a.example\"]\n"), "");
  EXPECT_EQ(error_of(""), "");
  const std::pair<const char*, const char*> bad[] = {
      {"host = \"localhost\"\n", "must be a numeric address"},
      {"port = 70000\n", "port"},
      {"prot = 80\n", "prot"},
      {"refresh_s = 0\n", "refresh_s"},
      {"token_file = \"open\"\n", "chmod o-rwx"},
      {"token_file = \"none\"\n", "cannot be opened"},
      {"host = \"0.0.0.0\"\ntoken_file = \"tokens\"\n", "behind a proxy with TLS"},
      {"hosts = [\"http://a.example\"]\n", "without scheme and port"},
      {"hosts = [5]\n", "without scheme and port"},
      {"name = \"a\"\n", "name is not a known key"},
  };
  for (const auto& [page, mend] : bad) {
    EXPECT_THAT(error_of(page), HasSubstr(mend)) << page;
    EXPECT_THAT(error_of(page), HasSubstr("edge.toml:")) << page;
  }
}

std::string page_of_status(const std::string& status) {
  ControllerView view;
  view.status.json = Json::parse(status);
  return page_html(view, PageSettings{});
}

TEST(WhatNext, IsSaidWithItsNumbersAndWhatStandsAboveIt) {
  const std::string page = page_of_status(
      R"({"next": {"local": "2026-11-23 14:34", "action": "charge", "power_w": 4000,
          "reason": "price_age", "ends": "until a <new> price",
          "reserve_changes": [{"utc": "2026-11-23T17:00:00Z", "soc_percent": 40.00}],
          "full_charge_in_days": 3}, "no_effect": ["ramp_w_max: too large & idle"]})");
  EXPECT_THAT(page, HasSubstr("At 2026-11-23 14:34 it would <strong>charge</strong>, <span"));
  EXPECT_THAT(page, HasSubstr("data-of=\"status/next/power_w\""));
  EXPECT_THAT(page, HasSubstr("<strong>price_age</strong> stands above it, until a &lt;new&gt;"));
  EXPECT_THAT(page, HasSubstr("data-of=\"status/next/reserve_changes/0/soc_percent\""));
  EXPECT_THAT(page, HasSubstr("data-of=\"status/next/full_charge_in_days\""));
  EXPECT_THAT(page, HasSubstr("<li>ramp_w_max: too large &amp; idle</li>"));
}

TEST(WhatNext, IsNothingWithoutAControllerOrAPrice) {
  const std::string page = page_of_status("{}");
  EXPECT_THAT(page, HasSubstr("No controller runs: nothing is decided next."));
  EXPECT_THAT(page, Not(HasSubstr("without effect")));
  EXPECT_THAT(page_of_status(R"({"next": {"local": "14:34", "action": null, "power_w": null}})"),
              HasSubstr("At 14:34 nothing is driven without a price and a measurement.</p>"));
}

}  // namespace
}  // namespace bess
