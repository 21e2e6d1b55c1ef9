// Real bess-edge against batteries and gateways of user reports (field_device.py, independent of
// bess): orders, stop reasons, and energy. Each row of reports is a test, with three draws.
#include <gmock/gmock.h>

#include <csignal>
#include <cstdio>
#include <random>
#include <regex>

#include "tests/support/journal_fields.h"
#include "tests/support/peer_programs.h"
#include "tests/support/program_output.h"
#include "tests/support/shipped_maps.h"
#include "tests/support/signal_handler.h"
#include "tests/support/simulated_site.h"

namespace bess {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

constexpr std::int32_t kScale = 60;  // a control cycle takes 2 s
constexpr int kCycleS = 120;
constexpr double kRatedW = 4'000;
constexpr double kCheap = -600;  // charge
constexpr double kDear = 1'600;  // discharge

struct Draw {
  const char* name;
  unsigned index;  ///< variant, if a row lists several
  unsigned seed;   ///< seed of the other draws
  friend void PrintTo(const Draw& d, std::ostream* out) { *out << d.name; }
};
constexpr Draw kAlder{"alder", 0, 5201};
constexpr Draw kBirch{"birch", 1, 5202};
constexpr Draw kCedar{"cedar", 2, 5203};

struct Device {
  const char* kind = "";  ///< options of field_device.py
  std::string keys;       ///< lines of [battery]
  std::string firmware = "{}";
  std::string gateway = "{}";
  std::string trouble = "{}";
  double soc = 0.3;
  double price = kCheap;
};

using Cycle = JournalCycle;

std::string map_keys(const std::string& map, const std::string& more = "") {
  return "map = \"" + shipped_map(map) + "\"\nresponse_timeout_ms = 150\n" + more;
}
std::string victron_keys() {
  return map_keys("victron_ess3", "units = { vebus = 227, battery = 225 }\n");
}

class Field : public PeerTest, public ::testing::WithParamInterface<Draw> {
 protected:
  Field() : PeerTest("json") {}

  /// One of `low` to `high`, by this test's seed.
  int draw(int low, int high) {
    return low + static_cast<int>(random_() % static_cast<unsigned>(high - low + 1));
  }
  template <typename T>
  [[nodiscard]] T variant(const T& alder, const T& birch, const T& cedar) const {
    return GetParam().index == 0 ? alder : GetParam().index == 1 ? birch : cedar;
  }

  void start(const Device& device) {
    site_.start_clock();
    site_.battery = std::make_unique<ChildProcess>(joined(
        {kPython, "-B", BESS_SOURCE_DIR "/tests/system/peers/field_device.py", "--device",
         device.kind, "--firmware", device.firmware, "--gateway", device.gateway, "--trouble",
         device.trouble, "--soc", std::to_string(device.soc), "--record", record_path()},
        simulated_time_of(site_)));
    ASSERT_EQ(std::sscanf(site_.battery->read_line().c_str(), "port %d", &site_.battery_port), 1);
    ASSERT_TRUE(catches(site_.battery->pid(), SIGUSR2));
    site_.start_market({}, SimulatedSite::flat_prices(600, device.price));
    config_ = site_.write_config({.battery_keys = device.keys + "start_timeout_s = 1\n"});
  }
  std::string record_path() const { return site_.folder.file("device.txt"); }
  void begin_trouble() const { ASSERT_TRUE(site_.battery->signal(SIGUSR1)); }
  void end_trouble() const { ASSERT_TRUE(site_.battery->signal(SIGUSR2)); }

  [[nodiscard]] ProgramOutput run(std::vector<std::string> words) const {
    words.insert(words.begin(), edge_program());
    words.insert(words.end(), {"--config", config_});
    return answer_of(std::move(words));
  }
  [[nodiscard]] ProgramOutput commission() const { return run({"commission", "--yes"}); }

