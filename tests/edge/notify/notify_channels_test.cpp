// Channels that hang, beside ones that do not: the whole program with a command that sleeps and a
// broker that comes and goes. What is reported, when, how often, and what survives a kill.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "shared/host/child_process.h"
#include "shared/scaled_clock.h"
#include "tests/edge/notify/notify_site.h"
#include "tests/support/said.h"
#include "tests/support/test_server.h"

namespace bess {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

double seconds_now() { return static_cast<double>(clock_ns(CLOCK_MONOTONIC)) / 1e9; }

class Channels : public Mqtt {
 protected:
  void SetUp() override {
    Mqtt::SetUp();
    settings_.every_s = 1;
  }
  void use_stuck_command() {
    settings_.command = "echo x >>" + folder_.file("command_began") + "; sleep 1000";
  }
  /// The same settings as a file.
  std::string config() {
    std::string text = "[battery]\nname = \"garage\"\n[notify]\nevery_s = 1\nafter_s = " +
                       std::to_string(settings_.after_s) + "\nprogram = \"" + settings_.program +
                       "\"\n";
    if (!settings_.command.empty()) text += "command = '" + settings_.command + "'\n";
    text += "mqtt_host = \"127.0.0.1\"\nmqtt_port = " + std::to_string(port()) + "\n";
    return folder_.write("edge.toml", text);
  }
  /// Waits until a file has this many lines; false after half a minute.
  bool await_lines(const std::string& name, std::size_t count) const {
    for (int i = 0; i < 600; ++i) {
      if (count_of(text_of_file(folder_.file(name)), "\n") >= count) return true;
      usleep(50'000);
    }
    return false;
  }
};

TEST_F(Channels, AnAlarmReachesTheGoodChannelWithinARoundWhateverTheCommandIsAt) {
  Broker broker(folder_, port());
  Listener all(port(), "bess/#");
  use_stuck_command();
  ChildProcess notify({BESS_NOTIFY_PROGRAM, "--config", config()});
  ASSERT_EQ(all.await("/status", "online"), "online");
  set_status("degraded", R"("WARN: the first")");
  ASSERT_NE(all.await("/event", "the first"), "");
  ASSERT_TRUE(await_lines("command_began", 1));  // and it stays at it
  double slowest_s = 0;
  for (const char* name : {"the second", "the third", "the fourth"}) {
    const double begin_s = seconds_now();
    set_status("degraded", std::string(R"("WARN: )") + name + "\"");
    ASSERT_NE(all.await("/event", std::string("WARN: ") + name), "");
    slowest_s = std::max(slowest_s, seconds_now() - begin_s);
  }
  std::printf("an alarm is at the good channel after %.1f s at most, with rounds of 1 s\n",
              slowest_s);
  EXPECT_LT(slowest_s, 1 + 5) << "a round, and what a busy machine adds";
  notify.signal(SIGTERM);
  const double begin_s = seconds_now();
  EXPECT_EQ(notify.wait(), 0);
  EXPECT_LT(seconds_now() - begin_s, 10);
  EXPECT_EQ(all.await("/status", "offline"), "offline");
}

/// Two rounds of margin for a busy machine.
TEST_F(Channels, AnOutageIsToldAsLongAsItWas) {
  Broker broker(folder_, port());
  Listener all(port(), "bess/#");
  use_stuck_command();
  ChildProcess notify({BESS_NOTIFY_PROGRAM, "--config", config()});
  ASSERT_EQ(all.await("/status", "online"), "online");
  set_status("degraded", R"("WARN: an outage")");
  ASSERT_NE(all.await("/event", "an outage"), "");
  const double begin_s = seconds_now();
  std::this_thread::sleep_for(std::chrono::seconds(7));
  set_status("ok");
  const double lasted_s = seconds_now() - begin_s;
  const std::string over = all.await("/event", "lasted");
  const std::size_t at = over.find("(lasted ");
  ASSERT_NE(at, over.npos) << over;
  std::printf("an outage of %.1f s is told as %s\n", lasted_s, over.substr(at).c_str());
  EXPECT_NEAR(std::stod(over.substr(at + 8)), lasted_s, 3) << over;
}

/// In moved time, exactly: seen from 5 to 45 s, it lasted between 40 and 50 s.
TEST_F(Channels, FortyFiveSecondsAreFortyFiveSeconds) {
  Broker broker(folder_, port());
  Listener all(port(), "bess/#");
  settings_.every_s = 5;
  Notifier notifier(settings_);
  whole_round(notifier, kNow);
  set_status("degraded", R"("WARN: an outage")");
  for (int s = 5; s <= 45; s += 5) whole_round(notifier, kNow + s);
  set_status("ok");
  whole_round(notifier, kNow + 50);
  EXPECT_THAT(all.await("/event", "over"), HasSubstr("an outage (lasted 45 s)"));
}

/// The broker stands still, goes away, and is there again: each event comes once and in order, and
/// the command is run meanwhile.
TEST_F(Channels, ABrokerThatComesAndGoesIsToldEverythingOnce) {
  Broker broker(folder_, port());
  auto all = std::make_unique<Listener>(port(), "bess/#");
  use_command();
  ChildProcess notify({BESS_NOTIFY_PROGRAM, "--config", config()});
  ASSERT_EQ(all->await("/status", "online"), "online");
  broker.freeze();
  set_status("degraded", R"("WARN: one")");
  ASSERT_TRUE(await_lines("told", 1));
  EXPECT_THAT(told(), HasSubstr("ALARM: WARN: one"));
  std::this_thread::sleep_for(std::chrono::seconds(6));  // several tries
  broker.thaw();
  ASSERT_NE(all->await("/event", "WARN: one"), "");
  std::this_thread::sleep_for(
      std::chrono::seconds(1));  // without an acknowledgement it is repeated
  broker.stop();
  set_status("ok");
  for (int i = 0; i < 600 && count_of(told(), "over: WARN: one") == 0; ++i) usleep(50'000);
  EXPECT_THAT(told(), HasSubstr("over: WARN: one"));
  broker.start();
  all = std::make_unique<Listener>(port(), "bess/#");
  ASSERT_NE(all->await("/event", "over"), "");
  set_status("degraded", R"("WARN: two")");
  ASSERT_NE(all->await("/event", "WARN: two"), "");
  EXPECT_EQ(all->count("/event"), 2U);  // since it is there again
}

/// A command that hangs is killed at its deadline, with all that it started, and run again.
TEST_F(Channels, ACommandThatHangsIsKilledAndRunAgain) {
  settings_.mqtt.host = "";
  settings_.command_ms_max = 300;
  settings_.command = "[ -e " + folder_.file("well") + " ] || { echo $$ >>" +
                      folder_.file("command_began") + "; sleep 1000; }; echo x >>" +
                      folder_.file("told");
  set_status("degraded", R"("WARN: a trouble")");
  Notifier notifier(settings_);
  whole_round(notifier, kNow);
  EXPECT_EQ(pending().size(), 1U);
  const pid_t pid = std::stoi(text_of_file(folder_.file("command_began")));
  EXPECT_NE(kill(pid, 0), 0) << "it is gone";
  static_cast<void>(folder_.write("well", ""));
  whole_round(notifier, kNow + 30);
  EXPECT_EQ(told(), "x\n");
  EXPECT_TRUE(pending().empty());
}

TEST_F(Channels, ABrokerThatStandsStillDoesNotHoldUpTheEnd) {
  Broker broker(folder_, port());
  Listener all(port(), "bess/#");
  ChildProcess notify({BESS_NOTIFY_PROGRAM, "--config", config()});
  ASSERT_EQ(all.await("/status", "online"), "online");
  broker.freeze();
  set_status("degraded", R"("WARN: a trouble")");
  std::this_thread::sleep_for(std::chrono::milliseconds(1'500));
  const double begin_s = seconds_now();
  notify.signal(SIGTERM);
  EXPECT_EQ(notify.wait(), 0);
  EXPECT_LT(seconds_now() - begin_s, 20);
  broker.thaw();
}

/// Killed again and again while its command takes its time: no alarm is lost, and the file is whole
/// each time.
TEST_F(Channels, AKillLosesNothing) {
  settings_.command = "echo x >>" + folder_.file("command_began") +
                      "; sleep 0.3; echo \"$BESS_TITLE\" >>" + folder_.file("told");
  const std::string file = config();
  constexpr int kKills = 12;
  for (int i = 0; i < kKills; ++i) {
    set_status("degraded",
               "\"WARN: trouble of kind " + std::string(1, static_cast<char>('A' + i)) + "\"");
    ChildProcess notify({BESS_NOTIFY_PROGRAM, "--config", file});
    ASSERT_TRUE(await_lines("command_began", static_cast<std::size_t>(i) + 1));
    usleep(static_cast<useconds_t>(37'000 * i));
    notify.signal(SIGKILL);
    notify.wait();
  }
  ChildProcess notify({BESS_NOTIFY_PROGRAM, "--config", file});
  for (int i = 0; i < kKills; ++i) {
    const std::string headline =
        "ALARM: WARN: trouble of kind " + std::string(1, static_cast<char>('A' + i));
    for (int wait = 0; wait < 600 && count_of(told(), headline) == 0; ++wait) usleep(50'000);
    EXPECT_GE(count_of(told(), headline), 1U) << headline;
  }
  EXPECT_EQ(notify.signal(SIGTERM), true);
  EXPECT_EQ(notify.wait(), 0);
  EXPECT_EQ(count_of(text_of_file(folder_.file("notify/told.json")), "\"version\""), 1U);
}

/// What the program says on one run.
Said run(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), BESS_NOTIFY_PROGRAM);
  return answer_of(std::move(arguments));
}

TEST_F(Channels, ASecondNotifierOfOneMemoryIsRefused) {
  Broker broker(folder_, port());
  Listener all(port(), "bess/#");
  const std::string file = config();
  {
    ChildProcess first({BESS_NOTIFY_PROGRAM, "--config", file});
    ASSERT_EQ(all.await("/status", "online"), "online");
    for (const std::vector<std::string>& task :
         {std::vector<std::string>{}, std::vector<std::string>{"--once"}}) {
      std::vector<std::string> arguments = {"--config", file};
      arguments.insert(arguments.end(), task.begin(), task.end());
      const Said second = run(arguments);
      EXPECT_EQ(second.exit_code, 1);
      EXPECT_THAT(second.text,
                  AllOf(HasSubstr("[notify] folder is in use by another program (process " +
                                  std::to_string(first.pid()) + ", lock "),
                        HasSubstr("notify/lock"), HasSubstr("stop that one")));
    }
    // These may, and leave what the first one published.
    EXPECT_EQ(run({"--config", file, "--check"}).exit_code, 0);
    EXPECT_THAT(run({"--config", file, "--test"}).text, HasSubstr("mqtt: sent"));
    EXPECT_NE(all.await("/event", "can reach you"), "");
    Listener later(port(), "bess/v1/garage/status");
    EXPECT_EQ(later.await("/status", "o"), "online");
    EXPECT_EQ(all.count("/status"), 1U);
    first.signal(SIGKILL);
    first.wait();
  }
  EXPECT_EQ(run({"--config", file, "--once"}).exit_code, 0);  // a killed one holds nothing
}

/// Where nothing can be kept, something must be told all the same.
TEST_F(Channels, ANotifierThatCannotLockStillTells) {
  const std::string file =
      folder_.write("edge.toml", "[notify]\nfolder = \"/proc/nowhere\"\nafter_s = 0\nprogram = \"" +
                                     settings_.program + "\"\n");
  set_status("degraded", R"("WARN: a trouble")");
  const Said said = run({"--config", file, "--once"});
  EXPECT_EQ(said.exit_code, 0);
  EXPECT_THAT(said.text, AllOf(HasSubstr("/proc/nowhere/lock: cannot make the lock"),
                               HasSubstr("ALARM: WARN: a trouble")));
}

}  // namespace
}  // namespace bess
