// Whole rounds of the notifier: a changing status, a script as the command, and a real broker on
// loopback. Time is an argument.
#include <gmock/gmock.h>

#include <random>

#include "edge/records/account/settled_prices.h"
#include "shared/host/child_process.h"
#include "shared/host/text.h"
#include "tests/support/tokens.h"
#include "tests/unit/edge/companions/notify/notify_site.h"

namespace bess {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

TEST_F(Rounds, AnAlarmIsReportedOnceAndItsEndOnceAlsoOverRestarts) {
  use_command();
  set_status("degraded", {"no_price"});
  for (int s = 0; s <= 1'200; s += 30) round_of_its_own(settings_, kNow + s);  // each a restart
  EXPECT_EQ(count_of(told(), "Subject: "), 1U);
  EXPECT_THAT(told(), HasSubstr("Subject: [bess garage] ALERT: WARN no_price: found"));
  set_status("ok");
  for (int s = 1'230; s <= 2'400; s += 30) round_of_its_own(settings_, kNow + s);
  EXPECT_EQ(count_of(told(), "Subject: "), 2U);
  EXPECT_THAT(told(), Names("over: no_price 20 min"));
}

/// Raised and cleared in a drawn order, while the command fails and the notifier restarts at
/// random: each alert and each end is reported once, alternating, and none is missing.
TEST_F(Rounds, AnyOrderOfAlarmsIsReportedOnceForEachRaiseAndEachClear) {
  constexpr std::uint32_t kSeed = 20'261'128;
  constexpr int kKinds = 4;
  const std::string kinds = "ABCD";
  settings_.after_s = 0;
  settings_.command = "[ ! -e " + folder_.file("fails") +
                      " ] && echo \"$BESS_SEVERITY $BESS_KEY\" >>" + folder_.file("told");
  std::mt19937 random(kSeed);
  std::array<bool, kKinds> is_there{};
  std::array<int, kKinds> changes{};
  auto notifier = std::make_unique<Notifier>(settings_);
  const auto round = [&](int s) {
    std::vector<std::string> alerts;
    for (int kind = 0; kind < kKinds; ++kind) {
      if (is_there[kind]) alerts.push_back(kinds.substr(kind, 1));
    }
    set_status("degraded", alerts);
    whole_round(*notifier, kNow + s);
  };
  for (int s = 0; s < 100; ++s) {
    const int kind = static_cast<int>(random() % kKinds);
    is_there[kind] = !is_there[kind];
    ++changes[kind];
    if (random() % 4 == 0) folder_.write("fails", "");
    if (random() % 3 == 0) std::filesystem::remove(folder_.file("fails"));
    if (random() % 5 == 0) notifier.reset(), notifier = std::make_unique<Notifier>(settings_);
    round(s);
  }
  std::filesystem::remove(folder_.file("fails"));
  round(100);
  EXPECT_TRUE(pending().empty());
  for (int kind = 0; kind < kKinds; ++kind) {
    const std::string key = kinds.substr(kind, 1);
    std::string expected;
    for (int i = 0; i < changes[kind]; ++i) {
      expected += (i % 2 == 0 ? "alarm " : "over ") + key + "\n";
    }
    std::string of_kind;
    std::string all = told();
    for (std::string_view rest = all; !rest.empty();) {
      const std::string line(take_line(rest));
      if (line.ends_with(" " + key)) of_kind += line + "\n";
    }
    EXPECT_EQ(of_kind, expected) << key;
  }
}

/// The oldest are dropped when the retry queue is full, and the journal has each of them.
TEST_F(Rounds, TheQueueForTheCommandIsBounded) {
  settings_.after_s = 0;
  settings_.command = "exit 75";
  std::vector<std::string> alerts = {"first"};
  for (std::size_t i = 0; i < Notifier::kPendingMax; ++i) {
    alerts.push_back(std::to_string(i));
  }
  set_status("degraded", alerts);
  round_of_its_own(settings_, kNow);
  ASSERT_EQ(pending().size(), Notifier::kPendingMax);
  EXPECT_EQ(pending().front().key, "0");
}

TEST_F(Rounds, TheDayIsReportedWhenTheNextBegins) {
  use_command();
  settings_.program = folder_.write_script("bess-edge", R"(case "$*" in
"earned today --json --config edge.toml") cat )" + folder_.file("today") +
                                                            R"(;;
"earned yesterday --json --config edge.toml")
  echo '{"days": [{"date": "2023-03-27", "line": "2023-03-27: +0.77 EUR"}]}';;
*) cat )" + folder_.file("status.json") + ";;\nesac");
  const auto cycle = [&](std::int64_t utc_s, const std::string& today) {
    folder_.write("today", R"({"days": [{"date": ")" + today + R"("}]})");
    set_status("ok", {}, utc_s);
    round_of_its_own(settings_, utc_s);
  };
  cycle(kNow, "2023-03-27");
  cycle(kNow + 120, "2023-03-27");
  EXPECT_EQ(told(), "") << "days before the start do not count";
  cycle(kNow + 86'400, "2023-03-28");
  cycle(kNow + 86'520, "2023-03-28");
  EXPECT_EQ(count_of(told(), "Subject: "), 1U);
  EXPECT_THAT(told(), HasSubstr("day 2023-03-27: +0.77 EUR"));
}

/// One day late is no alert, four days are one, and its end is reported.
TEST_F(Rounds, SettledPricesThatStayAwayAreAnAlarm) {
  use_command();
  settings_.after_s = 0;
  settings_.settled_file = folder_.file("notify/settled.csv");
  round_of_its_own(settings_, kNow);
  EXPECT_THAT(told(), Names("ALERT: bess-prices --settle"));
  const auto settle_until = [&](std::int64_t utc_s) {
    SettledPrices prices;
    prices.put(std::vector<SettledQuarter>{{utc_s / 900 * 900 - 900, 80}});
    EXPECT_NE(folder_.write("notify/settled.csv", prices.text()), "");
  };
  settle_until(kNow - 2 * 86'400);
  round_of_its_own(settings_, kNow + 600);
  EXPECT_THAT(told(), Names("over:"));
  settle_until(kNow - 4 * 86'400);
  round_of_its_own(settings_, kNow + 1'200);
  EXPECT_THAT(told(), Names("ALERT: 2023-03-22T23:45:00Z"));
  EXPECT_EQ(count_of(told(), "Subject: "), 3U);
}

/// A card wears by writing.
TEST_F(Rounds, WhatHasNotChangedIsNotWritten) {
  Notifier notifier(settings_);
  whole_round(notifier, kNow);
  EXPECT_FALSE(std::filesystem::exists(settings_.memories[0]));
  set_status("degraded", {"no_price"});
  whole_round(notifier, kNow + 30);
  set_status("ok");
  whole_round(notifier, kNow + 60);
  whole_round(notifier, kNow + 330);
  const auto last = std::filesystem::last_write_time(settings_.memories[0]);
  for (int s = 360; s < 960; s += 30) whole_round(notifier, kNow + s);
  EXPECT_EQ(std::filesystem::last_write_time(settings_.memories[0]), last);
}

TEST_F(Mqtt, TheStateIsRetainedTheEventComesOnceAndTheEndIsOffline) {
  Broker broker(folder_, port());
  Listener all(port(), "#");
  {
    set_status("degraded", {"no_price"});
    Notifier notifier(settings_);
    whole_round(notifier, kNow);
    whole_round(notifier, kNow + 30);
    EXPECT_EQ(all.await("bess/v1/garage/status", "online"), "online");
    EXPECT_THAT(all.await("bess/v1/garage/event", "alarm"), HasSubstr("no_price"));
    EXPECT_NE(all.await("bess/v1/garage/alarms", "no_price"), "");
    EXPECT_THAT(all.await("homeassistant/device/bess_garage/config", "components"),
                HasSubstr("\"unique_id\":\"bess_garage_soc\""));
    Listener later(port(), "bess/v1/garage/#");  // retained: for later subscribers
    EXPECT_THAT(later.await("/state", "health"), HasSubstr("\"health\":\"degraded\""));
    EXPECT_EQ(later.await("/status", "o"), "online");
  }
  EXPECT_EQ(all.await("/status", "offline"), "offline");
  EXPECT_EQ(all.count("/event"), 1U);
}

/// No broker at the start, and one that restarts without memory: everything is published again.
TEST_F(Mqtt, ComesBackWithItsRetainedValues) {
  set_status("degraded", {"no_price"});
  Notifier notifier(settings_);
  whole_round(notifier, kNow);  // no listener
  Broker broker(folder_, port());
  {
    Listener all(port(), "#");
    EXPECT_EQ(all.await("/status", "online"), "online");
    EXPECT_NE(all.await("/state", "health"), "");
    whole_round(notifier, kNow + 30);
    EXPECT_NE(all.await("/event", "alarm"), "");
  }
  broker.stop();
  broker.start();
  Listener again(port(), "#");
  EXPECT_EQ(again.await("/status", "online"), "online");
  EXPECT_NE(again.await("/config", "components"), "");
}

/// Earnings of today and yesterday come from the program's own output.
TEST_F(Mqtt, TheDaysComeAsBessEdgeCountsThem) {
  Broker broker(folder_, port());
  settings_.program = folder_.write_script("bess-edge", R"(case "$1 $2" in
"earned today") cat )" + folder_.file("today") + R"(;;
"earned yesterday") echo '{"days": [{"date": "2023-03-27", "earned_eur": 0.125, "cycles": 9}]}';;
*) cat )" + folder_.file("status.json") + ";;\nesac");
  const auto cycle = [&](std::int64_t utc_s, const char* today) {
    folder_.write("today", today);
    set_status("ok", {}, utc_s);
    round_of_its_own(settings_, utc_s);
  };
  cycle(kNow, R"({"days": [{"date": "2023-03-27", "start_utc": "2023-03-26T22:00:00Z",
    "charged_kwh": 0.3, "discharged_kwh": 0.625, "earned_eur": 0.019}]})");
  Listener now(port(), "bess/v1/garage/#");
  EXPECT_THAT(now.await("/state", "charged_kwh"),
              AllOf(HasSubstr("\"charged_kwh\":0.300,"), HasSubstr("\"discharged_kwh\":0.625,"),
                    HasSubstr("\"earned_today_eur\":0.02,"),
                    HasSubstr("\"today_since_utc\":\"2023-03-26T22:00:00Z\"")));
  cycle(kNow + 86'400, R"({"days": [{"date": "2023-03-28"}]})");
  Listener later(port(), "bess/v1/garage/day");
  EXPECT_EQ(later.await("/day", "earned_eur"),
            R"({"date":"2023-03-27","earned_eur":0.125,"cycles":9})");
}

