// The notifier's parts: settings and their mistakes, a child program, troubles of a status, the
// alarm command, topics, what is kept over restarts.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/stat.h>

#include <filesystem>
#include <fstream>

#include "edge/log/health.h"
#include "edge/notify/alarm_command.h"
#include "edge/notify/controller_status.h"
#include "edge/notify/notifier_state.h"
#include "edge/notify/notify_settings.h"
#include "edge/notify/topics.h"
#include "shared/host/run_program.h"
#include "shared/local_time.h"
#include "tests/support/golden_file.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test_server.h"

namespace bess {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

std::string write_secret(const TemporaryFolder& folder, const char* name, const char* text,
                         mode_t mode = 0600) {
  const std::string path = folder.write(name, text);
  EXPECT_EQ(chmod(path.c_str(), mode), 0);
  return path;
}

TEST(NotifySettings, WithoutASectionThereIsNoWay) {
  const TemporaryFolder folder;
  NotifySettings settings;
  std::string error;
  ASSERT_TRUE(load_notify_settings(folder.write("edge.toml", "control = true\n"), settings, error))
      << error;
  EXPECT_FALSE(settings.has_channel());
  EXPECT_EQ(settings.ring, folder.file("state/decisions.ring"));
  EXPECT_EQ(settings.memory, folder.file("notify/told.json"));
  EXPECT_FALSE(settings.name.empty());
  EXPECT_EQ(std::filesystem::path(settings.program).filename(), "bess-edge");
}

TEST(NotifySettings, TheInstalledFolderHasItsPlaceInMemory) {
  const TemporaryFolder folder;
  NotifySettings settings;
  std::string error;
  ASSERT_TRUE(load_notify_settings(
      folder.write("edge.toml", "[notify]\nfolder = \"/var/lib/bess-notify\"\n"), settings, error))
      << error;
  EXPECT_THAT(settings.memory_copies, ::testing::ElementsAre("/var/lib/bess-notify/told.copy",
                                                             "/run/bess-notify/told.json"));
  EXPECT_EQ(settings.run_ring, "") << "none: [state] folder is not the installed one";
}

TEST(NotifySettings, TheDocumentedExampleIsValid) {
  NotifySettings settings;
  std::string error;
  EXPECT_TRUE(load_notify_settings(BESS_SOURCE_DIR "/edge/bess-edge.toml", settings, error))
      << error;
}

TEST(NotifySettings, ReadsEveryKey) {
  const TemporaryFolder folder;
  write_secret(folder, "password", "open sesame\n");
  NotifySettings settings;
  std::string error;
  ASSERT_TRUE(load_notify_settings(
      folder.write("edge.toml",
                   "[state]\nfolder = \"/var/lib/bess\"\n[battery]\nname = \"garage-1\"\n[notify]\n"
                   "every_s = 10\nafter_s = 60\ndaily = false\nfolder = \"memory\"\n"
                   "run_folder = \"run\"\n"
                   "program = \"/opt/bess-edge\"\ncommand = 'apprise -b \"$BESS_TEXT\" x://'\n"
                   "mqtt_host = \"127.0.0.1\"\nmqtt_port = 1884\nmqtt_user = \"u\"\n"
                   "mqtt_password_file = \"password\"\nmqtt_discovery_prefix = \"ha\"\n"),
      settings, error))
      << error;
  EXPECT_TRUE(settings.has_channel());
  EXPECT_EQ(settings.ring, "/var/lib/bess/decisions.ring");
  EXPECT_EQ(settings.run_ring, "/run/bess/decisions.ring") << "as the controller has it";
  EXPECT_EQ(settings.memory, folder.file("memory/told.json"));
  EXPECT_THAT(settings.memory_copies, ::testing::ElementsAre(folder.file("memory/told.copy"),
                                                             folder.file("run/told.json")));
  EXPECT_EQ(settings.name, "garage-1");
  EXPECT_EQ(settings.every_s, 10);
  EXPECT_EQ(settings.after_s, 60);
  EXPECT_FALSE(settings.daily);
  EXPECT_EQ(settings.command, "apprise -b \"$BESS_TEXT\" x://");
  EXPECT_EQ(settings.mqtt.port, 1'884);
  EXPECT_EQ(settings.mqtt.password, "open sesame");
  EXPECT_EQ(settings.mqtt.discovery_prefix, "ha");
}

TEST(NotifySettings, EveryMistakeIsOneClearLine) {
  const TemporaryFolder folder;
  write_secret(folder, "password", "x\n");
  write_secret(folder, "open", "x\n", 0644);
  const std::pair<const char*, const char*> mistakes[] = {
      {"nod = \"x\"", "nod is not a known key"},
      {"node = \"a\"", "node is not a known key"},
      {"every_s = 0", "every_s must lie between 1 and 3600"},
      {"after_s = -1", "after_s must lie between 0 and 86400"},
      {"mail_to = \"a@b\"\nsendmail = \"/bin/true\"", "mail_to is of earlier versions"},
      {"webhook_url = \"https://example.org/\"", "webhook_url is of earlier versions"},
      {"mqtt_host = \"a\"\nmqtt_port = 0", "mqtt_port must lie between 1 and 65535"},
      {"mqtt_host = \"a\"\nmqtt_ca_file = \"none.pem\"", "none.pem cannot be read"},
      {"mqtt_host = \"a\"\nmqtt_password_file = \"password\"", "needs mqtt_user"},
      {"mqtt_host = \"a\"\nmqtt_user = \"u\"\nmqtt_password_file = \"password\"",
       "would be sent in clear"},
      {"mqtt_host = \"127.0.0.1\"\nmqtt_user = \"u\"\nmqtt_password_file = \"open\"",
       "is readable for others: chmod o-rwx"},
      {"mqtt_host = \"127.0.0.1\"\nmqtt_user = \"u\"\nmqtt_password_file = \"none\"",
       "none cannot be opened"},
  };
  for (const auto& [keys, message] : mistakes) {
    const std::string path = folder.write("edge.toml", std::string("[notify]\n") + keys + "\n");
    NotifySettings settings;
    std::string error;
    EXPECT_FALSE(load_notify_settings(path, settings, error)) << keys;
    EXPECT_THAT(error, HasSubstr(message));
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
  EXPECT_THAT(result.trouble, HasSubstr("did not end in time"));
  EXPECT_THAT(run_program({"/bin/sh", "-c", "exec >&-; sleep 1000"}, "", 100).trouble,
              HasSubstr("did not end in time"));
  EXPECT_THAT(run_program({"/usr/bin/yes"}, "", 60'000).trouble, HasSubstr("did not end in time"));
  EXPECT_THAT(run_program({"/no/such"}, "", 100).trouble, HasSubstr("cannot be started: No such"));
}

TEST(ChildProgram, IsHeardWithItsErrors) {
  const ProgramResult result =
      run_and_hear({"sh", "-c", "echo said; echo first >&2; echo last >&2; exit 7"}, 10);
  EXPECT_EQ(result.output, "said\n");
  EXPECT_EQ(result.errors, "first\nlast\n");
  EXPECT_EQ(result.exit_code, 7);
  EXPECT_FALSE(result.is_well());
  EXPECT_EQ(result.complaint(), "last");
  EXPECT_TRUE(run_and_hear({"true"}, 10).is_well());
  EXPECT_EQ(run_and_hear({"sh", "-c", "kill -9 $$"}, 10).exit_code, 128 + 9);
  // It closes what it says with, and goes on: not for longer than its time.
  EXPECT_THAT(run_and_hear({"sh", "-c", "exec >&- 2>&-; sleep 1000"}, 1).complaint(),
              HasSubstr("did not end in time"));
}

/// A script that stands for bess-edge.
std::string write_program(const TemporaryFolder& folder, const std::string& body) {
  const std::string path = folder.write("program", "#!/bin/sh\n" + body + "\n");
  EXPECT_EQ(chmod(path.c_str(), 0755), 0);
  return path;
}

std::vector<std::string> keys_of(const ControllerStatus& status) {
  std::vector<std::string> keys;
  for (const Trouble& trouble : troubles_of(status)) keys.push_back(trouble.key);
  return keys;
}

TEST(ControllerStatus, EachReasonIsATroubleWhateverItsNumbers) {
  const TemporaryFolder folder;
  const std::string program = write_program(
      folder,
      R"(echo '{"health": "degraded", "last": {"reason": "alarm"}, "health_reasons": [)"
      R"("WARN: mode is holding, reason alarm", "CRITICAL: the last cycle ended 601 s ago", )"
      R"("WARN: a rule of next year"]}'; exit 1)");
  const ControllerStatus status = ask_controller(program, "edge.toml");
  EXPECT_EQ(status.trouble, "");
  EXPECT_THAT(keys_of(status), ElementsAre("not running: alarm", "the last cycle ended # s ago",
                                           "a rule of next year"));
}

/// From the first answer that fails to the safe mode that follows.
TEST(ControllerStatus, AnOutageIsOneTrouble) {
  const auto keys_at = [](std::string_view mode, std::string_view reason, bool battery_fails) {
    HealthInputs in{};
    in.is_running = in.is_of_this_run = true;
    in.cycles = 9;
    in.mode = mode;
    in.reason = reason;
    in.battery_status = battery_fails ? "timeout" : "ok";
    in.price_status = battery_fails ? "ok" : "http_error";
    ControllerStatus status;
    Json reasons = Json::list();
    for (const std::string& line : assess_health(in).reasons) reasons.add(line);
    status.json.set("last", Json::object({{"reason", reason}}));
    status.json.set("health_reasons", std::move(reasons));
    return keys_of(status);
  };
  EXPECT_THAT(keys_at("running", "student", false), ElementsAre("prices"));
  for (const char* reason : {"no_price", "price_age", "price_qh"}) {
    EXPECT_THAT(keys_at("safe", reason, false), ElementsAre("prices")) << reason;
  }
  EXPECT_THAT(keys_at("running", "student", true), ElementsAre("battery"));
  EXPECT_THAT(keys_at("holding", "link", true), ElementsAre("battery"));
  EXPECT_THAT(keys_at("safe", "link", true), ElementsAre("battery"));
}

TEST(ControllerStatus, ASickAnswerIsATroubleOfItsOwn) {
  const TemporaryFolder folder;
  EXPECT_THAT(keys_of(ask_controller("/no/such", "x")), ElementsAre("no status"));
  for (const char* body : {"exit 1", "echo nonsense", "echo '{}'", "echo '[1]'"}) {
    const ControllerStatus status = ask_controller(write_program(folder, body), "x");
    EXPECT_THAT(status.trouble, HasSubstr("gives no status")) << body;
    EXPECT_THAT(keys_of(status), ElementsAre("no status"));
  }
  ControllerStatus well;
  well.json.set("health", "ok");
  EXPECT_TRUE(troubles_of(well).empty());
}

const Message kAlarm{.kind = MessageKind::kAlarm,
                     .key = "not running: link",
                     .text = "WARN: mode is safe, reason link\nBcc: evil@example.org",
                     .utc_s = 1'679'875'320,
                     .since_utc_s = 1'679'875'020};

class AlarmCommand : public ::testing::Test {
 protected:
  AlarmCommand() { signal(SIGPIPE, SIG_IGN); }  // as the program does: not all read their input
  std::string run(const std::string& command) {
    settings_.command = command;
    return run_alarm_command(settings_, kAlarm, {});
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

TEST_F(AlarmCommand, IsGivenSeverityTitleAndTextInItsEnvironmentAndItsInput) {
  EXPECT_EQ(run("{ echo \"$BESS_SEVERITY|$BESS_TITLE|$BESS_NODE|$BESS_KEY|$BESS_UTC\"; "
                "cat; } >" +
                folder_.file("said")),
            "");
  EXPECT_THAT(said(), HasSubstr("alarm|[bess garage] ALARM: WARN: mode is safe, reason link "));
  EXPECT_THAT(said(), HasSubstr("|garage|not running: link|2023-03-27T00:02:00Z\n"));
  EXPECT_THAT(said(), HasSubstr("since 2023-03-26T23:57:00Z\n"));
  EXPECT_THAT(said(), HasSubstr("call: Ann, +32 2 555 01 23\n"));
}

TEST_F(AlarmCommand, NothingInATextIsReadByTheShell) {
  Message evil = kAlarm;
  evil.text = "'; touch " + folder_.file("owned") + "; $(touch " + folder_.file("owned") + ") `id`";
  settings_.command = "echo \"$BESS_TEXT\" >" + folder_.file("said");
  EXPECT_EQ(run_alarm_command(settings_, evil, {}), "");
  EXPECT_THAT(said(), HasSubstr("$(touch "));
  EXPECT_FALSE(std::filesystem::exists(folder_.file("owned")));
}

TEST_F(AlarmCommand, ThatFailsHangsOrIsNoneIsTold) {
  EXPECT_THAT(run("exit 3"), HasSubstr("exit code 3"));
  EXPECT_THAT(run("/no/such/program"), HasSubstr("exit code 127"));
  settings_.command_ms_max = 200;
  EXPECT_NE(run("sleep 1000"), "");
}

/// As Debian packages it, to a server of its kind "json".
TEST_F(AlarmCommand, MayBeApprise) {
  if (!std::filesystem::exists("/usr/bin/apprise")) GTEST_SKIP() << "apprise is not installed";
  std::string body;
  TestServer server([&body](TestConnection& to, const std::string& request) {
    const std::size_t at = request.find("Content-Length: ");
    EXPECT_TRUE(to.read_bytes(std::stoul(request.substr(at + 16)), body));
    return to.answer("{}");
  });
  settings_.command_ms_max = 60'000;
  EXPECT_EQ(run("apprise -t \"$BESS_TITLE\" -b \"$BESS_TEXT\" json://127.0.0.1:" +
                std::to_string(server.port())),
            "");
  EXPECT_THAT(body, HasSubstr("[bess garage] ALARM: WARN: mode is safe"));
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

/// What stands in the broker is an interface: a difference moves what users have built upon.
TEST(Topics, AreTheseToTheLetter) {
  set_market_time_zone();
  NotifySettings settings;
  settings.name = "garage";
  settings.mqtt.discovery_prefix = "homeassistant";
  settings.mqtt.orders = true;
  HoldDesk desk(60, 4'000);
  DayAccount day(20'231'126);
  day.add(CycleRecord{});
  EnergyTotals energy;
  energy.charged_ws = 44'442'000;
  energy.discharged_ws = 36'000'000'000;
  energy.counted_utc_s = kAlarm.utc_s;
  std::string text =
      "# generator notify_test, no seed, command: BESS_UPDATE_GOLDEN=1 notify_test "
      "--gtest_filter=Topics.*\n";
  text +=
      topic("garage", "state") + " " + state_json(sample_status(), 2, {energy, day, &desk}) + "\n";
  text +=
      topic("garage", "state") + " " + state_json({.trouble = "x"}, 0, {{}, DayAccount(0)}) + "\n";
  text += topic("garage", "state") + " " +
          state_json(sample_status("not running"), 1, {energy, day}) + "\n";
  text += topic("garage", "alarms") + " " +
          alarms_json({{.key = "k", .text = "t", .since_utc_s = 0, .is_told = true},
                       {.key = "not told yet"}}) +
          "\n";
  text += topic("garage", "day") + " " + day_json(day) + "\n";
  text += topic("garage", "event") + " " + message_json("garage", kAlarm) + "\n";
  text += discovery_topic(settings) + " " + discovery_json(settings, "1.2.3") + "\n";
  expect_golden(BESS_SOURCE_DIR "/tests/golden/mqtt_topics.txt", text);
}

TEST(NotifierStateFile, OutlastsARestart) {
  const TemporaryFolder folder;
  const std::string path = folder.file("new/told.json");
  NotifierState told;
  told.local_day = 20'231'126;
  told.alarms = {{.key = "k", .text = "t", .since_utc_s = 60, .seen_utc_s = 120, .is_told = true}};
  told.owed["command"].messages = {kAlarm};
  told.owed["mqtt"].dropped = {.count = 3, .first_utc_s = 60, .last_utc_s = 180};
  told.energy.charged_ws = 9'000'000'000'000;
  told.energy.discharged_ws = 7;
  told.energy.counted_number = 25'200;
  told.energy.counted_utc_s = 1'679'875'320;
  ASSERT_EQ(write_notifier_state({path}, notifier_state_text(told)), "");
  const NotifierState read = read_newest_notifier_state({path}).told;
  EXPECT_EQ(read.local_day, 20'231'126);
  ASSERT_EQ(read.alarms.size(), 1U);
  EXPECT_EQ(read.alarms[0].key, "k");
  EXPECT_EQ(read.alarms[0].since_utc_s, 60);
  EXPECT_EQ(read.alarms[0].seen_utc_s, 120);
  EXPECT_TRUE(read.alarms[0].is_told);
  ASSERT_EQ(read.owed.at("command").messages.size(), 1U);
  const Message& message = read.owed.at("command").messages.front();
  EXPECT_EQ(message.kind, MessageKind::kAlarm);
  EXPECT_EQ(message.text, kAlarm.text);
  EXPECT_EQ(message.utc_s, kAlarm.utc_s);
  EXPECT_EQ(read.owed.at("mqtt").dropped.count, 3);
  EXPECT_EQ(read.owed.at("mqtt").dropped.last_utc_s, 180);
  EXPECT_EQ(notifier_state_text(read), notifier_state_text(told));
}

TEST(NotifierStateFile, ADamagedFileIsAsIfNothingWasTold) {
  const TemporaryFolder folder;
  for (const char* text : {"", "x", "{}", "[1]", R"({"version": 2, "local_day": 7})",
                           R"({"version": 1, "alarms": 5, "pending": [1]})"}) {
    const NotifierState told = read_newest_notifier_state({folder.write("told.json", text)}).told;
    EXPECT_EQ(told.local_day, 0);
    EXPECT_TRUE(told.alarms.empty());
  }
}

/// In the folder twice, and in memory.
class ToldCopies : public ::testing::Test {
 protected:
  void keep(std::uint64_t number) {
    NotifierState told;
    told.number = number;
    told.local_day = static_cast<std::int32_t>(number);
    text_ = notifier_state_text(told);
    ASSERT_EQ(write_notifier_state(paths_, text_), "");
  }
  void expect_known(std::uint64_t number, const std::vector<std::string>& losses) const {
    const NotifierStateReading reading = read_newest_notifier_state(paths_);
    EXPECT_EQ(reading.told.local_day, static_cast<std::int32_t>(number));
    EXPECT_EQ(reading.losses, losses);
  }

  const TemporaryFolder folder_;
  const std::vector<std::string> paths_ = {folder_.file("disk/told.json"),
                                           folder_.file("disk/told.copy"),
                                           folder_.file("memory/told.json")};
  std::string text_;
};

TEST_F(ToldCopies, TheNewestCounts) {
  expect_known(0, {});
  keep(7);
  expect_known(7, {});
  for (const std::string& path : paths_) {
    NotifierState later;
    later.number = later.local_day = 8;
    ASSERT_EQ(write_notifier_state({path}, notifier_state_text(later)), "");
    expect_known(8, {});
    keep(7);
  }
  std::filesystem::remove_all(folder_.file("memory"));
  expect_known(7, {});  // a boot
}

TEST_F(ToldCopies, AnyFlippedByteIsSeenAndCostsNothing) {
  keep(7);
  for (const std::string& path : paths_) {
    for (std::size_t i = 0; i < text_.size(); i += 5) {
      std::string flipped = text_;
      flipped[i] = static_cast<char>(flipped[i] ^ (1 << i % 8));
      std::ofstream(path, std::ios::binary) << flipped;
      const NotifierStateReading reading = read_newest_notifier_state(paths_);
      ASSERT_EQ(reading.told.local_day, 7) << i;
      // In the words around the checksum a flip makes it one without: what it says is as it was.
      EXPECT_TRUE(!reading.losses.empty() || i >= text_.rfind(",\n")) << i;
    }
    std::ofstream(path) << text_;
  }
}

TEST_F(ToldCopies, WhatIsLostIsNamedAndAllLostIsSaid) {
  keep(7);
  std::filesystem::remove(paths_[1]);
  expect_known(7, {paths_[1] + " is gone; another copy counts"});
  std::filesystem::remove(paths_[0]);
  std::filesystem::create_directory(paths_[0]);
  std::ofstream(paths_[2]) << text_.substr(0, text_.size() / 2);
  expect_known(0, {paths_[0] + " cannot be read: Is a directory",
                   paths_[2] + " is damaged, or of another version: not believed",
                   "what was told is not known: alarms are told again, days and energy are counted "
                   "anew"});
}

TEST_F(ToldCopies, WhereOnePlaceRefusesTheOthersKeepItAndThatIsSaid) {
  keep(7);
  std::filesystem::remove(paths_[0]);
  std::filesystem::create_directory(paths_[0]);
  EXPECT_EQ(write_notifier_state(paths_, text_), paths_[0] +
                                                     ": cannot be written: Is a directory; what is "
                                                     "told is kept in " +
                                                     paths_[2] + " alone");
  EXPECT_EQ(
      write_notifier_state({"/proc/nowhere/told.json"}, text_),
      "/proc/nowhere/told.json: cannot be written: No such file or directory; what is told is "
      "kept nowhere: a restart tells it again");
}

}  // namespace
}  // namespace bess
