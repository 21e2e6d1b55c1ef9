// The real programs together: bess-edge between bess-sim battery and bess-sim market, over Modbus
// TCP and HTTP on free ports, in scaled time. The battery's own record is held against the edge's
// log.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/un.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "tests/support/simulated_site.h"
#include "tests/support/toml_mistakes.h"

namespace bess {
namespace {

using ::testing::AllOf;
using ::testing::ContainsRegex;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr std::int32_t kScale = 900;  // from an hour before summer time on

/// Slow enough that an order outlasts the start of a process. The environment names a program under
/// test when a sanitizer looks at it, and that takes longer to start.
std::int32_t outlasting_scale() {
  return kScale / (std::getenv("BESS_EDGE_UNDER_TEST") != nullptr ? 10 : 3);
}

/// Notes are about the machine that the test runs on: no seccomp, memory that may not be locked.
/// The guard's thresholds are said at every start, and by level how the price level was come by.
std::string line_after_notes(ChildProcess& child) {
  std::string line = child.read_line();
  while (line.starts_with("bess-edge: note:") || line.starts_with("guard: ") ||
         line.starts_with("price level: ")) {
    line = child.read_line();
  }
  return line;
}

std::int64_t utc_of(const std::string& text) {
  std::int64_t utc_s = 0;
  EXPECT_TRUE(parse_utc(text, utc_s)) << text;
  return utc_s;
}

/// Follows a controller until it orders power; the line of that cycle, empty when it ended before.
std::string line_with_power(ChildProcess& edge) {
  std::string line;
  do line = edge.read_line();
  while (!line.empty() && (line.find(" written=1 ") == std::string::npos ||
                           line.find(" ordered_power_w=0 ") != std::string::npos));
  return line;
}

/// Starts the two simulators; the edge is started by each test.
class Processes : public ::testing::Test {
 protected:
  void start_simulators(const std::vector<std::string>& market_faults = {},
                        const std::vector<std::string>& battery_faults = {}) {
    site_.start_battery(battery_faults);
    site_.start_market(market_faults);
  }

