// Hanging channels next to working ones: the whole program with a command that sleeps and a broker
// that comes and goes. Which reports are sent, when and how often, and which survive a kill.
#include <gmock/gmock.h>

#include "shared/host/child_process.h"
#include "tests/support/tokens.h"
#include "tests/unit/edge/companions/notify/notify_site.h"

namespace bess {
namespace {

using ::testing::HasSubstr;

class Channels : public Mqtt {
 protected:
  void SetUp() override {
    Mqtt::SetUp();
    settings_.every_s = 1;
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
  /// The program with a broker and a subscriber.
  struct Running {
    explicit Running(Channels& at)
        : broker(at.folder_, at.port()),
          all(std::make_unique<Listener>(at.port(), "bess/#")),
          notify({BESS_NOTIFY_PROGRAM, "--config", at.config()}) {
      EXPECT_EQ(all->await("/status", "online"), "online");
    }
    void stop() {
      notify.signal(SIGTERM);
      EXPECT_EQ(notify.wait(), 0);
    }
    Broker broker;
    std::unique_ptr<Listener> all;
    ChildProcess notify;
  };
  /// Waits until a file has this many lines; false after 30 s.
  bool await_lines(const std::string& name, std::size_t count) const {
    for (int i = 0; i < 600; ++i) {
      if (count_of(text_of_file(folder_.file(name)), "\n") >= count) return true;
      usleep(50'000);
    }
    return false;
  }
};

TEST_F(Channels, AnAlarmReachesTheGoodChannelWhateverTheCommandDoes) {
  settings_.command = "echo x >>" + folder_.file("command_began") + "; sleep 1000";
  Running running(*this);
  set_status("degraded", {"first"});
  ASSERT_NE(running.all->await("/event", "WARN first"), "");
  ASSERT_TRUE(await_lines("command_began", 1));  // and it stays at it
  for (const char* name : {"second", "third"}) {
    set_status("degraded", {name});
    ASSERT_NE(running.all->await("/event", std::string("WARN ") + name), "");
  }
  running.stop();
  EXPECT_EQ(running.all->await("/status", "offline"), "offline");
}

/// The broker hangs, disappears and returns: each event arrives once and in order, and the command
/// continues to run.
TEST_F(Channels, AnIntermittentBrokerReceivesEverythingOnce) {
  use_command();
  Running running(*this);
  running.broker.freeze();
  set_status("degraded", {"one"});
  ASSERT_TRUE(await_lines("told", 1));
  EXPECT_THAT(told(), HasSubstr("ALERT: WARN one"));
  std::this_thread::sleep_for(std::chrono::seconds(3));  // several tries
  running.broker.thaw();
  ASSERT_NE(running.all->await("/event", "WARN one"), "");
  // Without an acknowledgement it is repeated; later publications are acknowledged after it.
  for (const int s : {1, 2}) {
    set_status("degraded", {"one"}, kNow + s);
    ASSERT_NE(running.all->await("/state", std::string(utc_text(kNow + s).view())), "");
  }
  running.broker.stop();
  set_status("ok");
  for (int i = 0; i < 600 && count_of(told(), "over: WARN one") == 0; ++i) usleep(50'000);
  EXPECT_THAT(told(), HasSubstr("over: WARN one"));
  running.broker.start();
  running.all = std::make_unique<Listener>(port(), "bess/#");
  ASSERT_NE(running.all->await("/event", "over"), "");
  set_status("degraded", {"two"});
  ASSERT_NE(running.all->await("/event", "WARN two"), "");
  EXPECT_EQ(running.all->count("/event"), 2U);  // since its return
  running.broker.freeze();                      // which does not delay the end
  set_status("degraded", {"three"});
  EXPECT_TRUE(await_lines("told", 4));
  running.stop();
  running.broker.thaw();
}

/// A hanging command is killed at its deadline with all child processes, and run again.
TEST_F(Channels, ACommandThatHangsIsKilledAndRunAgain) {
  settings_.mqtt.host = "";
  settings_.command_ms_max = 300;
  settings_.command = "[ -e " + folder_.file("well") + " ] || { echo $$ >>" +
                      folder_.file("command_began") + "; sleep 1000; }; echo x >>" +
                      folder_.file("told");
  set_status("degraded", {"trouble"});
  Notifier notifier(settings_);
  whole_round(notifier, kNow);
  EXPECT_EQ(pending().size(), 1U);
  const pid_t pid = std::stoi(text_of_file(folder_.file("command_began")));
  EXPECT_NE(kill(pid, 0), 0) << "it is gone";
  folder_.write("well", "");
  whole_round(notifier, kNow + 30);
  EXPECT_EQ(told(), "x\n");
  EXPECT_TRUE(pending().empty());
}

/// Killed repeatedly during a slow command: no alert is lost, and the file is complete each time.
TEST_F(Channels, AKillLosesNothing) {
  settings_.command = "echo x >>" + folder_.file("command_began") +
                      "; sleep 0.3; echo \"$BESS_TITLE\" >>" + folder_.file("told");
  const std::string file = config();
  constexpr int kKills = 6;
  for (int i = 0; i < kKills; ++i) {
    set_status("degraded", {"kind_" + std::to_string(i)});
    ChildProcess notify({BESS_NOTIFY_PROGRAM, "--config", file});
    ASSERT_TRUE(await_lines("command_began", static_cast<std::size_t>(i) + 1));
    usleep(static_cast<useconds_t>(74'000 * i));
    notify.signal(SIGKILL);
    notify.wait();
  }
  ChildProcess notify({BESS_NOTIFY_PROGRAM, "--config", file});
  for (int i = 0; i < kKills; ++i) {
    const std::string headline = "ALERT: WARN kind_" + std::to_string(i);
    for (int wait = 0; wait < 600 && count_of(told(), headline) == 0; ++wait) usleep(50'000);
    EXPECT_GE(count_of(told(), headline), 1U) << headline;
  }
  EXPECT_EQ(notify.signal(SIGTERM), true);
  EXPECT_EQ(notify.wait(), 0);
  EXPECT_EQ(count_of(text_of_file(folder_.file("notify/told.json")), "\"version\""), 1U);
}

TEST_F(Channels, ASecondNotifierOfOneMemoryIsRefused) {
  const std::string file = config();
  {
    Running first(*this);
    const ProgramOutput second = notify_output({"--config", file, "--once"});
    EXPECT_EQ(second.exit_code, 1);
    EXPECT_THAT(second.text, Names("[notify] folder " + std::to_string(first.notify.pid()) + " " +
                                   folder_.file("notify/lock")));
    // These may run, and leave the first one's publication.
    EXPECT_EQ(notify_output({"--config", file, "--check"}).exit_code, 0);
    EXPECT_EQ(notify_output({"--config", file, "--test"}).exit_code, 0);
    EXPECT_NE(first.all->await("/event", "\"key\":\"test\""), "");
    Listener later(port(), "bess/v1/garage/status");
    EXPECT_EQ(later.await("/status", "o"), "online");
    EXPECT_EQ(first.all->count("/status"), 1U);
    first.notify.signal(SIGKILL);
    first.notify.wait();
    EXPECT_EQ(first.all->await("/status", "offline"), "offline") << "by the broker";
  }
  EXPECT_EQ(notify_output({"--config", file, "--once"}).exit_code,
            0);  // a killed process owns no lock
}

/// Without storage, alerts are still reported, and so is the storage fault.
TEST_F(Channels, ANotifierThatCannotLockStillReports) {
  const std::string file =
      folder_.write("edge.toml", "[notify]\nfolder = \"/proc/nowhere\"\nafter_s = 0\nprogram = \"" +
                                     settings_.program + "\"\n");
  set_status("degraded", {"trouble"});
  const ProgramOutput said = notify_output({"--config", file, "--once"});
  EXPECT_EQ(said.exit_code, 0);
  EXPECT_THAT(said.text, ::testing::AllOf(Names("/proc/nowhere/lock /proc/nowhere/told.json"),
                                          HasSubstr("ALERT: WARN trouble")));
}

}  // namespace
}  // namespace bess
