// Site for tests of whole rounds: no controller, its status is a file and its alert command writes
// into another.
#pragma once

#include <gtest/gtest.h>
#include <signal.h>

#include <filesystem>
#include <string>

#include "edge/companions/notify/notifier.h"
#include "shared/utc_text.h"
#include "tests/support/mqtt_broker.h"
#include "tests/support/program_output.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/tokens.h"

namespace bess {

inline constexpr std::int64_t kNow = 1'679'875'320;  // 2023-03-27T00:02:00Z, 02:02 in Brussels

class Rounds : public ::testing::Test {
 protected:
  Rounds() {
    signal(SIGPIPE, SIG_IGN);  // as the program does: a command need not read its input
    settings_.config_path = "edge.toml";
    settings_.program = folder_.write_script("bess-edge", "cat " + folder_.file("status.json"));
    settings_.memories = {folder_.file("notify/told.json")};
    settings_.name = "garage";
    settings_.id = "garage";
    settings_.after_s = 300;
    set_status("ok");
  }

  void use_command() {
    settings_.command = "{ echo \"Subject: $BESS_TITLE\"; cat; } >>" + folder_.file("told");
  }
  /// `alerts`: their codes.
  void set_status(const std::string& health, const std::vector<std::string>& alerts = {},
                  std::int64_t utc_s = kNow) {
    Json list = Json::list();
    for (const std::string& code : alerts) {
      list.add(Json::object({{"code", code}, {"line", "WARN " + code + ": found"}}));
    }
    const Json status = Json::object(
        {{"health", health},
         {"alerts", std::move(list)},
         {"last", Json::object(
                      {{"utc", utc_text(utc_s).view()}, {"mode", "safe"}, {"reason", "no_price"}})},
         {"totals", Json::object({{"cycles", 9}})}});
    const std::string beside = folder_.write("status.new", status.line());
    std::filesystem::rename(beside, folder_.file("status.json"));  // a round may look at any time
  }
  /// The retry queue as stored.
  [[nodiscard]] std::deque<Message> pending() const {
    std::vector<std::string> losses;
    return read_notifier_state(settings_.memories, losses).pending;
  }
  [[nodiscard]] std::string told() const { return text_of_file(folder_.file("told")); }

  const TemporaryFolder folder_;
  NotifySettings settings_;
};

/// Output of one run of the program.
inline ProgramOutput notify_output(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), BESS_NOTIFY_PROGRAM);
  return answer_of(std::move(arguments));
}

/// A round, and the result of the channels.
inline void whole_round(Notifier& notifier, std::int64_t now_utc_s) {
  notifier.run_round(now_utc_s);
  EXPECT_TRUE(notifier.finish(std::chrono::minutes(2)));
}

/// The same by a notifier that has just started, and ends.
inline void round_of_its_own(const NotifySettings& settings, std::int64_t now_utc_s) {
  Notifier notifier(settings);
  whole_round(notifier, now_utc_s);
}

class Mqtt : public Rounds {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists(Broker::kProgram)) GTEST_SKIP() << "mosquitto is not installed";
    settings_.mqtt = {
        .host = "127.0.0.1", .port = free_port(), .ca_file = "", .user = "", .password = ""};
    settings_.after_s = 0;
  }
  [[nodiscard]] std::uint16_t port() const {
    return static_cast<std::uint16_t>(settings_.mqtt.port);
  }
};

}  // namespace bess
