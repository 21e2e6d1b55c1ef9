// Real bess-prices and bess-edge against price servers of user reports (price_source.py,
// independent of bess). The right action of each minute is known: no order may contradict a price
// that is fresh enough, and where a usual client gets its rows every control cycle must be traded.
#include <gmock/gmock.h>

#include <cstdio>
#include <map>

#include "tests/support/journal_fields.h"
#include "tests/support/peer_programs.h"
#include "tests/support/simulated_site.h"

namespace bess {
namespace {

constexpr std::int32_t kScale = 60;  // a control cycle takes 2 s
constexpr int kCycles = 16;
constexpr std::int64_t kHalfMin = 10;  ///< minutes of the wave's low and high price

enum class Wanted {
  kAll,    ///< every control cycle is traded, except the first and one more
  kSome,   ///< at least half of them
  kNone,   ///< none: no price is available, or none that may be traded on
  kRight,  ///< any number, but never against the price
};

struct Behaviour {
  const char* name;
  const char* json;
  Wanted wanted;
  const char* keys = "";    ///< of [price]
  const char* status = "";  ///< price state of the last control cycle, where it is known
  const char* host = "http://127.0.0.1";
  const char* prices = "wave";
  friend void PrintTo(const Behaviour& b, std::ostream* out) { *out << b.name; }
};

using enum Wanted;
constexpr const char* kTwoAddresses = "http://two-addresses.test";
constexpr const char* kHttp = "allow_http = true\n";

constexpr Behaviour kBehaviours[] = {
    {"ipv6_hangs", R"({"first_address": "hang"})", kAll, kHttp, "", kTwoAddresses},
    {"ipv6_resets", R"({"first_address": "reset"})", kAll, kHttp, "", kTwoAddresses},
    {"ipv6_is_another_server", R"({"first_address": "html"})", kAll, kHttp, "", kTwoAddresses},
    {"unit_kwh", R"({"factor": 0.001})", kNone, "", "doubtful_unit", "http://127.0.0.1", "walk"},
    {"unit_ct_per_kwh", R"({"factor": 0.1})", kRight, "", "", "http://127.0.0.1", "walk"},
    {"unit_kwh_and_said_so", R"({"factor": 0.001})", kAll, "unit = \"EUR/kWh\"\n"},
    {"limit_429_and_ban",
     R"({"limit": {"per_s": 60, "status": 429, "retry_after": 60, "ban_after": 20, "ban_s": 600}})",
     kAll},
    {"limit_503_without_a_time", R"({"limit": {"per_s": 90, "status": 503}})", kAll},
    {"limit_429_rows_late",
     R"({"late_s": 12, "limit": {"per_s": 60, "status": 429, "retry_after": 60, "ban_after": 20,
         "ban_s": 600}})",
     kSome},
    {"gzip", R"({"encoding": "gzip"})", kAll},
    {"deflate", R"({"encoding": "deflate"})", kAll},
    {"gzip_that_breaks_off", R"({"encoding": "gzip_cut"})", kNone},
    {"half_a_body", R"({"cut": 0.5})", kNone},
    {"half_of_each_second_body", R"({"cut": 0.5, "every": 2})", kAll},
    {"chunks_that_break_off", R"({"cut": 0.7, "chunked": true, "every": 2})", kAll},
    {"null_in_each_second_row", R"({"spoil": "null", "every": 2})", kAll},
    {"nan_in_each_third_row", R"({"spoil": "NaN", "every": 3})", kAll},
    {"text_in_each_second_row", R"({"spoil": "text", "every": 2})", kAll},
    {"no_price_in_each_third_row", R"({"spoil": "missing", "every": 3})", kAll},
    {"twice_in_each_third_row", R"({"spoil": "twice", "every": 3})", kAll},
    {"sentinel_999", R"({"spoil": -999, "every": 2})", kAll, "no_price = [-999.0]\n"},
    {"sentinel_0", R"({"spoil": 0, "every": 3})", kAll, "no_price = [0.0]\n"},
    {"beyond_any_market", R"({"spoil": 1e9, "every": 2})", kAll},
    {"late_12_s", R"({"late_s": 12})", kAll},
    {"late_50_s", R"({"late_s": 50})", kAll},
    {"late_170_s", R"({"late_s": 170})", kAll},
    {"late_10_min", R"({"late_s": 600})", kNone},
    {"ascending", R"({"order": "ascending"})", kAll},
    {"shuffled", R"({"order": "shuffled"})", kAll},
    {"doubled", R"({"order": "doubled"})", kAll},
    {"each_second_answer_is_old", R"({"stale": 600, "every": 2})", kAll},
    {"a_cache_that_is_frozen", R"({"frozen_s": 300})", kRight},
    {"stamped_an_hour_late", R"({"shift_s": 3600})", kRight},
    {"stamped_an_hour_early", R"({"shift_s": -3600})", kNone},
    {"stamped_half_a_minute_late", R"({"shift_s": 30})", kNone},
    {"moved", R"({"redirect": "path"})", kAll},
    {"moved_to_another_host", R"({"redirect": "host"})", kRight},
    {"moved_in_a_circle", R"({"redirect": "loop"})", kNone},
    {"a_login_page", R"({"instead": "html"})", kNone},
    {"a_login_page_each_second_time", R"({"instead": "html", "every": 2})", kAll},
    {"nothing_with_200", R"({"instead": "empty"})", kNone},
    {"204", R"({"instead": 204})", kNone},
    {"404_each_second_time", R"({"instead": 404, "every": 2})", kAll},
    {"500_each_third_time", R"({"instead": 500, "every": 3})", kAll},
    {"drips", R"({"drip_s": 0.1})", kAll},
    {"drips_for_ever", R"({"drip_s": 30})", kNone},
    {"thinks_first", R"({"wait_s": 0.15})", kAll},
    {"resets_each_second_connection", R"({"drop": "reset", "every": 2})", kAll},
    {"closes_each_third_connection", R"({"drop": "close", "every": 3})", kAll},
    {"large", R"({"pad": 20000})", kAll},
};

