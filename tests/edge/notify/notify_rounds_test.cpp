// Whole rounds of the notifier: a status that changes, a command that is a script, a webhook's
// server and a real broker on loopback. Time is an argument.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mutex>

#include "edge/log/ring_log.h"
#include "shared/host/child_process.h"
#include "tests/edge/notify/notify_site.h"
#include "tests/support/test_server.h"

namespace bess {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

TEST_F(Rounds, AnAlarmIsToldOnceAndItsEndOnceAlsoOverRestarts) {
  use_command();
  set_status("degraded", kReason);
  for (int s = 0; s <= 1'200; s += 30) round_of_its_own(settings_, kNow + s);  // each a restart
  EXPECT_EQ(count_of(told(), "Subject: "), 1U);
  EXPECT_THAT(told(),
              HasSubstr("Subject: [bess garage] ALARM: WARN: mode is safe, reason no_price"));
  set_status("ok");
  for (int s = 1'230; s <= 2'400; s += 30) round_of_its_own(settings_, kNow + s);
  EXPECT_EQ(count_of(told(), "Subject: "), 2U);
  EXPECT_THAT(told(), HasSubstr("over: WARN: mode is safe, reason no_price (lasted 20 min)"));
}

TEST_F(Rounds, AControllerThatIsGoneIsAnAlarm) {
  use_command();
  settings_.program = "/no/such";
  Notifier notifier(settings_);
  whole_round(notifier, kNow);
  whole_round(notifier, kNow + 300);
  EXPECT_THAT(told(), HasSubstr("ALARM: /no/such cannot be started"));
}

TEST_F(Rounds, WhatTheCommandRefusesIsTriedAgainAndGivenUpAfterThreeDays) {
  use_command();
  settings_.command = "exit 75";
  settings_.after_s = 0;
  set_status("degraded", kReason);
  round_of_its_own(settings_, kNow);
  EXPECT_EQ(owed("command").messages.size(), 1U);
  use_command();
  round_of_its_own(settings_, kNow + 30);
  EXPECT_EQ(count_of(told(), "Subject: "), 1U);
  EXPECT_TRUE(owed("command").messages.empty());

  settings_.command = "exit 75";
  set_status("ok");
  round_of_its_own(settings_, kNow + 60);
  round_of_its_own(settings_, kNow + 60 + 3 * 86'400);
  EXPECT_EQ(owed("command").messages.size(), 1U);
  round_of_its_own(settings_, kNow + 61 + 3 * 86'400);
  EXPECT_TRUE(owed("command").messages.empty());
  EXPECT_EQ(owed("command").dropped.count, 1);
}

TEST_F(Rounds, TheDayIsToldWhenTheNextBegins) {
  use_command();
  RingLog ring;
  FileMessage error;
  ASSERT_TRUE(ring.open(settings_.ring.c_str(), 2'000, error)) << error.c_str();
  const auto append = [&](std::int64_t utc_s) {
    CycleRecord record;
    record.utc_s = utc_s;
    record.mode = Mode::kRunning;
    record.reason = Reason::kStudent;
    record.has_measurement = record.price.has_row = true;
    record.measurement.power_w = -4'000;
    record.price.price_centi_eur_per_mwh = 20'000;
    ASSERT_TRUE(ring.append(record));
    set_status("ok", "", utc_s);
  };
  for (int i = 0; i < 15; ++i) append(kNow - 4 * 3'600 + 120 * i);  // the evening before
  append(kNow);  // four hours behind them: by the SoC nothing flowed between
  round_of_its_own(settings_, kNow);
  EXPECT_EQ(told(), "");  // days before the first look were not watched
  for (int i = 1; i < 30; ++i) append(kNow + 120 * i);
  round_of_its_own(settings_, kNow + 4'000);
  EXPECT_EQ(told(), "");
  append(kNow + 86'400);
  round_of_its_own(settings_, kNow + 86'400);
  round_of_its_own(settings_, kNow + 86'430);
  EXPECT_EQ(count_of(told(), "Subject: "), 1U);
  EXPECT_THAT(told(),
              HasSubstr("day 2023-03-27: +0.77 EUR (0 of 4 quarter-hours at the settled price, an "
                        "estimate in the others), charged 0.0 kWh, discharged 3.9 "
                        "kWh, 0.00 full cycles, 0 interventions"));
}

/// A card wears by writing: what the log can give again is kept once an hour, and what has not
/// changed not at all.
/// A day late is no trouble, four are one, and its end is told.
TEST_F(Rounds, SettledPricesThatStayAwayAreAnAlarm) {
  use_command();
  settings_.after_s = 0;
  settings_.awaits_settled = true;
  settings_.money.settled_file = folder_.file("notify/settled.csv");
  round_of_its_own(settings_, kNow);
  EXPECT_THAT(told(), HasSubstr("ALARM: no settled price has come yet: bess-prices --settle"));
  const auto settle_until = [&](std::int64_t utc_s) {
    SettledPrices prices;
    prices.put(std::vector<SettledQuarter>{{utc_s / 900 * 900 - 900, 80}});
    EXPECT_NE(folder_.write("notify/settled.csv", prices.text()), "");
  };
  settle_until(kNow - 2 * 86'400);
  round_of_its_own(settings_, kNow + 600);
  EXPECT_THAT(told(), HasSubstr("over: no settled price has come yet"));
  settle_until(kNow - 4 * 86'400);
  round_of_its_own(settings_, kNow + 1'200);
  EXPECT_THAT(told(), HasSubstr("ALARM: no settled price is newer than 2023-03-22T23:45:00Z"));
  EXPECT_EQ(count_of(told(), "Subject: "), 3U);
}

TEST_F(Rounds, WhatWasToldIsWrittenWhenItChanges) {
  RingLog ring;
  FileMessage error;
  ASSERT_TRUE(ring.open(settings_.ring.c_str(), 2'000, error)) << error.c_str();
  const auto written = [&] { return std::filesystem::last_write_time(settings_.memory); };
  Notifier notifier(settings_);
  const auto cycle = [&](int tick) {
    CycleRecord record;
    record.utc_s = kNow + 120 * tick;
    record.has_measurement = true;
    record.measurement.power_w = 4'000;
    ASSERT_TRUE(ring.append(record));
    set_status("ok", "", record.utc_s);
    whole_round(notifier, record.utc_s);
  };
  cycle(0);
  const auto first = written();
  for (int tick = 1; tick < 30; ++tick) cycle(tick);
  EXPECT_EQ(written(), first);
  cycle(30);
  EXPECT_NE(written(), first);
  EXPECT_EQ(read_newest_notifier_state({settings_.memory}).told.energy.charged_ws,
            30 * 120 * 4'000);
}

TEST_F(Mqtt, TheStateIsRetainedTheEventComesOnceAndTheEndIsOffline) {
  Broker broker(folder_, port());
  Listener all(port(), "#");
  {
    set_status("degraded", kReason);
    Notifier notifier(settings_);
    whole_round(notifier, kNow);
    whole_round(notifier, kNow + 30);
    EXPECT_EQ(all.await("bess/v1/garage/status", "online"), "online");
    EXPECT_THAT(all.await("bess/v1/garage/event", "alarm"), HasSubstr("reason no_price"));
    EXPECT_NE(all.await("bess/v1/garage/alarms", "no_price"), "");
    EXPECT_THAT(all.await("homeassistant/device/bess_garage/config", "components"),
                HasSubstr("\"unique_id\":\"bess_garage_soc\""));
    Listener later(port(), "bess/v1/garage/#");  // retained: who comes later knows at once
    EXPECT_THAT(later.await("/state", "health"), HasSubstr("\"health\":\"degraded\""));
    EXPECT_EQ(later.await("/status", "o"), "online");
  }
  EXPECT_EQ(all.await("/status", "offline"), "offline");
  EXPECT_EQ(all.count("/event"), 1U);
}

/// No broker at the start, and one that restarts without a memory: everything is there again.
TEST_F(Mqtt, ComesBackWithItsRetainedValues) {
  set_status("degraded", kReason);
  Notifier notifier(settings_);
  whole_round(notifier, kNow);  // nobody listens
  EXPECT_EQ(owed("mqtt").messages.size(), 1U);
  Broker broker(folder_, port());
  {
    Listener all(port(), "#");
    EXPECT_EQ(all.await("/status", "online"), "online");
    EXPECT_NE(all.await("/state", "health"), "");
    whole_round(notifier, kNow + 30);
    EXPECT_NE(all.await("/event", "alarm"), "");
    EXPECT_TRUE(owed("mqtt").messages.empty());
  }
  broker.stop();
  broker.start();
  Listener again(port(), "#");
  EXPECT_EQ(again.await("/status", "online"), "online");
  EXPECT_NE(again.await("/config", "components"), "");
}

/// What Home Assistant adds up: by a controller and a notifier that both start again and again, and
/// by one that was killed before it could keep what it had counted.
TEST_F(Mqtt, TheCountersOfEnergyOnlyGrowOverRestarts) {
  Broker broker(folder_, port());
  RingLog ring;
  FileMessage error;
  ASSERT_TRUE(ring.open(settings_.ring.c_str(), 2'000, error)) << error.c_str();
  const auto append = [&](int tick, std::int32_t power_w) {
    CycleRecord record;
    record.utc_s = kNow + 120 * tick;
    record.mode = Mode::kRunning;
    record.has_measurement = record.price.has_row = true;
    record.measurement.power_w = power_w;
    record.price.price_centi_eur_per_mwh = 10'000;
    ASSERT_TRUE(ring.append(record));
    set_status("ok", "", record.utc_s);
  };
  const auto state = [&](const std::string& piece) {
    Listener now(port(), "bess/v1/garage/state");
    return now.await("/state", piece);
  };
  append(0, 3'000);
  round_of_its_own(settings_, kNow);
  EXPECT_THAT(state("charged_kwh"),
              AllOf(HasSubstr("\"charged_kwh\":0.000,"), HasSubstr("\"discharged_kwh\":0.000,"),
                    HasSubstr("\"earned_today_eur\":-0.01,"),
                    HasSubstr("\"today_since_utc\":\"2023-03-26T22:00:00Z\"")));
  for (int tick = 1; tick <= 3; ++tick) {
    append(tick, 3'000);
    const std::string memory = text_of_file(settings_.memory);
    round_of_its_own(settings_, kNow + 120 * tick);
    static_cast<void>(folder_.write("notify/told.json", memory));  // killed before it could keep it
  }
  for (int tick = 4; tick <= 6; ++tick) append(tick, -6'000);
  round_of_its_own(settings_, kNow + 720);
  EXPECT_THAT(state("\"discharged_kwh\":0.6"),
              AllOf(HasSubstr("\"charged_kwh\":0.300,"), HasSubstr("\"earned_today_eur\":0.02,")));
}

TEST_F(Mqtt, TheDayIsTold) {
  Broker broker(folder_, port());
  RingLog ring;
  FileMessage error;
  ASSERT_TRUE(ring.open(settings_.ring.c_str(), 2'000, error)) << error.c_str();
  const auto append = [&](std::int64_t utc_s) {
    CycleRecord record{.utc_s = utc_s, .mode = Mode::kRunning};
    record.has_measurement = record.price.has_row = true;
    record.measurement.power_w = -3'000;
    record.price = {.has_row = true, .minute_utc_s = utc_s - 60, .price_centi_eur_per_mwh = 10'000};
    ASSERT_TRUE(ring.append(record));
    set_status("ok", "", utc_s);
  };
  append(kNow);
  round_of_its_own(settings_, kNow);
  append(kNow + 120);
  append(kNow + 86'400);
  round_of_its_own(settings_, kNow + 86'400);
  Listener later(port(), "bess/v1/garage/day");
  EXPECT_THAT(later.await("/day", "earned_eur"),
              HasSubstr("\"date\":\"2023-03-27\",\"earned_eur\":0.02,"));
}

/// A hold and its end by the broker, where the key allows it: one at a time, in order, never one
/// that was given when nobody was here, and nothing else.
TEST_F(Mqtt, HoldsAreOrderedWhereTheKeyAllowsIt) {
  Broker broker(folder_, port());
  Listener all(port(), "#");
  all.publish("bess/v1/garage/hold/set", "ON", true);  // retained, before the notifier comes
  ASSERT_EQ(all.await("/hold/set", "ON"), "ON");
  const std::string calls = folder_.file("calls");
  const std::string program =
      write_script("ordered", "[ $1 = hold ] && { echo \"$@\" >>" + calls +
                                  "; [ $2 != 9999 ]; exit; }; cat " + folder_.file("status.json"));
  const std::string config = folder_.write(
      "edge.toml", "[battery]\nname = \"garage\"\npower_w = 5000\n[notify]\nprogram = \"" +
                       program + "\"\nmqtt_host = \"127.0.0.1\"\nmqtt_port = " +
                       std::to_string(port()) + "\nmqtt_orders = true\nmqtt_hold_minutes = 90\n");
  ChildProcess notify({BESS_NOTIFY_PROGRAM, "--config", config});
  EXPECT_THAT(all.await("/config", "_hold\""),
              AllOf(HasSubstr("\"min\":-5000,\"max\":5000"),
                    HasSubstr("\"command_topic\":\"bess/v1/garage/hold_power/set\"")));
  ASSERT_NE(all.await("/state", "\"hold_power_w\":0"), "");
  all.publish("bess/v1/garage/hold_power/set", "-1500");
  EXPECT_NE(all.await("/state", "\"hold_power_w\":-1500"), "") << "noted for the next hold";
  for (const char* bad : {"on", "", "ON; rm -rf /", "{\"power_w\":1}"}) {
    all.publish("bess/v1/garage/hold/set", bad);
    all.publish("bess/v1/garage/hold_power/set", bad);
  }
  all.publish("bess/v1/garage/hold_power/set", std::string(100'000, '9'));
  all.publish("bess/v1/garage/release/set", "ON");
  const auto await_calls = [&](const std::string& wanted) {
    for (int i = 0; i < 500 && text_of_file(calls) != wanted; ++i) {
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    return text_of_file(calls);
  };
  const std::string end = " --config " + config + "\n";
  std::this_thread::sleep_for(std::chrono::milliseconds(300));  // eight wait at most
  all.publish("bess/v1/garage/hold/set", "ON");
  EXPECT_EQ(await_calls("hold -1500 --for 90m" + end), "hold -1500 --for 90m" + end);
  all.publish("bess/v1/garage/hold/set", "OFF");
  const std::string both = "hold -1500 --for 90m" + end + "hold --release" + end;
  EXPECT_EQ(await_calls(both), both);
}

/// Without the key nobody is heard, and a broker that lets in anybody gives no such right.
TEST_F(Mqtt, NothingIsOrderedOtherwise) {
  HoldDesk desk(60, 4'000);
  EXPECT_EQ(desk.follow({kHoldPowerTopic, "-7"}, true).words,
            (std::vector<std::string>{"hold", "-7", "--for", "60m"}))
      << "of a hold in force at once";
  for (const char* power : {"1.5", "1e3", "", " 1", "99999999999", "4001", "-4001", "NaN"}) {
    EXPECT_NE(desk.follow({kHoldPowerTopic, power}, true).complaint, "") << power;
  }
  EXPECT_EQ(desk.power_w(), -7);
  const std::string config =
      folder_.write("edge.toml", "[notify]\nmqtt_host = \"10.0.0.1\"\nmqtt_orders = true\n");
  NotifySettings settings;
  std::string error;
  EXPECT_FALSE(load_notify_settings(config, settings, error));
  EXPECT_THAT(error, HasSubstr("mqtt_orders needs mqtt_user"));
}

/// The last will: a notifier that is killed is told of by the broker.
TEST_F(Mqtt, AKilledNotifierIsOffline) {
  Broker broker(folder_, port());
  const std::string config = folder_.write(
      "edge.toml",
      "[battery]\nname = \"garage\"\n[notify]\nevery_s = 1\nprogram = \"" + settings_.program +
          "\"\nmqtt_host = \"127.0.0.1\"\nmqtt_port = " + std::to_string(port()) + "\n");
  Listener all(port(), "#");
  ChildProcess notify({BESS_NOTIFY_PROGRAM, "--config", config});
  EXPECT_EQ(all.await("/status", "online"), "online");
  notify.signal(SIGKILL);
  EXPECT_EQ(all.await("/status", "offline"), "offline");
}

class Program : public Rounds {};

TEST_F(Program, CommandLine) {
  const std::string config = folder_.write("edge.toml", "[battery]\nname = \"garage\"\n[notify]\n");
  const auto run = [](std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), BESS_NOTIFY_PROGRAM);
    ChildProcess child(arguments);
    const std::string text = child.read_all();
    return std::pair(child.wait(), text);
  };
  EXPECT_EQ(run({"--nonsense"}).first, 2);
  EXPECT_EQ(run({"--config"}).first, 2);
  EXPECT_EQ(run({"--help"}).first, 0);
  EXPECT_EQ(run({"--config", "/no/such"}).first, 1);
  EXPECT_EQ(run({"--config", config, "--check"}),
            std::pair(0, "node       garage, every 30 s, told after 300 s\nasks       " +
                             std::filesystem::path(BESS_NOTIFY_PROGRAM).parent_path().string() +
                             "/bess-edge status --config " + config +
                             "\ncommand    none\nmqtt       none\n"));
  EXPECT_THAT(run({"--config", config, "--once"}).second, HasSubstr("names no way"));
}

TEST_F(Program, ATestMessageGoesByEveryWayAndSaysWhichFails) {
  use_command();
  const std::string keys = "[notify]\ncommand = '";
  const std::string good = folder_.write("good.toml", keys + settings_.command + "'\n");
  ChildProcess sent({BESS_NOTIFY_PROGRAM, "--config", good, "--test"});
  EXPECT_EQ(sent.read_all(), "bess-notify: command: sent\n");
  EXPECT_EQ(sent.wait(), 0);
  EXPECT_THAT(told(), HasSubstr("test: bess-notify can reach you by command"));
  const std::string bad = folder_.write("bad.toml", keys + "/bin/false'\n");
  ChildProcess refused({BESS_NOTIFY_PROGRAM, "--config", bad, "--test"});
  EXPECT_THAT(refused.read_all(), HasSubstr("command: failed with exit code 1"));
  EXPECT_EQ(refused.wait(), 1);
}

TEST_F(Program, SigtermEndsItBetweenRounds) {
  const std::string config = folder_.write(
      "edge.toml", "[notify]\nevery_s = 3600\nprogram = \"" + settings_.program + "\"\n");
  ChildProcess notify({BESS_NOTIFY_PROGRAM, "--config", config});
  EXPECT_THAT(notify.read_line(), HasSubstr("names no way"));
  EXPECT_THAT(notify.read_line(), HasSubstr("started"));
  notify.signal(SIGTERM);
  EXPECT_THAT(notify.read_all(), HasSubstr("stopped"));
  EXPECT_EQ(notify.wait(), 0);
}

}  // namespace
}  // namespace bess