  SimulatedSite site_{kScale};
};

TEST_F(Processes, TheBatterysOwnRecordAgreesWithTheEdgesLog) {
  start_simulators();
  ChildProcess edge({edge_program(), "--config", site_.commission(), "--cycles", "45"});
  EXPECT_THAT(edge.read_all(), HasSubstr("stopped: battery released"));
  EXPECT_EQ(edge.wait(), 0);
  EXPECT_EQ(SimulatedSite::stop(*site_.battery), 0);
  EXPECT_EQ(SimulatedSite::stop(*site_.market), 0);

  double ordered_wh = 0;
  int moves = 0;
  const std::vector<CsvRow> log = read_csv(site_.folder.file("edge.csv"));
  ASSERT_EQ(log.size(), 46U);  // 45 cycles and the stop
  for (const CsvRow& row : log) {
    if (row.at("mode") == "stopping") continue;
    EXPECT_EQ(row.at("mode"), "running") << row.at("utc");
    EXPECT_EQ(row.at("written"), "1");
    const int power_w = std::stoi(row.at("ordered_power_w"));
    EXPECT_LE(std::abs(power_w), 4'000);
    ordered_wh += power_w / 30.0;
    if (power_w != 0) ++moves;
  }
  EXPECT_GT(moves, 10);
  double exchanged_wh = 0;
  for (const CsvRow& row : read_csv(site_.folder.file("battery.csv"))) {
    exchanged_wh += std::stod(row.at("energy_wh"));
    EXPECT_GE(std::stod(row.at("soc")), 0.1);
    EXPECT_LE(std::stod(row.at("soc")), 1.0);
  }
  // Each order begins about a second of simulated time after its tick; a busy machine needs more.
  EXPECT_NEAR(exchanged_wh, ordered_wh, 0.1 * 4'000 / 30.0 * moves);
}

TEST_F(Processes, SigtermOrdersZeroReleasesAndExitsWithZero) {
  start_simulators();
  ChildProcess edge({edge_program(), "--config", site_.commission()});
  EXPECT_EQ(line_after_notes(edge), "started: in control");
  ASSERT_THAT(line_with_power(edge), HasSubstr("mode=running"));
  edge.signal(SIGTERM);
  EXPECT_THAT(edge.read_all(), HasSubstr("mode=stopping"));
  EXPECT_EQ(edge.wait(), 0);
  EXPECT_EQ(SimulatedSite::stop(*site_.battery), 0);
  const std::vector<CsvRow> record = read_csv(site_.folder.file("battery.csv"));
  ASSERT_FALSE(record.empty());
  EXPECT_EQ(record.back().at("commanded_power_w"), "0");
}

/// A second controller, with a state folder of its own: the battery's lock stands between them, for
/// one that only reads as well, because the battery serves one connection.
TEST_F(Processes, TwoControllersCannotShareABattery) {
  start_simulators();
  const std::string mine = site_.commission();
  const std::string other = site_.commission({.state = "other"});
  ChildProcess edge({edge_program(), "--config", mine});
  EXPECT_EQ(line_after_notes(edge), "started: in control");
  const std::string in_use = "unit 85 is in use by another program (process ";
  ChildProcess ways[] = {
      ChildProcess({edge_program(), "--config", other}),
      ChildProcess({edge_program(), "--config", other, "--check"}),
      ChildProcess({edge_program(), "--config", other, "--dry-run"}),
      ChildProcess({edge_program(), "release", "--config", other, "--yes"}),
  };  // together: each waits a second for the lock
  for (ChildProcess& second : ways) {
    const std::string text = second.read_all();
    EXPECT_EQ(second.wait(), 1) << text;
    EXPECT_THAT(text, HasSubstr(in_use + std::to_string(edge.pid())));
    EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 1) << text;
  }
  static_cast<void>(line_after_notes(edge));  // undisturbed
  EXPECT_THAT(edge.read_line(), HasSubstr("mode=running"));
  edge.signal(SIGKILL);
  edge.wait();
  ChildProcess successor({edge_program(), "--config", other, "--cycles", "1"});
  EXPECT_THAT(successor.read_all(), HasSubstr("stopped: battery released"));
  EXPECT_EQ(successor.wait(), 0);
}

/// Two batteries, one state folder: the logs would overwrite each other.
TEST_F(Processes, TwoControllersCannotShareAStateFolder) {
  start_simulators();
  ChildProcess edge({edge_program(), "--config", site_.commission()});
  EXPECT_EQ(line_after_notes(edge), "started: in control");
  const auto first_battery = std::move(site_.battery);
  site_.start_battery();
  ChildProcess second({edge_program(), "--config", site_.write_config()});
  EXPECT_THAT(second.read_all(), HasSubstr("/state is in use by another program (process " +
                                           std::to_string(edge.pid())));
  EXPECT_EQ(second.wait(), 1);
}

TEST_F(Processes, StatusAndLogShowWhatTheRunningControllerDoes) {
  start_simulators();
  const std::string config = site_.commission();
  const auto run = [&](std::vector<std::string> arguments, int expected_exit_code) {
    arguments.insert(arguments.begin(), edge_program());
    arguments.insert(arguments.end(), {"--config", config});
    ChildProcess child(arguments);
    std::string text = child.read_all();
    EXPECT_EQ(child.wait(), expected_exit_code) << text;
    return text;
  };
  EXPECT_THAT(run({"status"}, 3), HasSubstr("health     not running"));
  EXPECT_THAT(run({"log"}, 1), HasSubstr("decisions.ring: cannot open the log: No such file"));
  EXPECT_THAT(run({"status", "--prometheus"}, 1), HasSubstr("no metrics here"));
  {
    ChildProcess edge({edge_program(), "--config", config});
    EXPECT_EQ(line_after_notes(edge), "started: in control");
    for (int i = 0; i < 15; ++i) edge.read_line();
    // A loaded machine may be late with a cycle of 133 ms: ok and degraded are both honest here.
    ChildProcess status({edge_program(), "status", "--config", config});
    const std::string text = status.read_all();
    EXPECT_LE(status.wait(), 1) << text;
    EXPECT_THAT(text, HasSubstr("in control, process " + std::to_string(edge.pid())));
    EXPECT_THAT(text, HasSubstr("state      running at 2023-03-26 0"));
    EXPECT_THAT(text, HasSubstr("alphaess, variant block"));
    EXPECT_THAT(text, HasSubstr("EUR/MWh"));
    ChildProcess json({edge_program(), "status", "--json", "--config", config});
    EXPECT_THAT(json.read_all(), HasSubstr("\"health\":"));
    ChildProcess metrics({edge_program(), "status", "--prometheus", "--config", config});
    EXPECT_THAT(metrics.read_all(), ContainsRegex("bess_state[{].*state=\"running\"[}] 1\n"));
    EXPECT_EQ(SimulatedSite::stop(edge), 0);
  }
  EXPECT_THAT(run({"status"}, 3), HasSubstr("was        stopping at "));
  ChildProcess follower({edge_program(), "status", "--follow", "--config", config});
  for (int views = 0; views < 2;) {
    const std::string line = follower.read_line();
    ASSERT_FALSE(line.empty());
    if (line == "health     not running") ++views;
  }
  // The ring and the CSV that the controller wrote besides are the same log, line by line.
  std::ifstream csv(site_.folder.file("edge.csv"));
  EXPECT_EQ(run({"log", "--csv"}, 0), std::string(std::istreambuf_iterator<char>(csv), {}));
  const std::string last = run({"log", "--last", "2"}, 0);
  EXPECT_EQ(std::count(last.begin(), last.end(), '\n'), 2) << last;
  EXPECT_THAT(last, HasSubstr("mode=stopping"));
  const std::vector<CsvRow> rows = read_csv(site_.folder.file("edge.csv"));
  const std::string& middle = rows.at(rows.size() / 2).at("utc");
  EXPECT_THAT(run({"log", "--since", middle}, 0), ::testing::StartsWith("utc=" + middle + " "));
}

/// The status of a program whose student is by level, as it lies on the disk.
TEST_F(Processes, StatusShowsLevelAndClassWhereTheyAreTheContext) {
  const std::string config = site_.write_config();
  std::filesystem::create_directory(site_.folder.file("state"));
  const auto level_line = [&](const std::string& context, int context_class,
                              const std::string& level = "-98304000") {
    static_cast<void>(site_.folder.write(
        "state/status.json",
        "{\"context\": \"" + context + "\", \"last\": {\"price_level_centi_q16\": " + level +
            ", "
            "\"context_class\": " +
            std::to_string(context_class) + "}, \"totals\": {\"cycles\": 7}}\n"));
    ChildProcess status({edge_program(), "status", "--config", config});
    const std::string text = status.read_all();
    EXPECT_EQ(status.wait(), 3) << text;  // nobody runs
    const std::size_t begin = text.find("\nlevel ");
    return begin == std::string::npos
               ? ""
               : text.substr(begin + 1, text.find('\n', begin + 1) - begin - 1);
  };
  EXPECT_EQ(level_line("level", 3), "level      -15.00 EUR/MWh, class 3 of 12");
  EXPECT_EQ(level_line("level", 0), "level      -15.00 EUR/MWh, the student was not asked");
  EXPECT_EQ(level_line("level", 0, "0"), "level      not known");
  EXPECT_EQ(level_line("month", 3), "");
}

/// systemd's end of a service's life: ready, fed every cycle, stopping.
TEST_F(Processes, SystemdIsToldOfStartCyclesAndStop) {
  const std::string name = site_.folder.file("notify");
  const int systemd = socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  ASSERT_LT(name.size(), sizeof address.sun_path);
  name.copy(address.sun_path, name.size());
  ASSERT_EQ(bind(systemd, reinterpret_cast<sockaddr*>(&address), sizeof address), 0);
  start_simulators();
  const std::string config = site_.commission();
  setenv("NOTIFY_SOCKET", name.c_str(), 1);
  ChildProcess edge({edge_program(), "--config", config, "--cycles", "3"});
  unsetenv("NOTIFY_SOCKET");
  edge.read_all();
  EXPECT_EQ(edge.wait(), 0);
  std::vector<std::string> told;
  char text[512];
  for (ssize_t n = 0; (n = recv(systemd, text, sizeof text, MSG_DONTWAIT)) >= 0;) {
    told.emplace_back(text, static_cast<std::size_t>(n));
  }
  close(systemd);
  ASSERT_FALSE(told.empty());
  EXPECT_THAT(told[0], HasSubstr("EXTEND_TIMEOUT_USEC=61000000"));
  // A student by level asks for more time to read the price level's history.
  std::erase_if(told, [](const std::string& t) { return t.starts_with("EXTEND_TIMEOUT_USEC="); });
  ASSERT_EQ(told.size(), 5U);
  EXPECT_THAT(told[0], HasSubstr("READY=1"));
  EXPECT_THAT(told[1],
              HasSubstr("STATUS=running: "));  // its WATCHDOG=1 only if the machine kept up
  EXPECT_THAT(told[4], HasSubstr("STOPPING=1"));
}

TEST_F(Processes, EachCommandHasItsHelp) {
  struct Help {
    std::vector<std::string> arguments;
    const char* says;
  };
  const Help helps[] = {{{edge_program(), "--help"}, "bess-edge --config /etc/bess/edge.toml"},
                        {{edge_program(), "status", "--help"}, "3 not running"},
                        {{edge_program(), "log", "-h"}, "--since MOMENT"},
                        {{edge_program(), "--version"}, ", student "}};
  for (const Help& help : helps) {
    ChildProcess child(help.arguments);
    EXPECT_THAT(child.read_all(), HasSubstr(help.says));
    EXPECT_EQ(child.wait(), 0);
  }
}

TEST_F(Processes, MarketFaultsDoNotStopTheLoop) {
  for (const char* fault : {"null", "http-500", "stale", "garbage", "trailing", "twice"}) {
    site_.start_clock();
    start_simulators({"--fault", fault, "--fault-every", "3"});
    std::filesystem::remove(site_.folder.file("edge.csv"));
    ChildProcess edge({edge_program(), "--config", site_.commission(), "--cycles", "10"});
    edge.read_all();
    EXPECT_EQ(edge.wait(), 0) << fault;
    int running = 0;
    for (const CsvRow& row : read_csv(site_.folder.file("edge.csv"))) {
      if (row.at("mode") == "running") ++running;
    }
    EXPECT_GE(running, 9) << fault;
    EXPECT_EQ(SimulatedSite::stop(*site_.battery), 0);
    EXPECT_EQ(SimulatedSite::stop(*site_.market), 0);
    const std::string end = text_of_file(site_.log_of("market"));
    const std::size_t count = end.find("stopped after ");
    ASSERT_NE(count, std::string::npos) << end;
    EXPECT_GE(std::stoi(end.substr(count + 14)), 2) << fault;
  }
}

/// A minute file of ten hours with one price, from an hour before the start on.
std::string one_price(const char* price) {
  std::string text = "minute_utc,indicative_eur_mwh,settled_eur_mwh\n";
  for (int minute = -60; minute < 540; ++minute) {
    text += utc_text(SimulatedSite::kStartS + 60 * minute).c_str();
    text.append(",").append(price).append(",").append(price).append("\n");
  }
  return text;
}

/// What markets have settled at and where bids end: on the wire, in journal, CSV, ring, status,
/// metrics.
TEST_F(Processes, ExtremePricesAreExactWhereverTheyAreTold) {
  for (const char* const price : {"25907.54", "-25907.54", "99999.00", "-99999.00"}) {
    site_.start_clock();
    site_.start_battery();
    site_.start_market({}, one_price(price));
    std::filesystem::remove_all(site_.folder.file("state"));
    std::filesystem::remove(site_.folder.file("edge.csv"));
    const std::string config = site_.commission();
    const auto said = [&](std::vector<std::string> arguments) {
      arguments.insert(arguments.begin(), edge_program());
      arguments.insert(arguments.end(), {"--config", config});
      ChildProcess child(arguments);
      return child.read_all();
    };
    std::string centi(price);
    centi.erase(centi.find('.'), 1);
    char metric[80];
    std::snprintf(metric, sizeof metric, "\"} %.10g\n", std::stod(price));
    ChildProcess edge({edge_program(), "--config", config});
    EXPECT_THAT(line_with_power(edge), HasSubstr(" price_centi=" + centi + " "));
    EXPECT_THAT(said({"status", "--json"}), HasSubstr(centi + ",\n"));
    const std::string status = said({"status"});
    EXPECT_THAT(status, HasSubstr("price      " + std::string(price) + " EUR/MWh"));
    EXPECT_THAT(status, HasSubstr("WARN: prices: " + std::string(price) + " EUR/MWh lies beyond"));
    EXPECT_THAT(said({"status", "--prometheus"}), HasSubstr(metric));
    EXPECT_EQ(SimulatedSite::stop(edge), 0);
    EXPECT_THAT(said({"log", "--csv"}), HasSubstr("," + centi + ","));
    int trading = 0;
    for (const CsvRow& row : read_csv(site_.folder.file("edge.csv"))) {
      if (row.at("mode") != "running") continue;
      ++trading;
      EXPECT_EQ(row.at("price_centi_eur_per_mwh"), centi);
      EXPECT_EQ(row.at("ordered_power_w"), *price == '-' ? "4000" : "-4000");
    }
    EXPECT_GT(trading, 0);
    EXPECT_EQ(SimulatedSite::stop(*site_.battery), 0);
    EXPECT_EQ(SimulatedSite::stop(*site_.market), 0);
  }
}

TEST_F(Processes, AFrozenPriceIsToldAndEndsTheTrade) {
  site_.start_battery();
  site_.start_market({"--fault", "frozen", "--fault-every", "1"});
  SimulatedSite::ConfigOptions options;
  options.price_keys = "frozen_price_s = 600\n";
  options.guard_keys = "frozen_price_s_max = 1800\n";
  const std::string config = site_.commission(options);
  ChildProcess edge({edge_program(), "--config", config});
  std::string line = edge.read_line();
  while (!line.empty() && line.find("price_frozen=1") == std::string::npos) line = edge.read_line();
  EXPECT_THAT(line, HasSubstr(" mode=running "));
  ChildProcess told({edge_program(), "status", "--config", config});
  EXPECT_THAT(told.read_all(), HasSubstr("WARN: prices: frozen_price, "));
  EXPECT_EQ(told.wait(), 1);
  while (!line.empty() && line.find("reason=frozen_price") == std::string::npos) {
    line = edge.read_line();
  }
  EXPECT_THAT(line, AllOf(HasSubstr(" mode=holding "), HasSubstr(" ordered_power_w=0 ")));
  EXPECT_EQ(SimulatedSite::stop(edge), 0);
}

/// Whatever the bus does, what the log calls written is what the battery was commanded.
TEST_F(Processes, BusFaultsCostCyclesButNeverGiveAWrongOrder) {
  start_simulators({}, {"--fault",
                        "exception",
                        "drop",
                        "reset",
                        "wrong-unit",
                        "wrong-transaction",
                        "wrong-protocol",
                        "wrong-address",
                        "wrong-value",
                        "fewer-registers",
                        "garbage",
                        "duplicate",
                        "refuse",
                        "ack-without-effect",
                        "--fault-probability",
                        "0.15",
                        "--fault-seed",
                        "4",
                        "--fault-from-s",
                        "400"});
  ChildProcess edge({edge_program(), "--config", site_.commission(), "--cycles", "40"});
  edge.read_all();
  EXPECT_EQ(edge.wait(), 0);
  EXPECT_EQ(SimulatedSite::stop(*site_.battery), 0);
  std::map<std::int64_t, std::string> commanded;  // at the end of each minute
  for (const CsvRow& row : read_csv(site_.folder.file("battery.csv"))) {
    commanded[utc_of(row.at("minute_utc"))] = row.at("commanded_power_w");
  }
  int written = 0;
  int troubled = 0;
  for (const CsvRow& row : read_csv(site_.folder.file("edge.csv"))) {
    if (row.at("battery_status") != "ok") ++troubled;
    if (row.at("mode") == "stopping" || row.at("written") != "1") continue;
    ++written;
    bool obeyed = false;  // soon after the tick, on a busy machine a cycle later
    for (int minute = 0; minute < 4; ++minute) {
      obeyed |= commanded[utc_of(row.at("utc")) + 60 * minute] == row.at("ordered_power_w");
    }
    EXPECT_TRUE(obeyed) << row.at("utc") << " " << row.at("ordered_power_w");
  }
  EXPECT_GE(written, 20);
  EXPECT_GE(troubled, 1);
}

TEST_F(Processes, CheckReportsAndReadsButWritesNothing) {
  start_simulators();
  sleep_until_monotonic(site_.anchor_ns());
  ChildProcess early({edge_program(), "--config", site_.write_config(), "--check"});
  EXPECT_THAT(early.read_all(), HasSubstr("the battery's sign has not been checked"));
  EXPECT_EQ(early.wait(), 1);  // as the start would
  ChildProcess edge({edge_program(), "--config", site_.commission(), "--check"});
  const std::string text = edge.read_all();
  EXPECT_EQ(edge.wait(), 0) << text;
  EXPECT_THAT(text, HasSubstr("\ncontext    "));
  EXPECT_THAT(text, HasSubstr("sign       checked"));
  EXPECT_THAT(text, HasSubstr("clock      simulated"));
  EXPECT_THAT(text, HasSubstr("guard      charge at or below -500, discharge at or above 1500 "
                              "EUR/MWh, as the student is proved for\n"));
  EXPECT_THAT(text, HasSubstr("charge     0x0880:[1 0 28000 0 32000 2 255 0 300 255 0]"));
  EXPECT_THAT(text, HasSubstr("SoC 50."));  // the sign check has charged a little
  EXPECT_THAT(text, HasSubstr("dispatch off"));
  EXPECT_THAT(text, HasSubstr("EUR/MWh of minute"));
}

/// The operator's guard and the weights come from two people; where they differ is said, not
/// refused.
TEST_F(Processes, ThresholdsOtherThanTheProvedOnesAreSaidAtStart) {
  start_simulators();
  sleep_until_monotonic(site_.anchor_ns());
  const std::string narrow = site_.commission({.guard_keys = "high_price_eur_per_mwh = 450\n"});
  const std::string warning =
      "bess-edge: note: [guard] high_price_eur_per_mwh = 450, the student is proved for 1500: "
      "between them the guard alone makes it discharge\n";
  ChildProcess check({edge_program(), "--config", narrow, "--check"});
  const std::string checked = check.read_all();
  EXPECT_THAT(checked, HasSubstr(warning));
  EXPECT_THAT(checked, Not(HasSubstr("guard      ")));
  EXPECT_EQ(check.wait(), 0) << checked;
  ChildProcess warned({edge_program(), "--config", narrow, "--cycles", "1"});
  EXPECT_THAT(warned.read_all(), AllOf(HasSubstr("started: in control"), HasSubstr(warning)));
  EXPECT_EQ(warned.wait(), 0);
  ChildProcess agreed({edge_program(), "--config", site_.commission(), "--cycles", "1"});
  EXPECT_THAT(agreed.read_all(),
              HasSubstr("\nguard: charge at or below -500, discharge at or above "
                        "1500 EUR/MWh, as the student is proved for\n"));
  EXPECT_EQ(agreed.wait(), 0);
}

TEST_F(Processes, BadStartsEndWithOneClearLine) {
  site_.battery_port = 2;  // 1 is of another test, beside it
  site_.market_port = 1;
  const std::string config = site_.write_config();
  struct Start {
    std::vector<std::string> arguments;
    int exit_code;
    const char* message;
  };
  const Start starts[] = {
      {{edge_program(), "--config", config}, 1, "battery at 127.0.0.1:2 unit 85: no connection"},
      {{edge_program(), "--config", "/nonexistent"}, 1, "cannot open"},
      {{edge_program(), "--confg", config}, 2, "unknown option --confg"},
      {{edge_program(), "--config", config, "--cycles", "x"}, 2, "needs a whole number"},
      {{edge_program(), "--config", ""}, 2, "--config needs a file, not an empty text"},
      {{edge_program(), "stat"}, 2, "unknown command stat"},
      {{edge_program(), "status", "--csv"}, 2, "unknown option --csv"},
      {{edge_program(), "status", "--json", "--prometheus"}, 2, "exclude each other"},
      {{edge_program(), "log", "--last"}, 2, "a value is missing after --last"},
      {{edge_program(), "log", "--since", "today"}, 2, "needs a moment such as"},
      {{edge_program(), "log", "--config", "/nonexistent"}, 1, "cannot open"},
      {{sim_program(), "batery"}, 2, "unknown subcommand \"batery\""},
      {{sim_program(), "market", "--prices", "/nonexistent"}, 1, "cannot open"},
      {{sim_program(), "battery", "--soc", "2"}, 2, "--soc"},
      {{sim_program(), "battery", "--host", "battery"}, 2, "--host"},
      {{sim_program(), "battery", "--fault", "crc"}, 2, "--fault"},
      {{sim_program(), "battery", "--fault", "bad-crc"}, 1, "bad-crc: only on a serial line"},
      {{sim_program(), "battery", "--serial", "/nonexistent"}, 1, "cannot open this serial"},
  };
  for (const Start& start : starts) {
    ChildProcess child(start.arguments);
    const std::string text = child.read_all();
    EXPECT_EQ(child.wait(), start.exit_code) << text;
    EXPECT_THAT(text, HasSubstr(start.message));
    EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 1) << text;
  }
}

TEST_F(Processes, BrokenTomlEndsWithOneClearLine) {
  for (const TomlMistake& mistake : toml_mistakes()) {
    SCOPED_TRACE(mistake.text.substr(0, 40));
    const std::string broken = site_.folder.write("broken.toml", mistake.text);
    const std::string config = site_.folder.write(
        "edge.toml", "[battery]\nmap = \"broken.toml\"\n[price]\nurl = \"http://a\"\n");
    const std::vector<std::string> starts[] = {{edge_program(), "--check", "--config", broken},
                                               {edge_program(), "--check", "--config", config},
                                               {sim_program(), "battery", "--map", broken}};
    for (const std::vector<std::string>& start : starts) {
      ChildProcess child(start);
      const std::string text = child.read_all();
      EXPECT_EQ(child.wait(), 1) << text;
      EXPECT_THAT(text,
                  HasSubstr("broken.toml:" + std::to_string(mistake.line) + ": not valid TOML: "));
      EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 1) << text;
    }
  }
}

TEST_F(Processes, WithoutAConfigurationTheInstalledOneIsMeant) {
  if (access("/etc/bess/edge.toml", R_OK) == 0) GTEST_SKIP() << "bess-edge is installed here";
  for (const char* command : {"status", "log", "run"}) {
    ChildProcess child({edge_program(), command});
    EXPECT_THAT(child.read_all(),
                HasSubstr("--config FILE is required, there is no /etc/bess/edge.toml"));
    EXPECT_EQ(child.wait(), 2);
  }
}

TEST_F(Processes, ABatteryWhoseSignWasNeverCheckedIsNotControlled) {
  start_simulators();
  const std::string config = site_.write_config();
  ChildProcess edge({edge_program(), "--config", config});
  EXPECT_THAT(edge.read_all(), HasSubstr("run once: bess-edge commission --config FILE --yes"));
  EXPECT_EQ(edge.wait(), 1);
  ChildProcess hesitant({edge_program(), "commission", "--config", config});
  EXPECT_THAT(hesitant.read_all(), HasSubstr("to charge and to discharge 500 W for 30 s each"));
  EXPECT_EQ(hesitant.wait(), 2);
  ChildProcess reader({edge_program(), "--config", config, "--dry-run", "--cycles", "1"});
  const std::string read_only = reader.read_all();
  EXPECT_THAT(read_only, HasSubstr("started: read-only"));
  EXPECT_THAT(read_only, HasSubstr("stopped: read-only, nothing was written"));
  EXPECT_EQ(reader.wait(), 0);
  EXPECT_EQ(SimulatedSite::stop(*site_.battery), 0);
  for (const CsvRow& row : read_csv(site_.folder.file("battery.csv"))) {
    EXPECT_EQ(row.at("commanded_power_w"), "0");
  }
}

TEST_F(Processes, ARefusedStartLeavesTheStatusOfTheRunBefore) {
  start_simulators();
  const std::string config = site_.commission();
  ChildProcess({edge_program(), "--config", config, "--cycles", "2"}).wait();
  const auto status = [&] {
    std::ifstream file(site_.folder.file("state/status.json"));
    return std::string(std::istreambuf_iterator<char>(file), {});
  };
  const std::string before = status();
  ASSERT_THAT(before, HasSubstr("\"reason\": \"stop_requested\""));
  for (const char* name : {"state/commissioned.toml", "state/commissioned.copy"}) {
    std::filesystem::remove(site_.folder.file(name));
  }
  ChildProcess refused({edge_program(), "--config", config});
  EXPECT_EQ(refused.wait(), 1);
  EXPECT_EQ(status(), before);
}

/// As for an upgrade: SIGHUP, and a new process goes on where the old one was. Slower than the
/// others, so that the order outlasts the start of a process.
TEST_F(Processes, AHandOverKeepsThePowerAndARestartGoesOn) {
  SimulatedSite site(outlasting_scale());
  site.start_battery();
  site.start_market();
  const std::string config = site.commission();
  const ChildProcess prices({BESS_PRICES_PROGRAM, "--config", config});  // it outlasts the change
  ChildProcess before({edge_program(), "--config", config});
  ASSERT_THAT(line_with_power(before), HasSubstr("mode=running"));
  before.signal(SIGHUP);
  EXPECT_THAT(before.read_all(), HasSubstr("stopped: handed over, the order stays in force"));
  EXPECT_EQ(before.wait(), 0);
  ChildProcess after({edge_program(), "--config", config, "--cycles", "3"});
  EXPECT_THAT(after.read_all(), HasSubstr("stopped: battery released"));
  EXPECT_EQ(after.wait(), 0);
  int first_cycles = 0;
  for (const CsvRow& row : read_csv(site.folder.file("edge.csv"))) {
    EXPECT_NE(row.at("mode"), "holding") << row.at("utc");
    if (row.at("mode") != "running" || row.at("cycle") != "1" || ++first_cycles != 2) continue;
    EXPECT_NE(row.at("battery_power_w"), "0") << "the order did not outlast the change";
  }
  EXPECT_EQ(first_cycles, 2);
}

/// A killed controller's order, ended by hand before its watchdog does; as slow as the one above.
TEST_F(Processes, ReleaseEndsAnOrderThatNobodyEndsAnyMore) {
  SimulatedSite site(outlasting_scale());
  site.start_battery();
  site.start_market();
  const std::string config = site.commission();
  ChildProcess edge({edge_program(), "--config", config});
  const std::string order = line_with_power(edge);
  ASSERT_THAT(order, ::testing::StartsWith("utc="));
  edge.signal(SIGKILL);
  edge.wait();
  ChildProcess hesitant({edge_program(), "release", "--config", config});
  EXPECT_THAT(hesitant.read_all(), HasSubstr("add --yes"));
  EXPECT_EQ(hesitant.wait(), 2);
  ChildProcess release({edge_program(), "release", "--config", config, "--yes"});
  EXPECT_THAT(release.read_all(), HasSubstr("is in its own mode"));
  EXPECT_EQ(release.wait(), 0);
  const std::int64_t ordered_utc_s = utc_of(order.substr(4, order.find(' ') - 4));
  sleep_until_monotonic(clock_ns(CLOCK_MONOTONIC) + kNanosecondsPerSecond / 3);  // 100 s
  EXPECT_EQ(SimulatedSite::stop(*site.battery), 0);
  bool ended_by_hand = false;  // the watchdog would have after 300 s
  for (const CsvRow& row : read_csv(site.folder.file("battery.csv"))) {
    const std::int64_t age_s = utc_of(row.at("minute_utc")) - ordered_utc_s;
    ended_by_hand |= age_s > 0 && age_s < 240 && row.at("commanded_power_w") == "0";
  }
  EXPECT_TRUE(ended_by_hand);
}

TEST_F(Processes, TheWrongBatteryIsRefusedBeforeAnythingIsWritten) {
  site_.start_battery({"--capacity-wh", "12000"});
  site_.market_port = 1;
  ChildProcess edge({edge_program(), "--config", site_.write_config()});
  EXPECT_THAT(edge.read_all(), AllOf(HasSubstr("capacity (register 281"), HasSubstr("12000")));
  EXPECT_EQ(edge.wait(), 1);
}

/// An independent master sees the registers that the edge's commands stand for.
TEST_F(Processes, MbpollReadsWhatTheMapSays) {
  if (access("/usr/bin/mbpoll", X_OK) != 0) GTEST_SKIP() << "mbpoll is not installed";
  start_simulators();
  const std::string port = std::to_string(site_.battery_port);
  const auto mbpoll = [&](std::vector<std::string> rest) {
    std::vector<std::string> arguments = {
        "/usr/bin/mbpoll", "-m", "tcp", "-p", port, "-a", "85", "-0", "-t", "4"};
    arguments.insert(arguments.end(), rest.begin(), rest.end());
    ChildProcess child(arguments);
    return child.read_all();
  };
  EXPECT_THAT(mbpoll({"-r", "258", "-c", "1", "-1", "127.0.0.1"}), HasSubstr("[258]: \t500"));
  EXPECT_THAT(mbpoll({"-r", "2176", "127.0.0.1", "1", "0", "28000", "0", "32000", "2", "250", "0",
                      "300", "255", "0"}),
              HasSubstr("Written 11 references"));
  EXPECT_THAT(mbpoll({"-r", "294", "-c", "1", "-1", "127.0.0.1"}), HasSubstr("(-4000)"));
  EXPECT_THAT(mbpoll({"-r", "60000", "-c", "1", "-1", "127.0.0.1"}),
              HasSubstr("Illegal data address"));
}

}  // namespace
}  // namespace bess