/// + charge at the low price, - discharge at the high one, of a minute.
int right_sign(std::int64_t minute) { return minute / kHalfMin % 2 == 0 ? 1 : -1; }

/// An order may follow any price within the age limit of [guard].
bool may_be_right(const JournalCycle& cycle) {
  const int sign = cycle.ordered_w > 0 ? 1 : -1;
  for (std::int64_t age_s = 60; age_s <= 300; age_s += 60) {
    if (right_sign((cycle.utc_s - age_s) / 60) == sign) return true;
  }
  return false;
}

class PriceSources : public PeerTest, public ::testing::WithParamInterface<Behaviour> {
 protected:
  PriceSources() : PeerTest("json") {}
  void start() {
    const Behaviour& behaviour = GetParam();
    site_.start_battery(
        {"--map", BESS_SOURCE_DIR "/edge/device/maps/alphaess.toml", "--soc", "0.5"});
    source_ = std::make_unique<ChildProcess>(
        joined({kPython, "-B", BESS_SOURCE_DIR "/tests/system/peers/price_source.py", "--behaviour",
                behaviour.json, "--prices", behaviour.prices, "--seed", "53"},
               simulated_time_of(site_)));
    ASSERT_EQ(std::sscanf(source_->read_line().c_str(), "port %d", &site_.market_port), 1);
    config_ = site_.commission({.price_server = behaviour.host, .price_keys = behaviour.keys});
    setenv("LD_PRELOAD", BESS_TWO_ADDRESSES, 1);
    edge_ = std::make_unique<ChildProcess>(std::vector<std::string>{
        edge_program(), "--config", config_, "--cycles", std::to_string(kCycles)});
    unsetenv("LD_PRELOAD");
  }
  std::vector<JournalCycle> cycles() {
    std::vector<JournalCycle> all;
    for (std::string line; !(line = edge_->read_line()).empty();) {
      if (!is_cycle_line(line)) continue;
      const JournalCycle cycle = journal_cycle(line);
      if (cycle.mode != "stopping") all.push_back(cycle);
    }
    EXPECT_EQ(edge_->wait(), 0);
    return all;
  }

  SimulatedSite site_{kScale};
  std::unique_ptr<ChildProcess> source_, edge_;
  std::string config_;
};

TEST_P(PriceSources, AreTradedOnRightOrNotAtAll) {
  const Behaviour& behaviour = GetParam();
  start();
  if (HasFatalFailure()) return;
  const std::vector<JournalCycle> all = cycles();
  ASSERT_GE(all.size(), 10U);
  int driven = 0, wrong = 0;
  std::string shown;
  for (const JournalCycle& cycle : all) {
    driven += cycle.wants() ? 1 : 0;
    const bool is_wave = std::string_view(behaviour.prices) == "wave";
    wrong += is_wave && cycle.wants() && !may_be_right(cycle) ? 1 : 0;
    shown += cycle.wants() ? (cycle.ordered_w > 0 ? "+ " : "- ") : cycle.reason + " ";
  }
  EXPECT_EQ(wrong, 0);
  const auto count = static_cast<int>(all.size());
  const std::map<Wanted, int> least{{kAll, count - 2}, {kSome, count / 2}, {kNone, 0}, {kRight, 0}};
  EXPECT_GE(driven, least.at(behaviour.wanted)) << shown;
  if (behaviour.wanted == kNone) {
    EXPECT_EQ(driven, 0) << shown;
    EXPECT_TRUE(all.back().reason == "no_price" || all.back().reason == "price_age") << shown;
  }
  if (*behaviour.status != 0) {
    EXPECT_EQ(all.back().prices, behaviour.status);
  }
}

/// Every tenth, and the others in the long run.
std::vector<Behaviour> each_tenth(bool rest) {
  std::vector<Behaviour> drawn;
  for (std::size_t i = 0; i < std::size(kBehaviours); ++i) {
    if ((i % 10 != 0) == rest) drawn.push_back(kBehaviours[i]);
  }
  return drawn;
}
std::string name_of(const ::testing::TestParamInfo<Behaviour>& info) { return info.param.name; }
INSTANTIATE_TEST_SUITE_P(Some, PriceSources, ::testing::ValuesIn(each_tenth(false)), name_of);
INSTANTIATE_TEST_SUITE_P(More, PriceSources, ::testing::ValuesIn(each_tenth(true)), name_of);

}  // namespace
}  // namespace bess
