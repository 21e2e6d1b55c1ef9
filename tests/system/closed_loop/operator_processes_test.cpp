// Operators and the real programs: a hold that the running controller finds, a notifier that does
// not disturb it.
#include <gmock/gmock.h>
#include <sys/stat.h>

#include <filesystem>
#include <fstream>

#include "shared/host/json.h"
#include "tests/support/edge_answer.h"
#include "tests/support/tokens.h"
#ifdef BESS_NOTIFY_PROGRAM
#include "tests/support/mqtt_broker.h"
#endif

namespace bess {
namespace {

class OperatorProcesses : public SiteTest {
 protected:
  OperatorProcesses() : SiteTest(900) {}
};

/// A lock that would block on opening shows the process that tries.
TEST_F(OperatorProcesses, StatusWithoutLockTouchesNone) {
  start_site(600);
  EXPECT_EQ(ask({"--cycles", "1"}).exit_code, 0);
  ASSERT_EQ(mkfifo(site_.folder.file("state/lock").c_str(), 0600), 0);
  const ProgramOutput said = ask({"status", "--no-lock"});
  EXPECT_EQ(said.exit_code, 3) << said.text;
}

#ifdef BESS_NOTIFY_PROGRAM

class Notify : public OperatorProcesses {
 protected:
  /// Adds [notify] to the controller's own file, with a mailer that is a script.
  void use_mail() {
    const std::string command =
        "{ echo \"Subject: $BESS_TITLE\"; cat; } >>" + site_.folder.file("mails");
    std::ofstream(config_, std::ios::app)
        << "[notify]\nevery_s = 1\nafter_s = 1\ncommand = '" << command << "'\nprogram = \""
        << edge_program() << "\"\n";
  }
  /// False after 30 s.
  bool is_mailed(const std::string& piece) const {
    for (int i = 0; i < 300; ++i) {
      if (text_of_file(site_.folder.file("mails")).find(piece) != std::string::npos) return true;
      usleep(100'000);
    }
    return false;
  }
};

/// Stopped while it reads or writes, killed, restarted: no control cycle is late, none is missed.
TEST_F(Notify, StuckOrKilledItHasNoEffectOnControl) {
  start_site(600);
  use_mail();
  ChildProcess running = controller({"--cycles", "60"});
  ASSERT_NE(await_line(running, "mode=running"), "");
  for (int i = 0; i < 6; ++i) {
    ChildProcess notify({BESS_NOTIFY_PROGRAM, "--config", config_});
    usleep(static_cast<useconds_t>(300'000 + 37'000 * i));
    notify.signal(SIGSTOP);
    usleep(700'000);
    notify.signal(SIGKILL);
    notify.wait();
  }
  running.read_all();
  EXPECT_EQ(running.wait(), 0);
  int cycles = 0;  // since the first price
  for (const CsvRow& row : edge_log()) {
    if (row.at("mode") == "stopping" || (cycles == 0 && row.at("mode") == "start")) continue;
    ++cycles;
    EXPECT_EQ(row.at("mode"), "running");
    EXPECT_EQ(row.at("written"), "1");
  }
  EXPECT_GE(cycles, 55);
}

TEST_F(Notify, WhatTheControllerMeasuresAndCountsIsPublished) {
  if (!std::filesystem::exists(Broker::kProgram)) GTEST_SKIP() << "mosquitto is not installed";
  start_site(3'000);
  use_mail();
  Broker broker(site_.folder, free_port());
  std::ofstream(config_, std::ios::app)
      << "mqtt_host = \"127.0.0.1\"\nmqtt_port = " << broker.port() << "\n";
  Listener all(broker.port(), "bess/#");
  ChildProcess running = controller();
  ASSERT_NE(await_line(running, "mode=running"), "");
  ChildProcess notify({BESS_NOTIFY_PROGRAM, "--config", config_});
  const Json state = Json::parse(all.await("/state", "\"price_eur_per_mwh\""));
  for (const char* number :
       {"soc_percent", "power_w", "setpoint_w", "price_eur_per_mwh", "charged_kwh",
        "discharged_kwh", "earned_today_eur", "full_cycles_today"}) {
    EXPECT_TRUE(state.value()[number].number().has_value()) << number;
  }
  EXPECT_STREQ(state.value()["mode"].text(), "running");
  EXPECT_THAT(state.value()["today_since_utc"].text_or(""), ::testing::HasSubstr(":00:00Z"));
  EXPECT_EQ(SimulatedSite::stop(running), 0);
  EXPECT_EQ(SimulatedSite::stop(notify), 0);
}

#endif

}  // namespace
}  // namespace bess
