// A way's outbox: what is owed waits in order in its queue, and its own thread sends it. However
// long a way takes to accept, to fail or to be silent, no other way waits, and no look at the
// controller.
//
//   add         owed from now on; nothing is sent yet, so that it can be kept in a file first
//   begin_round an attempt at everything that is owed; it ends with the first message that is not
//               taken
//
// The queue is bounded in number and in time. What had to go is counted, and the way is told how
// many before it is told anything else.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <functional>
#include <mutex>
#include <stop_token>
#include <string>
#include <thread>

#include "edge/notify/bell.h"
#include "edge/notify/message.h"

namespace bess {

/// Empty when the message was taken; else why not. Gives up soon once it is asked to stop.
using Channel = std::function<std::string(const Message&, const std::stop_token&)>;

/// Messages that were given up, untold.
struct Dropped {
  int count = 0;
  std::int64_t first_utc_s = 0;
  std::int64_t last_utc_s = 0;

  void add(const Message& message);
  /// `told` is what this was a while ago.
  void forget(const Dropped& told);
};

/// What a way has not taken yet, oldest first.
struct Owed {
  std::deque<Message> messages{};
  Dropped dropped{};
};

class Outbox {
 public:
  static constexpr std::size_t kMessagesMax = 200;
  static constexpr std::int64_t kPatienceS = 3 * 86'400;

  /// `taken` rings after each message that was taken.
  Outbox(std::string name, Channel way, Owed owed, const Bell& taken);
  Outbox(const Outbox&) = delete;
  Outbox& operator=(const Outbox&) = delete;
  ~Outbox() = default;  // jthread asks its thread to stop, and waits for it

  void add(const Message& message);
  void begin_round(std::int64_t now_utc_s);
  /// For good; cuts what is being sent, which stays owed.
  void stop();
  [[nodiscard]] Owed owed() const;
  /// False when the attempt goes on after that time.
  [[nodiscard]] bool wait_until_done(std::chrono::milliseconds patience) const;
  /// Once, past the queue: empty, or why it was not taken.
  [[nodiscard]] std::string send_now(const Message& message) const;

 private:
  void work(const std::stop_token& stop);
  void send_all(std::unique_lock<std::mutex>& lock, const std::stop_token& stop);
  void drop_oldest();
  void drop_too_old();
  void note(const std::string& trouble);

  const std::string name_;
  const Channel way_;
  const Bell& taken_;
  mutable std::mutex mutex_;
  mutable std::condition_variable_any changed_;
  Owed owed_;
  std::int64_t now_utc_s_ = 0;   ///< of the newest round
  bool is_due_ = false;          ///< an attempt is to be made, or is being made
  bool is_oldest_sent_ = false;  ///< the oldest message is on its way
  std::string trouble_;          ///< said once, not every round
  std::jthread thread_;          ///< last: it ends before what it uses
};

}  // namespace bess
