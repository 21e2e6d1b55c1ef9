// Real programs together: bess-edge between bess-sim battery and bess-sim market, over Modbus TCP
// and HTTP on free ports, in scaled time. The battery's own record is compared with the edge's log.
#include <gmock/gmock.h>
#include <sys/socket.h>
#include <sys/un.h>

#include <cstdlib>
#include <filesystem>

#include "tests/support/edge_answer.h"
#include "tests/support/tokens.h"
#include "tests/support/utc_of.h"

namespace bess {
namespace {

using ::testing::AllOf;
using ::testing::ContainsRegex;
using ::testing::HasSubstr;

constexpr std::int32_t kScale = 900;  // from an hour before summer time on

/// Slow enough that an order outlasts the start of a process. The environment names a program under
/// test in sanitizer runs, which start more slowly.
std::int32_t outlasting_scale() {
  return kScale / (std::getenv("BESS_EDGE_UNDER_TEST") != nullptr ? 10 : 3);
}

/// The line of the next control cycle that orders power, empty if it ended before.
std::string line_with_power(ChildProcess& edge) {
  std::string line;
  do line = edge.read_line();
  while (!line.empty() && (line.find(" written=1 ") == std::string::npos ||
                           line.find(" ordered_power_w=0 ") != std::string::npos));
  return line;
}

class Processes : public SiteTest {
 protected:
  Processes() : SiteTest(kScale) {}
};

/// Slower than the others, so that an order outlasts the start of a process.
class SlowProcesses : public SiteTest {
 protected:
  SlowProcesses() : SiteTest(outlasting_scale()) {}
};

/// A third of the speed, so that a busy machine gets most prices in time.
class UnhurriedProcesses : public SiteTest {
 protected:
  UnhurriedProcesses() : SiteTest(kScale / 3) {}
};

TEST_F(UnhurriedProcesses, TheBatterysOwnRecordAgreesWithTheEdgesLog) {
  start_site();
  ChildProcess edge = controller({"--cycles", "30"});
  edge.read_all();
  EXPECT_EQ(edge.wait(), 0);
  EXPECT_EQ(SimulatedSite::stop(*site_.battery), 0);
  EXPECT_EQ(SimulatedSite::stop(*site_.market), 0);

  double ordered_wh = 0;
  int moves = 0;
  const std::vector<CsvRow> log = edge_log();
  ASSERT_EQ(log.size(), 31U);  // 30 control cycles and the stop
  for (const CsvRow& row : log) {
    if (row.at("mode") == "stopping") continue;
    EXPECT_EQ(row.at("written"), "1") << row.at("utc");
    const int power_w = std::stoi(row.at("ordered_power_w"));
    EXPECT_LE(std::abs(power_w), 4'000);
    ordered_wh += power_w / 30.0;
    if (power_w != 0) ++moves;
  }
  EXPECT_GT(moves, 5);  // a busy machine gets some prices too late and holds
  double exchanged_wh = 0;
  for (const CsvRow& row : battery_record()) {
    exchanged_wh += std::stod(row.at("energy_wh"));
    EXPECT_GE(std::stod(row.at("soc")), 0.1);
    EXPECT_LE(std::stod(row.at("soc")), 1.0);
  }
  // Each order begins about 0.5 s of simulated time after its tick; a busy machine needs more.
  EXPECT_NEAR(exchanged_wh, ordered_wh, 0.1 * 4'000 / 30.0 * moves);
}

TEST_F(Processes, SigtermOrdersZeroReleasesAndExitsWithZero) {
  start_site();
  ChildProcess edge = controller();
  ASSERT_THAT(line_with_power(edge), HasSubstr("mode=running"));
  edge.signal(SIGTERM);
  EXPECT_THAT(edge.read_all(), HasSubstr("mode=stopping"));
  EXPECT_EQ(edge.wait(), 0);
  EXPECT_EQ(SimulatedSite::stop(*site_.battery), 0);
  const std::vector<CsvRow> record = battery_record();
  ASSERT_FALSE(record.empty());
  EXPECT_EQ(record.back().at("commanded_power_w"), "0");
}

/// A second controller with a separate state folder: the battery's lock excludes it, also for one
/// that only reads, because the battery serves one connection.
TEST_F(Processes, TwoControllersCannotShareABattery) {
  start_site();
  const std::string other = site_.commission({.state = "other"});
  ChildProcess edge = controller();
  EXPECT_THAT(await_line(edge, "utc="), HasSubstr("cycle=1 "));
  ChildProcess ways[] = {
      ChildProcess({edge_program(), "--config", other}),
      ChildProcess({edge_program(), "--config", other, "--check"}),
      ChildProcess({edge_program(), "--config", other, "--dry-run"}),
      ChildProcess({edge_program(), "release", "--config", other, "--yes"}),
  };  // together: each waits 1 s for the lock
  for (ChildProcess& second : ways) {
    const std::string text = second.read_all();
    EXPECT_EQ(second.wait(), 1) << text;
    EXPECT_THAT(text, Names("85 " + std::to_string(edge.pid())));
    EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 1) << text;
  }
  EXPECT_THAT(await_line(edge, "utc="), HasSubstr("mode=running")) << "undisturbed";
  edge.signal(SIGKILL);
  edge.wait();
  const ProgramOutput successor = bess::edge({"--config", other, "--cycles", "1"});
  EXPECT_THAT(successor.text, HasSubstr("mode=stopping"));
  EXPECT_EQ(successor.exit_code, 0);
}

/// Two batteries, one state folder: the logs would overwrite each other.
TEST_F(Processes, TwoControllersCannotShareAStateFolder) {
  start_site();
  ChildProcess edge = controller();
  ASSERT_NE(await_line(edge, "utc="), "");
  const auto first_battery = std::move(site_.battery);
  site_.start_battery();
  const ProgramOutput second = bess::edge({"--config", site_.write_config()});
  EXPECT_EQ(second.exit_code, 1);
  EXPECT_THAT(second.text, Names(site_.folder.file("state") + " " + std::to_string(edge.pid())));
}

TEST_F(Processes, StatusAndLogShowWhatTheRunningControllerDoes) {
  start_site();
  const auto run = [&](const std::vector<std::string>& arguments, int expected_exit_code) {
    const ProgramOutput said = ask(arguments);
    EXPECT_EQ(said.exit_code, expected_exit_code) << said.text;
    return said.text;
  };
  run({"status"}, 3);
  EXPECT_THAT(run({"log"}, 1), Names("state/decisions.ring"));
  EXPECT_THAT(run({"status", "--prometheus"}, 1), Names("/state status"));
  {
    ChildProcess edge = controller();
    for (int i = 0; i < 15; ++i) await_line(edge, "utc=");
    // A loaded machine may be late with a cycle of 133 ms: ok and degraded are both correct.
    const ProgramOutput status = ask({"status"});
    EXPECT_LE(status.exit_code, 1) << status.text;
    EXPECT_THAT(status.text, Names(std::to_string(edge.pid()) + " running alphaess block EUR/MWh"));
    EXPECT_THAT(status.text, HasSubstr(" 2023-03-26 0"));
    const Json json = status_of(config_);
    EXPECT_TRUE(json.value()["control"].boolean().value_or(false));
    EXPECT_EQ(json.value()["pid"].number(), edge.pid());
    EXPECT_STREQ(json.value()["last"]["mode"].text_or(""), "running");
    EXPECT_THAT(ask({"status", "--prometheus"}).text,
                ContainsRegex("bess_state[{].*state=\"running\"[}] 1\n"));
    EXPECT_EQ(SimulatedSite::stop(edge), 0);
  }
  EXPECT_STREQ(status_of(config_).value()["last"]["mode"].text_or(""), "stopping");
  ChildProcess follower({edge_program(), "status", "--follow", "--config", config_});
  for (int views = 0; views < 2; ++views) ASSERT_NE(await_line(follower, " stopping "), "");
  // The ring and the controller's CSV are the same log, line by line.
  EXPECT_EQ(run({"log", "--csv"}, 0), text_of_file(site_.folder.file("edge.csv")));
  const std::string last = run({"log", "--last", "2"}, 0);
  EXPECT_EQ(std::count(last.begin(), last.end(), '\n'), 2) << last;
  EXPECT_THAT(last, HasSubstr("mode=stopping"));
  const std::vector<CsvRow> rows = edge_log();
  const std::string& middle = rows.at(rows.size() / 2).at("utc");
  EXPECT_THAT(run({"log", "--since", middle}, 0), ::testing::StartsWith("utc=" + middle + " "));
}

/// systemd's side of a service: ready, alive every control cycle, stopping.
TEST_F(Processes, SystemdIsNotifiedOfStartCyclesAndStop) {
  const std::string name = site_.folder.file("notify");
  const int systemd = socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  ASSERT_LT(name.size(), sizeof address.sun_path);
  name.copy(address.sun_path, name.size());
  ASSERT_EQ(bind(systemd, reinterpret_cast<sockaddr*>(&address), sizeof address), 0);
  start_site();
  setenv("NOTIFY_SOCKET", name.c_str(), 1);
  EXPECT_EQ(ask({"--cycles", "3"}).exit_code, 0);
  unsetenv("NOTIFY_SOCKET");
  std::vector<std::string> reported;
  char text[512];
  for (ssize_t n = 0; (n = recv(systemd, text, sizeof text, MSG_DONTWAIT)) >= 0;) {
    reported.emplace_back(text, static_cast<std::size_t>(n));
  }
  close(systemd);
  ASSERT_FALSE(reported.empty());
  EXPECT_THAT(reported[0], Names("EXTEND_TIMEOUT_USEC=61000000"));
  // A student by level asks for more time to read the price level's history.
  std::erase_if(reported,
                [](const std::string& t) { return t.starts_with("EXTEND_TIMEOUT_USEC="); });
  ASSERT_EQ(reported.size(), 5U);
  EXPECT_THAT(reported[0], HasSubstr("READY=1"));
  EXPECT_THAT(reported[1], Names("STATUS=running"));  // its WATCHDOG=1 only if in time
  EXPECT_THAT(reported[4], HasSubstr("STOPPING=1"));
}

TEST_F(Processes, CheckReportsAndReadsButWritesNothing) {
  site_.start_both();
  sleep_until_monotonic(site_.anchor_ns());
  const ProgramOutput early = edge({"--config", site_.write_config(), "--check"});
  EXPECT_EQ(early.exit_code, 1);  // as the start would
  EXPECT_THAT(early.text, Names("state/commissioned.toml bess-edge commission"));
  const ProgramOutput checked = edge({"--config", site_.commission(), "--check"});
  EXPECT_EQ(checked.exit_code, 0) << checked.text;
  EXPECT_THAT(checked.text, Names("-500 1500 127.0.0.1 8000"));
  EXPECT_THAT(checked.text, HasSubstr("0x0880:[1 0 28000 0 32000 2 255 0 300 255 0]"));
  // The sign check has charged a little.
  EXPECT_THAT(checked.text, AllOf(ContainsRegex(" 50[.][0-9] %"), ContainsRegex("[0-9] EUR/MWh")));
}

TEST_F(Processes, WithoutAConfigurationTheInstalledOneIsMeant) {
  if (access("/etc/bess/edge.toml", R_OK) == 0) GTEST_SKIP() << "bess-edge is installed here";
  for (const char* command : {"status", "log", "--dry-run"}) {
    const ProgramOutput said = edge({command});
    EXPECT_EQ(said.exit_code, 2);
    EXPECT_THAT(said.text, Names("--config /etc/bess/edge.toml"));
  }
}

TEST_F(Processes, ABatteryWhoseSignWasNeverCheckedIsNotControlled) {
  site_.start_both();
  config_ = site_.write_config();
  const ProgramOutput refused = ask({});
  EXPECT_EQ(refused.exit_code, 1);
  EXPECT_THAT(refused.text, Names("bess-edge commission --config --yes"));
  const ProgramOutput hesitant = ask({"commission"});
  EXPECT_EQ(hesitant.exit_code, 2);
  EXPECT_THAT(hesitant.text, Names("500 W 30 --yes"));
  const ProgramOutput reader = ask({"--dry-run", "--cycles", "1"});
  EXPECT_EQ(reader.exit_code, 0);
  EXPECT_THAT(reader.text, Names("cycle=1 written=0"));
  EXPECT_EQ(SimulatedSite::stop(*site_.battery), 0);
  for (const CsvRow& row : battery_record()) {
    EXPECT_EQ(row.at("commanded_power_w"), "0");
  }
}

TEST_F(Processes, ARefusedStartLeavesTheStatusOfThePreviousRun) {
  start_site();
  EXPECT_EQ(ask({"--cycles", "2"}).exit_code, 0);
  const auto status = [&] { return text_of_file(site_.folder.file("state/status.json")); };
  const std::string before = status();
  ASSERT_THAT(before, HasSubstr("\"reason\": \"stop_requested\""));
  for (const char* name : {"state/commissioned.toml", "state/commissioned.copy"}) {
    std::filesystem::remove(site_.folder.file(name));
  }
  EXPECT_EQ(ask({}).exit_code, 1);
  EXPECT_EQ(status(), before);
}

/// As for an upgrade: SIGHUP, and a new process continues the order.
TEST_F(SlowProcesses, AHandOverKeepsThePowerAndARestartContinues) {
  start_site();
  const ChildProcess prices({BESS_PRICES_PROGRAM, "--config", config_});  // it outlasts the change
  ChildProcess before = controller();
  ASSERT_THAT(line_with_power(before), HasSubstr("mode=running"));
  before.signal(SIGHUP);
  EXPECT_THAT(before.read_all(), HasSubstr("reason=hand_over"));
  EXPECT_EQ(before.wait(), 0);
  const ProgramOutput after = ask({"--cycles", "3"});
  EXPECT_THAT(after.text, HasSubstr("reason=stop_requested"));
  EXPECT_EQ(after.exit_code, 0);
  int first_cycles = 0;
  for (const CsvRow& row : edge_log()) {
    EXPECT_NE(row.at("mode"), "holding") << row.at("utc");
    if (row.at("mode") != "running" || row.at("cycle") != "1" || ++first_cycles != 2) continue;
    EXPECT_NE(row.at("battery_power_w"), "0") << "the order did not outlast the change";
  }
  EXPECT_EQ(first_cycles, 2);
}

/// A killed controller's order, ended by a command before its watchdog does.
TEST_F(SlowProcesses, ReleaseEndsAnOrphanedOrder) {
  start_site();
  ChildProcess edge = controller();
  const std::string order = line_with_power(edge);
  ASSERT_THAT(order, ::testing::StartsWith("utc="));
  edge.signal(SIGKILL);
  edge.wait();
  const ProgramOutput hesitant = ask({"release"});
  EXPECT_THAT(hesitant.text, Names("--yes"));
  EXPECT_EQ(hesitant.exit_code, 2);
  EXPECT_EQ(ask({"release", "--yes"}).exit_code, 0);
  const std::int64_t ordered_utc_s = utc_of(order.substr(4, order.find(' ') - 4));
  sleep_until_monotonic(clock_ns(CLOCK_MONOTONIC) +
                        100 * kNanosecondsPerSecond / outlasting_scale());
  EXPECT_EQ(SimulatedSite::stop(*site_.battery), 0);
  bool ended_by_hand = false;  // the watchdog would have after 300 s
  for (const CsvRow& row : battery_record()) {
    const std::int64_t age_s = utc_of(row.at("minute_utc")) - ordered_utc_s;
    ended_by_hand |= age_s > 0 && age_s < 240 && row.at("commanded_power_w") == "0";
  }
  EXPECT_TRUE(ended_by_hand);
}

TEST_F(Processes, TheWrongBatteryIsRefusedBeforeAnythingIsWritten) {
  site_.start_battery({"--capacity-wh", "12000"});
  site_.market_port = 1;
  const ProgramOutput said = edge({"--config", site_.write_config()});
  EXPECT_THAT(said.text, Names("capacity 281 12000"));
  EXPECT_EQ(said.exit_code, 1);
}

ProgramOutput self_test(const std::string& config) {
  return edge({"--config", config, "--self-test"});
}

TEST(SelfTest, NamesWhatFails) {
  SimulatedSite site(60);
  const ProgramOutput missing = self_test(site.write_config());  // no server listens
  EXPECT_EQ(missing.exit_code, 1);
  EXPECT_THAT(missing.text, AllOf(ContainsRegex("network +FAIL"),
                                  ContainsRegex("battery +FAIL +127[.]0[.]0[.]1:")));
  EXPECT_THAT(missing.text, ContainsRegex("student +ok"));
  site.start_battery({"--capacity-wh", "20000"});
  const ProgramOutput another = self_test(site.write_config());
  EXPECT_EQ(another.exit_code, 1);
  EXPECT_THAT(another.text,
              AllOf(ContainsRegex("battery +FAIL"), Names("capacity 20000 capacity_wh")));
}

}  // namespace
}  // namespace bess
