// Parts of the notifier: settings and their mistakes, a child program, faults in a status, the
// alert command, topics, stored state.
#include <gmock/gmock.h>
#include <signal.h>
#include <sys/stat.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "edge/companions/notify/controller_status.h"
#include "edge/companions/notify/notifier_state.h"
#include "edge/companions/notify/notify_settings.h"
#include "edge/companions/notify/topics.h"
#include "edge/records/log/health.h"
#include "shared/host/run_program.h"
#include "shared/local_time.h"
#include "tests/support/golden_file.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/tokens.h"

namespace bess {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

std::string write_secret(const TemporaryFolder& folder, const char* name, const char* text,
                         mode_t mode = 0600) {
  const std::string path = folder.write(name, text);
  EXPECT_EQ(chmod(path.c_str(), mode), 0);
  return path;
}

NotifySettings loaded_settings(const std::string& path) {
  NotifySettings settings;
  std::string error;
  EXPECT_TRUE(load_notify_settings(path, settings, error)) << error;
  return settings;
}

TEST(NotifySettings, WithoutASectionThereIsNoChannel) {
  const TemporaryFolder folder;
  const NotifySettings settings = loaded_settings(folder.write("edge.toml", "control = true\n"));
  EXPECT_FALSE(settings.has_channel());
  EXPECT_EQ(settings.state_folder, folder.file("state"));
  EXPECT_THAT(settings.memories, ElementsAre(folder.file("notify/told.json")));
  EXPECT_EQ(settings.settled_file, "");
  EXPECT_FALSE(settings.name.empty());
  EXPECT_EQ(std::filesystem::path(settings.program).filename(), "bess-edge");
}

TEST(NotifySettings, TheInstalledFolderHasItsPlaceInMemory) {
  const TemporaryFolder folder;
  const NotifySettings settings =
      loaded_settings(folder.write("edge.toml", "[notify]\nfolder = \"/var/lib/bess-notify\"\n"));
  EXPECT_THAT(settings.memories,
              ElementsAre("/var/lib/bess-notify/told.json", "/run/bess-notify/told.json"));
}

TEST(NotifySettings, TheDocumentedExampleIsValid) {
  loaded_settings(BESS_SOURCE_DIR "/edge/bess-edge.toml");
}

TEST(NotifySettings, ReadsEveryKey) {
  const TemporaryFolder folder;
  write_secret(folder, "password", "open sesame\n");
  const NotifySettings settings = loaded_settings(
      folder.write("edge.toml",
                   "[state]\nfolder = \"/var/lib/bess\"\n[battery]\nname = \"garage-1\"\n"
                   "[settled]\nurl = \"https://example.org/\"\n[notify]\n"
                   "every_s = 10\nafter_s = 60\ndaily = false\nfolder = \"memory\"\n"
                   "run_folder = \"run\"\n"
                   "program = \"/opt/bess-edge\"\ncommand = 'apprise -b \"$BESS_TEXT\" x://'\n"
                   "mqtt_host = \"127.0.0.1\"\nmqtt_port = 1884\nmqtt_user = \"u\"\n"
                   "mqtt_password_file = \"password\"\n"));
  EXPECT_TRUE(settings.has_channel());
  EXPECT_EQ(settings.settled_file, "/var/lib/bess/settled.csv");
  EXPECT_THAT(settings.memories,
              ElementsAre(folder.file("memory/told.json"), folder.file("run/told.json")));
  EXPECT_EQ(settings.name, "garage-1");
  EXPECT_EQ(settings.every_s, 10);
  EXPECT_EQ(settings.after_s, 60);
  EXPECT_FALSE(settings.daily);
  EXPECT_EQ(settings.command, "apprise -b \"$BESS_TEXT\" x://");
  EXPECT_EQ(settings.mqtt.port, 1'884);
  EXPECT_EQ(settings.mqtt.password, "open sesame");
}

TEST(NotifySettings, APasswordIsTheFirstLineOfItsFile) {
  const TemporaryFolder folder;
  const std::string keys =
      "[notify]\nmqtt_host = \"localhost\"\nmqtt_user = \"u\"\n"
      "mqtt_password_file = \"password\"\n";
  const std::string longest(255, 'p');
  const std::pair<std::string, std::string> files[] = {
      {"secret", "secret"},      {"secret\r\nmore\n", "secret"},
      {longest + "\n", longest}, {longest + "p\n", ""},
      {"\nsecret\n", ""},        {"", ""}};
  for (const auto& [text, password] : files) {
    write_secret(folder, "password", text.c_str());
    NotifySettings settings;
    std::string error;
    EXPECT_EQ(load_notify_settings(folder.write("edge.toml", keys), settings, error),
              !password.empty())
        << text.size() << error;
    if (error.empty()) {
      EXPECT_EQ(settings.mqtt.password, password);
    }
  }
}

/// A notifier of an earlier version's configuration still starts.
TEST(NotifySettings, KeysThatWereRemovedAreTaken) {
  const TemporaryFolder folder;
  NotifySettings settings;
  std::string error;
  EXPECT_TRUE(load_notify_settings(
      folder.write("edge.toml",
                   "[notify]\nnode = \"house\"\nmail_to = \"me@example.org\"\n"
                   "webhook_url = \"https://example.org\"\ncommand = \"true\"\n"),
      settings, error))
      << error;
  EXPECT_EQ(settings.command, "true");
}

TEST(NotifySettings, EveryMistakeIsOneClearLine) {
  const TemporaryFolder folder;
  write_secret(folder, "password", "x\n");
  write_secret(folder, "open", "x\n", 0644);
  const std::pair<const char*, const char*> mistakes[] = {
      {"nod = \"x\"", "nod"},
      {"every_s = 0", "every_s 1 3600"},
      {"after_s = -1", "after_s 0 86400"},
      {"mqtt_host = \"a\"\nmqtt_port = 0", "mqtt_port 1 65535"},
      {"mqtt_host = \"a\"\nmqtt_ca_file = \"none.pem\"", "none.pem"},
      {"mqtt_host = \"10.0.0.1\"\nmqtt_orders = true", "mqtt_orders mqtt_user"},
      {"mqtt_host = \"a\"\nmqtt_password_file = \"password\"", "mqtt_user"},
      {"mqtt_host = \"a\"\nmqtt_user = \"u\"\nmqtt_password_file = \"password\"", "mqtt_ca_file"},
      {"mqtt_host = \"127.0.0.1\"\nmqtt_user = \"u\"\nmqtt_password_file = \"open\"",
       "open chmod o-rwx"},
      {"mqtt_host = \"127.0.0.1\"\nmqtt_user = \"u\"\nmqtt_password_file = \"none\"", "none"},
  };
  for (const auto& [keys, codes] : mistakes) {
    const std::string path = folder.write("edge.toml", std::string("[notify]\n") + keys + "\n");
    NotifySettings settings;
    std::string error;
    EXPECT_FALSE(load_notify_settings(path, settings, error)) << keys;
    EXPECT_THAT(error, Names(codes));
    EXPECT_EQ(error.find('\n'), std::string::npos) << error;
  }
}

TEST(ChildProgram, GivesItsOutputAndExitCode) {
  signal(SIGPIPE, SIG_IGN);
  const ProgramResult result = run_program({"/bin/sh", "-c", "cat; exit 3"}, "said", 10'000);
  EXPECT_EQ(result.trouble, "");
  EXPECT_EQ(result.output, "said");
  EXPECT_EQ(result.exit_code, 3);
  const std::string long_text(300'000, 'x');
  EXPECT_EQ(run_program({"/bin/cat"}, long_text, 10'000).output, long_text);
  EXPECT_EQ(run_program({"/bin/true"}, long_text, 10'000).exit_code, 0);  // does not read
}

TEST(ChildProgram, WhatDoesNotEndIsKilledWithItsChildren) {
  const ProgramResult result = run_program({"/bin/sh", "-c", "sleep 1000 & sleep 1000"}, "", 100);
  EXPECT_NE(result.trouble, "");
  EXPECT_NE(run_program({"/bin/sh", "-c", "exec >&-; sleep 1000"}, "", 100).trouble, "");
  EXPECT_NE(run_program({"/usr/bin/yes"}, "", 60'000).trouble, "");
  EXPECT_THAT(run_program({"/no/such"}, "", 100).trouble,
              ::testing::AllOf(Names("/no/such"), HasSubstr(std::strerror(ENOENT))));
}

TEST(ChildProgram, IsReadWithItsErrors) {
  const ProgramResult result =
      run_and_capture({"sh", "-c", "echo said; echo first >&2; echo last >&2; exit 7"}, 10);
  EXPECT_EQ(result.output, "said\n");
  EXPECT_EQ(result.errors, "first\nlast\n");
  EXPECT_EQ(result.exit_code, 7);
  EXPECT_FALSE(result.is_well());
  EXPECT_EQ(result.complaint(), "last");
  EXPECT_TRUE(run_and_capture({"true"}, 10).is_well());
  EXPECT_EQ(run_and_capture({"sh", "-c", "kill -9 $$"}, 10).exit_code, 128 + 9);
  // It closes its output and continues, but not beyond its time limit.
  EXPECT_NE(run_and_capture({"sh", "-c", "exec >&- 2>&-; sleep 1000"}, 1).trouble, "");
}

ControllerStatus ask(const std::string& program) {
  ControllerPlaces controller;
  controller.program = program;
  return ask_controller(controller);
}

std::vector<std::string> keys_of(const ControllerStatus& status) {
  std::vector<std::string> keys;
  for (const SeenAlert& trouble : seen_alerts(status)) keys.push_back(trouble.key);
  return keys;
}

TEST(ControllerStatus, EachAlertIsATroubleWithItsCode) {
  const TemporaryFolder folder;
  const std::string program = folder.write_script(
      "program", R"(echo '{"health": "degraded", "alerts": [{"code": "overdue", "line": "601 s"}, )"
                 R"({"code": "of_next_year", "line": "new"}]}'; exit 1)");
  const ControllerStatus status = ask(program);
  EXPECT_EQ(status.trouble, "");
  EXPECT_THAT(keys_of(status), ElementsAre("overdue", "of_next_year"));
}

/// From the first failed answer to the resulting safe mode.
TEST(ControllerStatus, AnOutageIsOneTrouble) {
  const auto codes_at = [](Mode mode, Reason reason, bool battery_fails) {
    RunStatus run;
    run.totals.cycles = 9;
    CycleRecord& last = run.totals.last;
    last.mode = mode;
    last.reason = reason;
    last.battery_status = battery_fails ? Status::kTimeout : Status::kOk;
    last.price.status = battery_fails ? Status::kOk : Status::kHttpError;
    const HealthInputs in{.is_running = true, .status = &run, .is_of_this_run = true};
    std::vector<std::string> codes;
    for (const HealthAlert& alert : assess_health(in).alerts) codes.emplace_back(alert.code);
    return codes;
  };
  EXPECT_THAT(codes_at(Mode::kRunning, Reason::kStudent, false), ElementsAre("prices"));
  for (const Reason reason : {Reason::kNoPrice, Reason::kPriceAge, Reason::kPriceQuarterHour}) {
    EXPECT_THAT(codes_at(Mode::kSafe, reason, false), ElementsAre("prices")) << reason_name(reason);
  }
  EXPECT_THAT(codes_at(Mode::kRunning, Reason::kStudent, true), ElementsAre("battery"));
  EXPECT_THAT(codes_at(Mode::kHolding, Reason::kLink, true), ElementsAre("battery"));
  EXPECT_THAT(codes_at(Mode::kSafe, Reason::kLink, true), ElementsAre("battery"));
}

TEST(ControllerStatus, ASickAnswerIsATroubleOfItsOwn) {
  const TemporaryFolder folder;
  EXPECT_THAT(keys_of(ask("/no/such")), ElementsAre("no_status"));
  for (const char* body : {"exit 1", "echo nonsense", "echo '{}'", "echo '[1]'"}) {
    EXPECT_THAT(keys_of(ask(folder.write_script("program", body))), ElementsAre("no_status"))
        << body;
  }
  ControllerStatus well;
  well.json.set("health", "ok");
  EXPECT_TRUE(seen_alerts(well).empty());
}

const Message kAlert{.severity = "alarm",
                     .key = "battery",
                     .text = "WARN: mode is safe, reason link\nBcc: evil@example.org",
                     .utc_s = 1'679'875'320,
                     .since_utc_s = 1'679'875'020};

class AlertCommand : public ::testing::Test {
 protected:
  AlertCommand() { signal(SIGPIPE, SIG_IGN); }  // as the program does: not all read their input
  std::string run(const std::string& command) {
    settings_.command = command;
    return run_alert_command(settings_, kAlert);
  }
  [[nodiscard]] std::string said() const { return text_of_file(folder_.file("said")); }
  const TemporaryFolder folder_;
  NotifySettings settings_ = [] {
    NotifySettings settings;
    settings.name = "garage";
    settings.contact = "Ann, +32 2 555 01 23";
    settings.command_ms_max = 10'000;
    return settings;
  }();
};

TEST_F(AlertCommand, IsGivenSeverityTitleAndTextInItsEnvironmentAndItsInput) {
  set_market_time_zone();
  EXPECT_EQ(run("{ echo \"$BESS_SEVERITY|$BESS_TITLE|$BESS_NODE|$BESS_KEY|$BESS_UTC\"; "
                "cat; } >" +
                folder_.file("said")),
            "");
  EXPECT_THAT(said(), ::testing::StartsWith("alarm|[bess garage] "));
  EXPECT_THAT(said(), HasSubstr("|garage|battery|2023-03-27T00:02:00Z\n"));
  EXPECT_THAT(said(), Names("2023-03-27 01:57"));
  EXPECT_THAT(said(), HasSubstr("Ann, +32 2 555 01 23"));
}

TEST_F(AlertCommand, NothingInATextIsReadByTheShell) {
  Message evil = kAlert;
  evil.text = "'; touch " + folder_.file("owned") + "; $(touch " + folder_.file("owned") + ") `id`";
  settings_.command = "echo \"$BESS_TEXT\" >" + folder_.file("said");
  EXPECT_EQ(run_alert_command(settings_, evil), "");
  EXPECT_THAT(said(), HasSubstr("$(touch "));
  EXPECT_FALSE(std::filesystem::exists(folder_.file("owned")));
}

TEST_F(AlertCommand, ThatFailsHangsOrIsMissingIsReported) {
  EXPECT_THAT(run("exit 3"), Names("3"));
  EXPECT_THAT(run("/no/such/program"), Names("127"));
  settings_.command_ms_max = 200;
  EXPECT_NE(run("sleep 1000"), "");
}

ControllerStatus sample_status(const std::string& health = "degraded") {
  ControllerStatus status;
  status.json = Json::parse(R"({"health": ")" + health +
                            R"(", "control": true, "last": {"utc": "2023-03-27T00:02:00Z",
          "mode": "running", "reason": "held", "has_measurement": true, "soc_e4": 4235,
          "battery_power_w": -1990, "ordered_power_w": -2000, "has_price": true,
          "price_centi_eur_per_mwh": -16318, "held": true, "hold_power_w": -2000,
          "hold_until_utc": "2023-03-27T02:00:00Z", "reserve_soc_e4": 1500, "days_since_full": 6},
          "next": {"reason": "held", "ends": "until 04:00", "margins": {
          "charge_up_to_eur_per_mwh": 83.49, "discharge_from_eur_per_mwh": 211.5}},
          "totals": {"soc_moved_e4_today": 5000}})");
  return status;
}

/// As `bess-edge earned 2023-11-26 --json` has it, in part.
constexpr const char* kEarned = R"({"days": [{"date": "2023-11-26",
    "start_utc": "2023-11-25T23:00:00Z", "line": "2023-11-26: ...", "earned_eur": 1.2345,
    "charged_kwh": 12.345, "discharged_kwh": 10.5, "full_cycles": 1.25, "cycles": 720,
    "interventions": 3}]})";

/// Topics are an interface: a difference breaks users' configurations.
TEST(Topics, AreTheseToTheLetter) {
  NotifySettings settings;
  settings.name = "garage";
  settings.id = "0a1b2c3d";
  settings.mqtt.orders = true;
  const Json earned = Json::parse(kEarned);
  const std::vector<ToldAlert> alerts = {
      {.key = "k", .text = "t", .since_utc_s = 0, .is_told = true}, {.key = "not reported yet"}};
  std::string text =
      "# generator notify_test, no seed, command: BESS_UPDATE_GOLDEN=1 notify_test "
      "--gtest_filter=Topics.*\n";
  const auto add = [&](const std::string& name, const std::string& payload) {
    text.append(name).append(" ").append(payload).append("\n");
  };
  const std::string state = topic("garage", "state");
  add(state, state_json(sample_status(), alerts, earned.value(), -1'500));
  add(state, state_json({.trouble = "x"}, {}, JsonValue(), std::nullopt));
  add(state, state_json(sample_status("not running"), alerts, earned.value(), std::nullopt));
  add(topic("garage", "alarms"), alerts_json(alerts));
  add(topic("garage", "day"), day_json(earned.value()));
  add(topic("garage", "event"), event_json("garage", kAlert).line());
  add(discovery_topic(settings), discovery_json(settings, "1.2.3"));
  expect_golden(BESS_SOURCE_DIR "/tests/data/golden/mqtt_topics.txt", text);
}

TEST(Topics, NothingCanBeOrderedWithoutTheKey) {
  NotifySettings settings;
  const Json discovery = Json::parse(discovery_json(settings, "1"));
  std::size_t entities = 0;
  for (const JsonValue entity : discovery.value()["components"]) {
    ++entities;
    EXPECT_FALSE(entity["command_topic"].exists()) << entity.key();
  }
  EXPECT_EQ(entities, 20U);
}

class NotifierStateFile : public ::testing::Test {
 protected:
  NotifierState read() {
    losses_.clear();
    return read_notifier_state(paths_, losses_);
  }
  void keep(std::uint64_t number) {
    text_ = notifier_state_text({.number = number, .day = std::to_string(number)});
    ASSERT_EQ(write_notifier_state(paths_, text_), "");
  }
  void keep_fails(const std::vector<std::string>& paths, const std::string& where) const {
    EXPECT_THAT(write_notifier_state(paths, text_), Names(paths[0] + " " + where));
  }
  void expect_known(const std::string& day, std::size_t losses) {
    EXPECT_EQ(read().day, day);
    EXPECT_EQ(losses_.size(), losses);
  }

  const TemporaryFolder folder_;
  const std::vector<std::string> paths_ = {folder_.file("disk/told.json"),
                                           folder_.file("memory/told.json")};
  std::string text_;
  std::vector<std::string> losses_;
};

TEST_F(NotifierStateFile, OutlastsARestart) {
  const NotifierState state{
      .number = 7,
      .day = "2023-11-26",
      .alerts = {{.key = "k", .text = "t", .since_utc_s = 60, .seen_utc_s = 120, .is_told = true},
                 {.key = "new"}},
      .pending = {kAlert, {.severity = "day", .key = "2023-11-25", .text = "d", .utc_s = 9}}};
  ASSERT_EQ(write_notifier_state(paths_, notifier_state_text(state)), "");
  EXPECT_EQ(notifier_state_text(read()), notifier_state_text(state));
}

TEST_F(NotifierStateFile, TheNewestCounts) {
  expect_known("", 0);
  keep(7);
  expect_known("7", 0);
  for (const std::string& path : paths_) {
    ASSERT_EQ(write_notifier_state({path}, notifier_state_text({.number = 8, .day = "8"})), "");
    expect_known("8", 0);
    keep(7);
  }
  std::filesystem::remove_all(folder_.file("memory"));
  expect_known("7", 0);  // a boot
}

TEST_F(NotifierStateFile, AnyFlippedByteIsSeenAndCostsNothing) {
  keep(7);
  for (const std::string& path : paths_) {
    for (std::size_t i = 0; i < text_.size(); i += 3) {
      std::string flipped = text_;
      flipped[i] = static_cast<char>(flipped[i] ^ (1 << i % 8));
      std::ofstream(path, std::ios::binary) << flipped;
      ASSERT_EQ(read().day, "7") << i;
      // A flip in the words around the checksum removes it: the contents are unchanged.
      EXPECT_TRUE(!losses_.empty() || i >= text_.rfind(",\n")) << i;
    }
    std::ofstream(path) << text_;
  }
}

TEST_F(NotifierStateFile, WhatIsLostIsNamedAndAllLostIsSaid) {
  keep(7);
  std::filesystem::remove(paths_[0]);
  std::filesystem::create_directory(paths_[0]);
  expect_known("7", 1);
  EXPECT_THAT(losses_[0], HasSubstr(paths_[0]));
  for (const std::string& text :
       {text_.substr(0, text_.size() / 2), std::string(), std::string("x"), std::string("{}"),
        std::string(R"({"version": 2, "day": "8"})")}) {
    std::ofstream(paths_[1]) << text;
    expect_known("", 3);
    EXPECT_THAT(losses_[1], HasSubstr(paths_[1]));
    EXPECT_EQ(losses_[2].find(folder_.file("")), std::string::npos) << "of both";
  }
}

TEST_F(NotifierStateFile, WhereOnePlaceRefusesTheOtherKeepsItAndThatIsSaid) {
  keep(7);
  std::filesystem::remove(paths_[0]);
  std::filesystem::create_directory(paths_[0]);
  keep_fails(paths_, paths_[1]);
  keep_fails({"/proc/nowhere/told.json"}, "");
}

}  // namespace
}  // namespace bess
