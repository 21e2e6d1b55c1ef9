#include "edge/notify/outbox.h"

#include <algorithm>
#include <utility>

#include "edge/notify/journal_line.h"
#include "shared/host/text.h"
#include "shared/utc_text.h"

namespace bess {
namespace {

Message told_of(const Dropped& dropped, const std::string& way, std::int64_t now_utc_s) {
  const std::string first = utc_text(dropped.first_utc_s).c_str();
  const std::string last = utc_text(dropped.last_utc_s).c_str();
  return {.kind = MessageKind::kDropped,
          .key = "dropped",
          .text = counted(static_cast<std::size_t>(dropped.count), "message") + " of " + first +
                  (dropped.count > 1 ? " to " + last : "") + " dropped: " + way +
                  " took none for too long; the journal of bess-notify has them",
          .utc_s = now_utc_s};
}

}  // namespace

void Dropped::add(const Message& message) {
  first_utc_s = count == 0 ? message.utc_s : std::min(first_utc_s, message.utc_s);
  last_utc_s = count == 0 ? message.utc_s : std::max(last_utc_s, message.utc_s);
  ++count;
}

void Dropped::forget(const Dropped& told) {
  count -= told.count;
  first_utc_s = told.last_utc_s;
  if (count == 0) *this = {};
}

Outbox::Outbox(std::string name, Channel way, Owed owed, const Bell& taken)
    : name_(std::move(name)), way_(std::move(way)), taken_(taken), owed_(std::move(owed)) {
  thread_ = std::jthread([this](const std::stop_token& stop) { work(stop); });
}

void Outbox::stop() {
  thread_.request_stop();
  thread_.join();
}

void Outbox::add(const Message& message) {
  const std::lock_guard lock(mutex_);
  owed_.messages.push_back(message);
  if (owed_.messages.size() > kMessagesMax) drop_oldest();
}

void Outbox::begin_round(std::int64_t now_utc_s) {
  const std::lock_guard lock(mutex_);
  now_utc_s_ = now_utc_s;
  is_due_ = true;
  changed_.notify_all();
}

Owed Outbox::owed() const {
  const std::lock_guard lock(mutex_);
  return owed_;
}

bool Outbox::wait_until_done(std::chrono::milliseconds patience) const {
  std::unique_lock lock(mutex_);
  return changed_.wait_for(lock, patience, [this] { return !is_due_; });
}

std::string Outbox::send_now(const Message& message) const { return way_(message, {}); }

void Outbox::work(const std::stop_token& stop) {
  std::unique_lock lock(mutex_);
  while (changed_.wait(lock, stop, [this] { return is_due_; })) {
    if (stop.stop_requested()) return;
    send_all(lock, stop);
    is_due_ = false;
    changed_.notify_all();
  }
}

/// A way that has just failed would only cost its time-out again: the rest waits for a round.
void Outbox::send_all(std::unique_lock<std::mutex>& lock, const std::stop_token& stop) {
  drop_too_old();
  while (owed_.dropped.count > 0 || !owed_.messages.empty()) {
    const Dropped dropped = owed_.dropped;
    is_oldest_sent_ = dropped.count == 0;
    const Message message =
        is_oldest_sent_ ? owed_.messages.front() : told_of(dropped, name_, now_utc_s_);
    lock.unlock();
    const std::string trouble = way_(message, stop);
    lock.lock();
    const bool is_oldest = std::exchange(is_oldest_sent_, false);
    if (!trouble.empty()) return stop.stop_requested() ? void() : note(trouble);
    if (is_oldest) owed_.messages.pop_front();
    if (!is_oldest) owed_.dropped.forget(dropped);
    trouble_.clear();
    taken_.ring();
  }
}

/// What is on its way just now is not given up.
void Outbox::drop_oldest() {
  const auto oldest = owed_.messages.begin() + (is_oldest_sent_ ? 1 : 0);
  owed_.dropped.add(*oldest);
  owed_.messages.erase(oldest);
}

void Outbox::drop_too_old() {
  std::erase_if(owed_.messages, [this](const Message& message) {
    const bool is_too_old = now_utc_s_ - message.utc_s > kPatienceS;
    if (is_too_old) owed_.dropped.add(message);
    return is_too_old;
  });
}

void Outbox::note(const std::string& trouble) {
  if (trouble == trouble_) return;
  say(JournalLevel::kWarning, trouble + "; tried again every round");
  trouble_ = trouble;
}

}  // namespace bess