  void start_edge() {
    edge_ = std::make_unique<ChildProcess>(
        std::vector<std::string>{edge_program(), "--config", config_});
  }
  /// The next control cycles, fewer if the controller ends before.
  std::vector<Cycle> cycles(int count) {
    std::vector<Cycle> all;
    while (static_cast<int>(all.size()) < count) {
      const std::string line = edge_->read_line();
      if (line.empty()) break;
      if (!is_cycle_line(line)) {
        notes_.push_back(line);
        continue;
      }
      all.push_back(journal_cycle(line));
    }
    return all;
  }
  int stop_edge() {
    edge_->signal(SIGTERM);
    edge_->read_all();
    return edge_->wait();
  }

  struct Recorded {
    double utc_s;
    std::string what;
  };
  [[nodiscard]] std::vector<Recorded> record(const std::string& beginning = "") const {
    std::vector<Recorded> all;
    std::ifstream file(record_path());
    for (std::string line; std::getline(file, line);) {
      const std::size_t at = line.find(' ');
      if (at == std::string::npos || line.compare(at + 1, beginning.size(), beginning) != 0)
        continue;
      all.push_back({std::stod(line), line.substr(at + 1)});
    }
    return all;
  }
  /// Energy, + into the battery, by the device's own record.
  [[nodiscard]] double energy_wh(double from_s, double to_s) const {
    double wh = 0, power = 0, since = from_s;
    for (const Recorded& r : record("power ")) {
      const double at = std::min(std::max(r.utc_s, from_s), to_s);
      wh += power * (at - since) / 3'600;
      since = at;
      power = std::stod(r.what.substr(6));
    }
    return wh + power * (to_s - since) / 3'600;
  }
  /// Of rated power between the first and the last of these ticks.
  [[nodiscard]] double share_delivered(const std::vector<Cycle>& all) const {
    if (all.size() < 2) return 0;
    const auto from = static_cast<double>(all.front().utc_s + 30);  // the first order is written
    const auto to = static_cast<double>(all.back().utc_s);
    return std::abs(energy_wh(from, to)) / (kRatedW * (to - from) / 3'600);
  }
  static int driven(const std::vector<Cycle>& all) {
    return static_cast<int>(std::ranges::count_if(all, &Cycle::drives));
  }
  /// Ordered, whether or not the device took it.
  static int wanted(const std::vector<Cycle>& all) {
    return static_cast<int>(std::ranges::count_if(all, &Cycle::wants));
  }
  static std::vector<Cycle> after(const std::vector<Cycle>& all, double utc_s) {
    std::vector<Cycle> rest;
    for (const Cycle& c : all) {
      if (static_cast<double>(c.utc_s) >= utc_s) rest.push_back(c);
    }
    return rest;
  }

  void start_and_commission(const Device& device) {
    start(device);
    if (HasFatalFailure()) return;
    const ProgramOutput check = commission();
    ASSERT_EQ(check.exit_code, 0) << check.text;
  }
  /// A healthy device is commissioned and driven for two cycles; then the trouble begins.
  void drive_into_trouble(const Device& device) {
    start_and_commission(device);
    if (HasFatalFailure()) return;
    start_edge();
    ASSERT_GE(driven(cycles(2)), 1);
    begin_trouble();
  }
  /// The first control cycles on a commissioned device, from the first that is driven.
  std::vector<Cycle> commission_and_drive(const Device& device, int count) {
    start_and_commission(device);
    if (HasFatalFailure()) return {};
    start_edge();
    std::vector<Cycle> all = cycles(count);
    if (!all.empty() && !all.front().drives()) all.erase(all.begin());  // may begin within a cycle
    return all;
  }

  SimulatedSite site_{kScale};
  std::unique_ptr<ChildProcess> edge_;
  std::mt19937 random_{GetParam().seed};
  std::string config_;
  std::vector<std::string> notes_;  ///< lines other than control cycles
};

/// A gateway answers the read of the alarms and its retry with exception 11 or 10, then recovers;
/// half a minute later the device has a fault.
TEST_P(Field, AlarmsLostForOneRead) {
  const int code = GetParam().index == 1 ? 10 : 11;
  const int fault_after_s = draw(150, 200);
  const int spell_s = draw(4, 7);
  const auto trouble = [&](const char* place) {
    return "{\"refuse\": {" + std::string(place) + ", \"code\": " + std::to_string(code) +
           ", \"spell_s\": " + std::to_string(spell_s) +
           "}, \"fault_after_s\": " + std::to_string(fault_after_s) + "}";
  };
  drive_into_trouble(
      variant(Device{.kind = "sungrow",
                     .keys = map_keys("sungrow_sh"),
                     .firmware = R"({"countdown": false})",
                     .trouble = trouble(R"("unit": 1, "first": 13053, "last": 13076)")},
              Device{.kind = "victron",
                     .keys = victron_keys(),
                     .trouble = trouble(R"("unit": 225, "first": 256, "last": 330)")},
              Device{.kind = "alphaess",
                     .keys = map_keys("alphaess"),
                     .trouble = trouble(R"("unit": 85, "first": 2260, "last": 2261)")}));
  if (HasFatalFailure()) return;
  const std::vector<Cycle> all = cycles(5);
  ASSERT_GE(record("refused").size(), 2U);
  ASSERT_EQ(record("fault").size(), 1U);
  const double fault_s = record("fault")[0].utc_s;
  EXPECT_TRUE(all.front().drives()) << all.front().reason;  // read again within the tick
  const std::vector<Cycle> rest = after(all, fault_s + 5);  // read up to 3 s before a tick
  ASSERT_GE(rest.size(), 2U);
  EXPECT_EQ(wanted(rest), 0);
  EXPECT_EQ(rest.front().reason, "alarm");
  EXPECT_THAT(run({"status", "--prometheus"}).text, HasSubstr(",reason=\"alarm\""));
}

/// A unit behind a gateway is permanently gone: a BMS's alarms, a range, the off-grid state.
TEST_P(Field, ProtectionLostForGood) {
  const std::string reason = GetParam().index == 1 ? "grid_unknown" : "protection_lost";
  drive_into_trouble(variant(
      Device{.kind = "victron",
             .keys = victron_keys(),
             .trouble = R"({"refuse": {"unit": 225, "first": 0, "last": 65535, "code": 10}})"},
      Device{.kind = "victron",
             .keys = victron_keys(),
             .trouble = R"({"refuse": {"unit": 227, "first": 29, "last": 29, "code": 10},
                            "island_after_s": 60})"},
      Device{.kind = "sungrow",
             .keys = map_keys("sungrow_sh"),
             .firmware = R"({"countdown": false})",
             .trouble = R"({"refuse": {"unit": 1, "first": 13053, "last": 13076, "code": 11}})"}));
  if (HasFatalFailure()) return;
  const std::vector<Cycle> all = cycles(5);
  ASSERT_GE(record("refused").size(), 1U);
  ASSERT_EQ(all.size(), 5U);
  EXPECT_EQ(wanted(all), 0);
  EXPECT_EQ(record("power ").back().what, "power 0");
  for (const Cycle& c : all) EXPECT_EQ(c.reason, reason);
  EXPECT_EQ(all.front().mode, reason == "grid_unknown" ? "safe" : "holding");
  const ProgramOutput status = run({"status", "--prometheus"});
  EXPECT_THAT(status.text, HasSubstr(",reason=\"" + reason + "\""));
  EXPECT_EQ(run({"status"}).exit_code, 1);
  // Retries for 10 s, without parallel attempts.
  const std::vector<Recorded> tries = record("refused");
  EXPECT_GE(std::ranges::count_if(tries,
                                  [&](const Recorded& r) {
                                    return r.utc_s >= tries.front().utc_s + 5 &&
                                           r.utc_s <= tries.front().utc_s + 60;
                                  }),
            1);
}

/// No chain with 103 and 124, or none yet: nothing aborts, and an order can be released as soon as
/// the device is there, so it is driven.
TEST_P(Field, SunSpecBootsOrIsAnother) {
  const std::string boot = variant<std::string>("\"zeros\"", "\"ones\"",
                                                std::to_string(draw(0, 2) == 0   ? 2
                                                               : draw(0, 1) == 0 ? 4
                                                                                 : 11));
  start_and_commission(
      {.kind = "sunspec", .keys = map_keys("sunspec_124"), .trouble = "{\"boot\": " + boot + "}"});
  if (HasFatalFailure()) return;
  begin_trouble();
  for (const std::vector<std::string>& words : std::vector<std::vector<std::string>>{
           {"--check"}, {"--self-test"}, {"commission", "--yes"}, {"release", "--yes"}}) {
    const ProgramOutput answer = run(words);
    EXPECT_EQ(answer.exit_code, 1) << words[0] << ": " << answer.text;
  }
  EXPECT_EQ(run({}).exit_code, 1);  // systemd starts it again
  end_trouble();
  start_edge();
  const std::vector<Cycle> there = cycles(4);
  EXPECT_GE(driven(there), 2);
  EXPECT_EQ(stop_edge(), 0);
  EXPECT_EQ(run({"release", "--yes"}).exit_code, 0);
}

/// A device that has no such chain: one error, of models and bases.
TEST_P(Field, SunSpecChainIsAnother) {
  start({.kind = "sunspec",
         .keys = map_keys("sunspec_124"),
         .firmware = variant<std::string>(R"({"models": [1, 101]})", R"({"models": [1, 103, 120]})",
                                          R"({"boot": "zeros"})")});
  if (HasFatalFailure()) return;
  const std::string missing = GetParam().index == 1 ? "124" : "103";
  for (const std::vector<std::string>& words : std::vector<std::vector<std::string>>{
           {"--check"}, {"--self-test"}, {"commission", "--yes"}, {"release", "--yes"}, {}}) {
    const ProgramOutput answer = run(words);
    const std::string name = words.empty() ? "run" : words[0];
    EXPECT_EQ(answer.exit_code, 1) << name << ": " << answer.text;
    EXPECT_THAT(answer.text, AllOf(HasSubstr(missing), HasSubstr("40000"))) << name;
  }
}

/// The BMS shows more than 100 %: from the start, where a full battery is sold, or as soon as it is
/// full. The value is clamped, and reported once.
TEST_P(Field, SocAboveHundred) {
  const bool is_victron = GetParam().index == 1, becomes_full = GetParam().index == 2;
  const std::string gain =
      variant<std::string>("1.01", "1.04", "1.00" + std::to_string(draw(2, 5)));
  start_and_commission({.kind = is_victron ? "victron" : "alphaess",
                        .keys = is_victron ? victron_keys() : map_keys("alphaess"),
                        .trouble = "{\"firmware\": {\"soc_gain\": " + gain + "}}",
                        .soc = becomes_full ? 0.96 : 1,
                        .price = becomes_full ? kCheap : kDear});
  if (HasFatalFailure()) return;
  begin_trouble();
  start_edge();
  const std::vector<Cycle> all = cycles(8);
  EXPECT_EQ(all.size(), 8U);
  EXPECT_EQ(std::ranges::count(all, "link", &Cycle::reason), 0);
  EXPECT_GE(driven(all), becomes_full ? 1 : 7);  // the first may have begun within a control cycle
  for (const Cycle& c : all) {
    EXPECT_EQ(c.mode, "running");
    if (!becomes_full) {
      EXPECT_LE(c.ordered_w, 0);
    }
  }
  const auto names_it = [](const std::string& line) {
    return std::regex_search(line, std::regex("soc.*\\b10[0-9]"));
  };
  EXPECT_EQ(std::ranges::count_if(notes_, names_it), 1);
}

/// Commissioning finds the firmware's sign of the battery power, and the day is driven.
TEST_P(Field, SungrowFirmware) {
  const std::vector<Cycle> all = commission_and_drive(
      {.kind = "sungrow",
       .keys = map_keys("sungrow_sh"),
       .firmware = variant<std::string>(R"({"signed": true})", R"({"signed": true, "bits": false})",
                                        R"({"signed": false})")},
      8);
  EXPECT_GE(driven(all), 7);
  for (std::size_t i = 1; i < all.size(); ++i) {
    EXPECT_NEAR(all[i].measured_w, all[i - 1].ordered_w, 100);
  }
  EXPECT_GE(share_delivered(all), 0.98);
}

/// Firmware update while running: correct from then on, or a permanent stop.
TEST_P(Field, SungrowUpdate) {
  drive_into_trouble(
      {.kind = "sungrow",
       .keys = map_keys("sungrow_sh"),
       .firmware = R"({"signed": false, "countdown": false})",
       .trouble = variant<std::string>(R"({"firmware": {"signed": true}})",
                                       R"({"firmware": {"signed": true, "bits": false}})",
                                       R"({"firmware": {"signed": true, "countdown": true}})")});
  if (HasFatalFailure()) return;
  const std::vector<Cycle> all = cycles(12);
  ASSERT_EQ(all.size(), 12U);
  int changes = 0;
  for (std::size_t i = 4; i < all.size(); ++i) {
    changes += all[i].drives() != all[i - 1].drives() ? 1 : 0;
    if (!all[i].drives()) continue;
    EXPECT_NEAR(all[i].measured_w, all[i - 1].ordered_w, 100);
  }
  EXPECT_EQ(changes, 0);
}

/// Set points end after 10 s, 60 s or a time in between: refreshed in time, or the key to set is
/// named.
TEST_P(Field, VictronSetPointEndsSooner) {
  const std::string timeout_s = variant<std::string>("10", "60", std::to_string(draw(10, 20)));
  start({.kind = "victron",
         .keys = victron_keys(),
         .firmware = "{\"timeout_s\": " + timeout_s + "}"});
  if (HasFatalFailure()) return;
  const ProgramOutput check = commission();
  if (check.exit_code != 0) {
    EXPECT_THAT(check.text, AllOf(HasSubstr("refresh_s"), ::testing::Not(HasSubstr("settle_s"))));
    return;
  }
  start_edge();
  std::vector<Cycle> all = cycles(9);
  if (!all.empty() && !all.front().drives()) all.erase(all.begin());
  EXPECT_GE(driven(all), 8);
  EXPECT_EQ(std::ranges::count(all, "no_answer", &Cycle::reason), 0);
  EXPECT_GE(share_delivered(all), 0.95);
}

/// 2902 reads 0 until it is written.
TEST_P(Field, VictronModeReadsZero) {
  const std::vector<Cycle> all = commission_and_drive(
      {.kind = "victron",
       .keys = victron_keys(),
       .firmware = "{\"timeout_s\": 60, \"mode\": " + variant<std::string>("0", "1", "2") + "}"},
      6);
  EXPECT_GE(driven(all), 5);
  if (edge_) {
    EXPECT_EQ(stop_edge(), 0);
  }
  const std::vector<Recorded> modes = record("write 100 2902 ");
  ASSERT_GE(modes.size(), 2U);
  EXPECT_EQ(modes.back().what, "write 100 2902 " + variant<std::string>("0", "1", "2"));
}

/// Exception 6 for 6 to 8 s around each third or each tick.
TEST_P(Field, BusyAroundTheTick) {
  const int every = variant(3, 1, 1);
  const int length_s = variant(6, 6, 8);
  const int before_s = draw(1, length_s - 2);
  const bool is_sungrow = GetParam().index == 2;
  drive_into_trouble({.kind = is_sungrow ? "sungrow" : "sma",
                      .keys = map_keys(is_sungrow ? "sungrow_sh" : "sma"),
                      .firmware = R"({"countdown": false})",
                      .gateway = "{\"busy\": {\"every\": " + std::to_string(every) +
                                 ", \"before_s\": " + std::to_string(before_s) +
                                 ", \"after_s\": " + std::to_string(length_s - before_s) + "}}"});
  if (HasFatalFailure()) return;
  const std::vector<Cycle> all = cycles(16);
  ASSERT_EQ(all.size(), 16U);
  const double share = share_delivered(all);
  EXPECT_GE(share, every == 3 ? 0.98 : 0.9);
  EXPECT_EQ(stop_edge(), 0);
  EXPECT_EQ(record("power ").back().what, "power 0");
}

TEST_P(Field, StopWhileBusy) {
  const int before_s = draw(2, 5);
  drive_into_trouble(
      {.kind = "alphaess",
       .keys = map_keys("alphaess"),
       .gateway = "{\"busy\": {\"every\": 1, \"before_s\": " + std::to_string(before_s) +
                  ", \"after_s\": " + std::to_string(8 - before_s) + "}}"});
  if (HasFatalFailure()) return;
  const std::vector<Cycle> all = cycles(variant(1, 2, 3));
  const std::int64_t busy_s = all.back().utc_s + kCycleS - before_s + 1;
  sleep_until_monotonic(site_.anchor_ns() +
                        (busy_s - SimulatedSite::kStartS) * kNanosecondsPerSecond / kScale);
  const int exit_code = stop_edge();
  EXPECT_EQ(exit_code, 0);
  EXPECT_EQ(record("write 85 2176 ").back().what.substr(0, 16), "write 85 2176 0 ");
}

/// Every Nth answer only comes before the next one, on any connection.
TEST_P(Field, LateAnswers) {
  const int every = draw(8, 14);
  const char* const kind = variant<const char*>("alphaess", "sma", "alphaess");
  drive_into_trouble(
      {.kind = kind,
       .keys = map_keys(kind),
       .gateway = "{\"late\": " + std::to_string(every) + ", \"one_client\": true}"});
  if (HasFatalFailure()) return;
  const std::vector<Cycle> all = cycles(12);
  EXPECT_EQ(driven(all), 12);
}

TEST_P(Field, ForeignUnitIds) {
  const std::vector<Cycle> all = commission_and_drive(
      {.kind = variant<const char*>("alphaess", "sunspec", "sma"),
       .keys = map_keys(variant<const char*>("alphaess", "sunspec_124", "sma")),
       .gateway = "{\"answer_unit\": " + variant<std::string>("0", "255", "0") + "}"},
      6);
  ASSERT_GE(all.size(), 5U);
  EXPECT_EQ(driven(all), static_cast<int>(all.size()));
}

/// No answer at a base that the device does not use: the chain is at the next one.
TEST_P(Field, SunSpecBaseIsSilent) {
  const std::vector<Cycle> all = commission_and_drive(
      {.kind = "sunspec",
       .keys = map_keys("sunspec_124"),
       .firmware = variant<std::string>(R"({"base": 50000, "silent": [40000]})",
                                        R"({"base": 0, "silent": [40000, 50000]})",
                                        R"({"base": 0, "silent": [50000]})")},
      5);
  EXPECT_GE(driven(all), 4);
}

/// Inverters that only obey the set point, and have no 40153; and one that obeys both.
TEST_P(Field, SmaObeysTheSetPointAlone) {
  start({.kind = "sma",
         .keys = map_keys(
             "sma", variant<std::string>("variant = \"setpoint\"\n", "variant = \"bms_mode\"\n",
                                         "variant = \"bms_mode\"\n")),
         .firmware =
             variant<std::string>(R"({"smart_energy": true})", R"({"smart_energy": true})", "{}")});
  if (HasFatalFailure()) return;
  const ProgramOutput check = commission();
  // Ignored limits are found before the first trade.
  EXPECT_EQ(check.exit_code, variant(0, 1, 0)) << check.text;
  if (check.exit_code != 0) return;
  start_edge();
  const std::vector<Cycle> all = cycles(5);
  EXPECT_GE(driven(all), 4);
}

std::string draw_name(const ::testing::TestParamInfo<Draw>& info) { return info.param.name; }

INSTANTIATE_TEST_SUITE_P(One, Field, ::testing::Values(kAlder), draw_name);
INSTANTIATE_TEST_SUITE_P(More, Field, ::testing::Values(kBirch, kCedar), draw_name);  // long

}  // namespace
}  // namespace bess
