// Whole rounds of the notifier: a status that changes, a mailer that is a script, a webhook's server and a real
// broker on loopback. Time is an argument.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mosquitto.h>
#include <signal.h>
#include <sys/stat.h>

#include <chrono>
#include <condition_variable>
#include <filesystem>
#include <mutex>
#include <thread>

#include "edge/log/ring_log.h"
#include "edge/notify/notifier.h"
#include "shared/host/child_process.h"
#include "shared/local_time.h"
#include "shared/utc_text.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test_server.h"

namespace bess {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr std::int64_t kNow = 1'679'875'320;  // 2023-03-27T00:02:00Z, 02:02 in Brussels

std::size_t count_of(const std::string& text, const std::string& piece) {
  std::size_t count = 0;
  for (std::size_t at = text.find(piece); at != text.npos; at = text.find(piece, at + 1)) ++count;
  return count;
}

/// A site without a controller: its status is a file, its mailer writes into another.
class Rounds : public ::testing::Test {
 protected:
  Rounds() {
    signal(SIGPIPE, SIG_IGN);  // as the program does: a mailer need not read what it is given
    set_market_time_zone();
    settings_.config_path = "edge.toml";
    settings_.program = write_script("bess-edge", "cat " + folder_.file("status.json"));
    settings_.ring = folder_.file("decisions.ring");
    settings_.memory = folder_.file("notify/told.json");
    settings_.node = "garage";
    settings_.after_s = 300;
    set_status("ok");
  }

  std::string write_script(const char* name, const std::string& body) {
    const std::string path = folder_.write(name, "#!/bin/sh\n" + body + "\n");
    EXPECT_EQ(chmod(path.c_str(), 0755), 0);
    return path;
  }
  void use_mail() {
    settings_.mail_to = "a@b.example";
    settings_.sendmail = write_script("sendmail", "cat >>" + folder_.file("mails"));
  }
  void set_status(const std::string& health, const std::string& reasons = "",
                  std::int64_t utc_s = kNow) {
    static_cast<void>(folder_.write(
        "status.json", R"({"health": ")" + health + R"(", "health_reasons": [)" + reasons +
                           R"(], "last": {"utc": ")" + utc_text(utc_s).c_str() +
                           R"(", "mode": "safe", "reason": "no_price"},)" +
                           R"( "totals": {"cycles": 9}})"));
  }
  [[nodiscard]] std::string mails() const { return text_of_file(folder_.file("mails")); }

  const TemporaryFolder folder_;
  NotifySettings settings_;
};

constexpr const char* kReason = R"("WARN: mode is safe, reason no_price")";

