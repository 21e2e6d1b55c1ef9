// Reserve and full charge in the operator's configuration, and every mistake in them.
#include "edge/app/settings/edge_config.h"

#include <gmock/gmock.h>

#include "edge/app/program/startup.h"
#include "shared/local_time.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/tokens.h"

namespace bess {
namespace {

constexpr const char* kMapLine = "map = \"" BESS_SOURCE_DIR "/edge/device/maps/alphaess.toml\"\n";

struct Pieces {
  std::string battery = "", guard = "", rest = "";
};

bool load_pieces(const Pieces& pieces, EdgeConfig& config, std::string& error) {
  const TemporaryFolder folder;
  const std::string text = std::string("[battery]\n") + kMapLine + pieces.battery +
                           "[price]\nurl = \"http://127.0.0.1:1/records\"\n[guard]\n" +
                           pieces.guard + pieces.rest;
  return load_edge_config(folder.write("edge.toml", text), config, error);
}

TEST(OperatorConfig, WithoutKeysNothingIsRequested) {
  EdgeConfig config;
  std::string error;
  ASSERT_TRUE(load_pieces({}, config, error)) << error;
  EXPECT_TRUE(config.control.reserve.empty());
  EXPECT_EQ(config.control.full_charge_every_days, 0);
}

TEST(OperatorConfig, ReadsTheRequestsOfTheOperator) {
  EdgeConfig config;
  std::string error;
  ASSERT_TRUE(load_pieces({.battery = "full_charge_every_days = 14\n",
                           .rest = "[[reserve]]\nfrom = \"17:00\"\nto = \"24:00\"\nsoc = 0.3\n"
                                   "[[reserve]]\nfrom = \"22:30\"\nto = \"06:00\"\nsoc = 0.155\n"
                                   "months = [1, 12]\n"},
                          config, error))
      << error;
  EXPECT_EQ(config.control.full_charge_every_days, 14);
  ASSERT_EQ(config.control.reserve.size(), 2);
  EXPECT_EQ(config.control.reserve[0].from_minute, 1'020);
  EXPECT_EQ(config.control.reserve[0].to_minute, 1'440);
  EXPECT_EQ(config.control.reserve[0].soc_e4, 3'000);
  EXPECT_EQ(config.control.reserve[0].months, ReservePeriod::kEveryMonth);
  EXPECT_EQ(config.control.reserve[1].from_minute, 1'350);
  EXPECT_EQ(config.control.reserve[1].to_minute, 360);
  EXPECT_EQ(config.control.reserve[1].soc_e4, 1'550);
  EXPECT_EQ(config.control.reserve[1].months, 0x801);
}

/// bess-notify reads its own section: a mistake in it must not stop the controller.
TEST(OperatorConfig, TheNotifiersSectionIsNotTheControllersBusiness) {
  EdgeConfig config;
  std::string error;
  EXPECT_TRUE(load_pieces({.rest = "[notify]\nno_such_key = 1\n"}, config, error)) << error;
  EXPECT_TRUE(load_pieces({.rest = "[settled]\nno_such_key = 1\n"}, config, error)) << error;
}

TEST(OperatorConfig, EveryMistakeIsOneClearLine) {
  const auto reserve = [](const std::string& keys) {
    return Pieces{.rest = "[[reserve]]\n" + keys};
  };
  const std::string from_to = "from = \"17:00\"\nto = \"20:00\"\n";
  std::string many;
  for (int i = 0; i < 25; ++i) many += "[[reserve]]\n" + from_to + "soc = 0.3\n";
  const std::pair<Pieces, const char*> mistakes[] = {
      {{.battery = "full_charge_every_days = 366\n"}, "full_charge_every_days 0 365"},
      {{.battery = "full_charge_every_days = 7\n", .guard = "soc_max = 0.9\n"},
       "full_charge_every_days [guard] soc_max 0.995"},
      {{.rest = "[reserve]\nsoc = 0.3\n"}, "reserve"},
      {{.rest = "[x]\n"}, "x"},
      {reserve("soc = 0.3\n"), "from"},
      {reserve("from = \"17:00\"\nsoc = 0.3\n"), "to"},
      {reserve(from_to), "soc"},
      {reserve(from_to + "soc = 1.0\n"), "soc [guard] soc_max"},
      {reserve(from_to + "soc = 30\n"), "soc 0 1"},
      {reserve(from_to + "soc = 0.3\nhours = 1\n"), "hours"},
      {reserve(from_to + "soc = 0.3\nmonths = [13]\n"), "months 1 12"},
      {reserve(from_to + "soc = 0.3\nmonths = []\n"), "months"},
      {reserve("from = \"17:00\"\nto = \"17:00\"\nsoc = 0.3\n"), "to from"},
      {reserve("from = \"24:01\"\nto = \"20:00\"\nsoc = 0.3\n"), "from"},
      {reserve("from = \"7:00\"\nto = \"20:00\"\nsoc = 0.3\n"), "from"},
      {reserve("from = \"17.00\"\nto = \"20:00\"\nsoc = 0.3\n"), "from"},
      {{.rest = many}, "reserve 24"},
  };
  for (const auto& [pieces, message] : mistakes) {
    EdgeConfig config;
    std::string error;
    EXPECT_FALSE(load_pieces(pieces, config, error)) << message;
    EXPECT_THAT(error, Names(message));
    EXPECT_EQ(error.find('\n'), std::string::npos) << error;
  }
}

TEST(OperatorNote, ListsTheRequestsAndNothingElse) {
  set_market_time_zone();
  constexpr std::int64_t kNow = 1'679'875'320;  // 02:02 in Brussels
  ControlSettings control;
  EXPECT_EQ(operator_note(control, {}, kNow), "");
  EXPECT_EQ(operator_note(control, {.power_w = -5, .until_utc_s = kNow}, kNow), "");  // over
  control.reserve.push_back({.from_minute = 0, .to_minute = 180, .soc_e4 = 1'550});
  control.full_charge_every_days = 7;
  EXPECT_THAT(operator_note(control, {.power_w = -500, .until_utc_s = kNow + 60}, kNow),
              Names("-500 W 2023-03-27T00:03:00Z 15.5 % 7 2000"));
  EXPECT_THAT(operator_note({}, {.unreadable = true}, kNow), Names("hold"));
}

}  // namespace
}  // namespace bess