/// A hold and its end by the broker, where the key allows it: one at a time, in order, none that
/// was sent while the notifier was away, and nothing else.
TEST_F(Mqtt, HoldsAreOrderedWhereTheKeyAllowsIt) {
  Broker broker(folder_, port());
  Listener all(port(), "#");
  all.publish("bess/v1/garage/hold/set", "ON", true);  // retained, before the notifier connects
  ASSERT_EQ(all.await("/hold/set", "ON"), "ON");
  const std::string calls = folder_.file("calls");
  const std::string program = folder_.write_script(
      "ordered", "[ $1 = hold ] && { echo \"$@\" >>" + calls + "; [ $2 != 9999 ]; exit; }; cat " +
                     folder_.file("status.json"));
  const std::string config = folder_.write(
      "edge.toml", "[battery]\nname = \"garage\"\npower_w = 5000\n[notify]\nprogram = \"" +
                       program + "\"\nmqtt_host = \"127.0.0.1\"\nmqtt_port = " +
                       std::to_string(port()) + "\nmqtt_orders = true\n");
  ChildProcess notify({BESS_NOTIFY_PROGRAM, "--config", config});
  EXPECT_THAT(all.await("/config", "_hold\""),
              AllOf(HasSubstr("\"min\":-5000,\"max\":5000"),
                    HasSubstr("\"command_topic\":\"bess/v1/garage/hold_power/set\"")));
  ASSERT_NE(all.await("/state", "\"hold_power_w\":0"), "");
  all.publish("bess/v1/garage/hold_power/set", "-1500");
  EXPECT_NE(all.await("/state", "\"hold_power_w\":-1500"), "") << "stored for the next hold";
  // At most eight orders wait: a state of this time shows that those before are done.
  std::int64_t utc_s = kNow;
  const auto settle = [&] {
    set_status("ok", {}, ++utc_s);
    all.publish("bess/v1/garage/hold_power/set", "no number");
    EXPECT_NE(all.await("/state", std::string(utc_text(utc_s).view())), "");
  };
  for (const char* bad : {"on", "", "ON; rm -rf /", "{\"power_w\":1}"}) {
    all.publish("bess/v1/garage/hold/set", bad);
    all.publish("bess/v1/garage/hold_power/set", bad);
    settle();
  }
  for (const char* power :
       {"1.5", "1e3", " 1", "99999999999", "5001", "-5001", "NaN", "--release"}) {
    all.publish("bess/v1/garage/hold_power/set", power);
    settle();
  }
  all.publish("bess/v1/garage/hold_power/set", std::string(100'000, '9'));
  all.publish("bess/v1/garage/release/set", "ON");
  settle();
  const auto await_calls = [&](const std::string& wanted) {
    for (int i = 0; i < 500 && text_of_file(calls) != wanted; ++i) {
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    return text_of_file(calls);
  };
  const std::string end = " --config " + config + "\n";
  all.publish("bess/v1/garage/hold/set", "ON");
  EXPECT_EQ(await_calls("hold -1500 --for 60m" + end), "hold -1500 --for 60m" + end);
  all.publish("bess/v1/garage/hold/set", "OFF");
  const std::string both = "hold -1500 --for 60m" + end + "hold --release" + end;
  EXPECT_EQ(await_calls(both), both);
}

class Program : public Rounds {};

TEST_F(Program, CommandLine) {
  const std::string config = folder_.write("edge.toml", "[battery]\nname = \"garage\"\n[notify]\n");
  EXPECT_EQ(notify_output({"--nonsense"}).exit_code, 2);
  EXPECT_EQ(notify_output({"--config"}).exit_code, 2);
  EXPECT_EQ(notify_output({"--help"}).exit_code, 0);
  EXPECT_EQ(notify_output({"--config", "/no/such"}).exit_code, 1);
  const ProgramOutput check = notify_output({"--config", config, "--check"});
  EXPECT_EQ(check.exit_code, 0);
  const std::string beside = std::filesystem::path(BESS_NOTIFY_PROGRAM).parent_path().string();
  EXPECT_THAT(check.text, Names("garage 30 300 command mqtt " + beside +
                                "/bess-edge status --config " + config));
  EXPECT_THAT(notify_output({"--config", config, "--once"}).text,
              Names("[notify] command mqtt_host"));
}

TEST_F(Program, ATestMessageGoesToEveryChannelAndSaysWhichFails) {
  use_command();
  const std::string keys = "[notify]\ncommand = '";
  const std::string good = folder_.write("good.toml", keys + settings_.command + "'\n");
  const ProgramOutput sent = notify_output({"--config", good, "--test"});
  EXPECT_THAT(sent.text, Names("command:"));
  EXPECT_EQ(sent.exit_code, 0);
  EXPECT_THAT(told(), Names("test: command"));
  const std::string bad = folder_.write("bad.toml", keys + "/bin/false'\n");
  const ProgramOutput refused = notify_output({"--config", bad, "--test"});
  EXPECT_THAT(refused.text, Names("command: 1"));
  EXPECT_EQ(refused.exit_code, 1);
}

}  // namespace
}  // namespace bess