TEST_F(Rounds, AnAlarmIsMailedOnceAndItsEndOnceAlsoOverRestarts) {
  use_mail();
  set_status("degraded", kReason);
  for (int s = 0; s <= 1'200; s += 30) Notifier(settings_).run_round(kNow + s);  // each a restart
  EXPECT_EQ(count_of(mails(), "Subject: "), 1U);
  EXPECT_THAT(mails(),
              HasSubstr("Subject: [bess garage] ALARM: WARN: mode is safe, reason no_price"));
  set_status("ok");
  for (int s = 1'230; s <= 2'400; s += 30) Notifier(settings_).run_round(kNow + s);
  EXPECT_EQ(count_of(mails(), "Subject: "), 2U);
  EXPECT_THAT(mails(), HasSubstr("over: WARN: mode is safe, reason no_price (lasted 20 min)"));
}

TEST_F(Rounds, AControllerThatIsGoneIsAnAlarm) {
  use_mail();
  settings_.program = "/no/such";
  Notifier notifier(settings_);
  notifier.run_round(kNow);
  notifier.run_round(kNow + 300);
  EXPECT_THAT(mails(), HasSubstr("ALARM: /no/such cannot be started"));
}

TEST_F(Rounds, WhatTheMailerRefusesIsTriedAgainAndGivenUpAfterThreeDays) {
  use_mail();
  settings_.sendmail = write_script("sendmail", "exit 75");
  settings_.after_s = 0;
  set_status("degraded", kReason);
  Notifier(settings_).run_round(kNow);
  EXPECT_EQ(read_told(settings_.memory).pending.size(), 1U);
  use_mail();
  Notifier(settings_).run_round(kNow + 30);
  EXPECT_EQ(count_of(mails(), "Subject: "), 1U);
  EXPECT_TRUE(read_told(settings_.memory).pending.empty());

  settings_.sendmail = write_script("sendmail", "exit 75");
  set_status("ok");
  Notifier(settings_).run_round(kNow + 60);
  Notifier(settings_).run_round(kNow + 60 + 3 * 86'400);
  EXPECT_EQ(read_told(settings_.memory).pending.size(), 1U);
  Notifier(settings_).run_round(kNow + 61 + 3 * 86'400);
  EXPECT_TRUE(read_told(settings_.memory).pending.empty());
}

TEST_F(Rounds, TheDayIsToldWhenTheNextBegins) {
  use_mail();
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
  append(kNow);
  Notifier(settings_).run_round(kNow);
  EXPECT_EQ(mails(), "");  // days before the first look were not watched
  for (int i = 1; i < 30; ++i) append(kNow + 120 * i);
  Notifier(settings_).run_round(kNow + 4'000);
  EXPECT_EQ(mails(), "");
  append(kNow + 86'400);
  Notifier(settings_).run_round(kNow + 86'400);
  Notifier(settings_).run_round(kNow + 86'430);
  EXPECT_EQ(count_of(mails(), "Subject: "), 1U);
  EXPECT_THAT(mails(),
              HasSubstr("day 2023-03-27: +0.80 EUR (estimate: measured power at the logged "
                        "price, 30 of 30 cycles, no fees), charged 0.0 kWh, discharged 4.0 "
                        "kWh, 0.00 full cycles, 0 interventions"));
}

TEST_F(Rounds, AWebhookIsPostedAsJsonAndNothingButASuccessCounts) {
  std::mutex mutex;
  std::vector<std::string> bodies;
  std::atomic<int> code = 500;
  TestServer server([&](TestConnection& connection, const std::string& request) {
    EXPECT_THAT(request, AllOf(HasSubstr("POST /hook HTTP/1.1\r\n"),
                               HasSubstr("Content-Type: application/json\r\n"),
                               HasSubstr("X-Key: secret\r\n")));
    const std::size_t at = request.find("Content-Length: ");
    std::string body;
    const bool whole = connection.read_bytes(std::stoul(request.substr(at + 16)), body);
    EXPECT_TRUE(whole);
    const std::lock_guard lock(mutex);
    bodies.push_back(body);
    return connection.answer("", "HTTP/1.1 " + std::to_string(code) + " x\r\n");
  });
  settings_.webhook_url = "http://127.0.0.1:" + std::to_string(server.port()) + "/hook";
  settings_.webhook_headers = "X-Key: secret";
  settings_.after_s = 0;
  set_status("degraded", kReason);
  Notifier notifier(settings_);
  notifier.run_round(kNow);
  notifier.run_round(kNow + 30);
  code = 204;
  notifier.run_round(kNow + 60);
  notifier.run_round(kNow + 90);
  const std::lock_guard lock(mutex);
  ASSERT_EQ(bodies.size(), 3U);  // two refused, one taken
  EXPECT_EQ(bodies[2],
            R"({"node":"garage","kind":"alarm","key":"not running: no_price",)"
            R"("text":"WARN: mode is safe, reason no_price","utc":"2023-03-27T00:02:00Z",)"
            R"("since_utc":"2023-03-27T00:02:00Z"})");
}

/// Debian's broker on a free port of loopback.
class Broker {
 public:
  static constexpr const char* kProgram = "/usr/sbin/mosquitto";

  Broker(const TemporaryFolder& folder, std::uint16_t port) : port_(port) {
    config_ = folder.write("mosquitto.conf", "listener " + std::to_string(port) +
                                                 " 127.0.0.1\nallow_anonymous true\n");
    start();
  }
  static std::uint16_t free_port() {
    sockaddr_in address = loopback_address();
    close(bind_socket(address));
    return ntohs(address.sin_port);
  }
  /// Returns once it listens, which takes a busy machine seconds.
  void start() {
    process_ = std::make_unique<ChildProcess>(std::vector<std::string>{kProgram, "-c", config_});
    for (int tries = 0; tries < 500 && !listens(); ++tries) {
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
  }
  void stop() { process_.reset(); }
  [[nodiscard]] std::uint16_t port() const { return port_; }

 private:
  [[nodiscard]] bool listens() const {
    const sockaddr_in address{.sin_family = AF_INET,
                              .sin_port = htons(port_),
                              .sin_addr = {.s_addr = htonl(INADDR_LOOPBACK)},
                              .sin_zero = {}};
    const int fd = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    const bool is_open =
        connect(fd, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0;
    close(fd);
    return is_open;
  }

  std::uint16_t port_;
  std::string config_;
  std::unique_ptr<ChildProcess> process_;
};

/// Everything that is published below a topic, as it comes.
class Listener {
 public:
  Listener(std::uint16_t port, const char* pattern) : pattern_(pattern) {
    mosquitto_lib_init();
    client_ = mosquitto_new(nullptr, true, this);
    mosquitto_connect_callback_set(client_, [](mosquitto* client, void* self, int) {
      mosquitto_subscribe(client, nullptr, static_cast<Listener*>(self)->pattern_, 1);
    });
    mosquitto_subscribe_callback_set(client_, [](mosquitto*, void* self, int, int, const int*) {
      static_cast<Listener*>(self)->begin();
    });
    mosquitto_message_callback_set(client_,
                                   [](mosquitto*, void* self, const mosquitto_message* message) {
                                     static_cast<Listener*>(self)->take(*message);
                                   });
    mosquitto_loop_start(client_);
    mosquitto_connect_async(client_, "127.0.0.1", port, 60);
    // What is not retained reaches only who listens already.
    std::unique_lock lock(mutex_);
    changed_.wait_for(lock, std::chrono::seconds(30), [&] { return is_listening_; });
  }
  Listener(const Listener&) = delete;
  Listener& operator=(const Listener&) = delete;
  ~Listener() {
    mosquitto_disconnect(client_);
    mosquitto_loop_stop(client_, false);
    mosquitto_destroy(client_);
    mosquitto_lib_cleanup();
  }

  /// Waits for a payload with this piece on a topic that ends so; empty after half a minute.
  std::string await(const std::string& topic_end, const std::string& piece) {
    std::unique_lock lock(mutex_);
    std::string found;
    changed_.wait_for(lock, std::chrono::seconds(30), [&] {
      for (const auto& [topic, payload] : messages_) {
        const bool is_it = topic.ends_with(topic_end) && payload.find(piece) != payload.npos;
        if (is_it) found = payload;
      }
      return !found.empty();
    });
    return found;
  }
  std::size_t count(const std::string& topic_end) {
    const std::lock_guard lock(mutex_);
    std::size_t count = 0;
    for (const auto& message : messages_) count += message.first.ends_with(topic_end) ? 1 : 0;
    return count;
  }

 private:
  void begin() {
    const std::lock_guard lock(mutex_);
    is_listening_ = true;
    changed_.notify_all();
  }
  void take(const mosquitto_message& message) {
    const std::lock_guard lock(mutex_);
    messages_.emplace_back(message.topic,
                           std::string(static_cast<const char*>(message.payload),
                                       static_cast<std::size_t>(message.payloadlen)));
    changed_.notify_all();
  }

  const char* pattern_;
  mosquitto* client_;
  bool is_listening_ = false;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<std::pair<std::string, std::string>> messages_;
};

class Mqtt : public Rounds {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists(Broker::kProgram)) GTEST_SKIP() << "mosquitto is not installed";
    settings_.mqtt = {.host = "127.0.0.1",
                      .port = Broker::free_port(),
                      .ca_file = "",
                      .user = "",
                      .password = "",
                      .discovery_prefix = "homeassistant"};
    settings_.after_s = 0;
  }
  [[nodiscard]] std::uint16_t port() const {
    return static_cast<std::uint16_t>(settings_.mqtt.port);
  }
};

TEST_F(Mqtt, TheStateIsRetainedTheEventComesOnceAndTheEndIsOffline) {
  Broker broker(folder_, port());
  Listener all(port(), "#");
  {
    set_status("degraded", kReason);
    Notifier notifier(settings_);
    notifier.run_round(kNow);
    notifier.run_round(kNow + 30);
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
  notifier.run_round(kNow);  // nobody listens
  EXPECT_EQ(read_told(settings_.memory).pending.size(), 1U);
  Broker broker(folder_, port());
  {
    Listener all(port(), "#");
    EXPECT_EQ(all.await("/status", "online"), "online");
    EXPECT_NE(all.await("/state", "health"), "");
    notifier.run_round(kNow + 30);
    EXPECT_NE(all.await("/event", "alarm"), "");
    EXPECT_TRUE(read_told(settings_.memory).pending.empty());
  }
  broker.stop();
  broker.start();
  Listener again(port(), "#");
  EXPECT_EQ(again.await("/status", "online"), "online");
  EXPECT_NE(again.await("/config", "components"), "");
}

/// The last will: a notifier that is killed is told of by the broker.
TEST_F(Mqtt, AKilledNotifierIsOffline) {
  Broker broker(folder_, port());
  const std::string config = folder_.write(
      "edge.toml", "[notify]\nnode = \"garage\"\nevery_s = 1\nprogram = \"" + settings_.program +
                       "\"\nmqtt_host = \"127.0.0.1\"\nmqtt_port = " + std::to_string(port()) +
                       "\n");
  Listener all(port(), "#");
  ChildProcess notify({BESS_NOTIFY_PROGRAM, "--config", config});
  EXPECT_EQ(all.await("/status", "online"), "online");
  notify.signal(SIGKILL);
  EXPECT_EQ(all.await("/status", "offline"), "offline");
}

class Program : public Rounds {};

TEST_F(Program, CommandLine) {
  const std::string config = folder_.write("edge.toml", "[notify]\nnode = \"garage\"\n");
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
                             "\nmail       none\nwebhook    none\nmqtt       none\n"));
  EXPECT_THAT(run({"--config", config, "--once"}).second, HasSubstr("names no way"));
}

TEST_F(Program, ATestMessageGoesByEveryWayAndSaysWhichFails) {
  use_mail();
  const std::string keys = "[notify]\nmail_to = \"a@b.example\"\nsendmail = \"";
  const std::string good = folder_.write("good.toml", keys + settings_.sendmail + "\"\n");
  ChildProcess sent({BESS_NOTIFY_PROGRAM, "--config", good, "--test"});
  EXPECT_EQ(sent.read_all(), "bess-notify: mail: sent\n");
  EXPECT_EQ(sent.wait(), 0);
  EXPECT_THAT(mails(), HasSubstr("test: bess-notify can reach you by mail"));
  const std::string bad = folder_.write("bad.toml", keys + "/bin/false\"\n");
  ChildProcess refused({BESS_NOTIFY_PROGRAM, "--config", bad, "--test"});
  EXPECT_THAT(refused.read_all(), HasSubstr("/bin/false failed with exit code 1"));
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
