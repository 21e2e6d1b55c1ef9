#include "edge/prices/record/price_reader.h"

#include <poll.h>
#include <sys/inotify.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>

#include "edge/records/log/atomic_file.h"
#include "shared/units_and_limits.h"

namespace bess {
namespace {

constexpr std::int64_t kSilentS = 3 * kSecondsPerStep;  ///< it publishes in every cycle
constexpr std::int64_t kClockToleranceS = 5;

/// Milliseconds until an instant, rounded up, from 0 to `most`.
int ms_until(std::int64_t monotonic_ns, int most) {
  const std::int64_t left_ns = monotonic_ns - clock_ns(CLOCK_MONOTONIC);
  return static_cast<int>(std::clamp<std::int64_t>((left_ns + 999'999) / 1'000'000, 0, most));
}

}  // namespace

PriceReader::PriceReader(const Settings& settings, const ScaledClock& clock)
    : settings_(settings), clock_(clock), notices_(inotify_init1(IN_NONBLOCK | IN_CLOEXEC)) {
  exchange_.model = settings.model;
  if (settings.model != nullptr) model_hash_ = settings.model->hash();
}

void PriceReader::request(std::int64_t minute_utc_s, std::int64_t, std::int64_t) {
  wanted_minute_utc_s_ = minute_utc_s;
}

template <typename IsThere>
bool PriceReader::await(std::int64_t until_monotonic_ns, const IsThere& is_there) {
  while (true) {
    read();
    if (reading_ == Status::kOk && is_there()) return true;
    if (clock_ns(CLOCK_MONOTONIC) >= until_monotonic_ns) return false;
    await_change(until_monotonic_ns);
  }
}

bool PriceReader::wait(std::int64_t until_monotonic_ns) {
  return await(until_monotonic_ns, [this] {
    return published_.served_minute_utc_s >= wanted_minute_utc_s_ ||
           published_.row.minute_utc_s >= wanted_minute_utc_s_;
  });
}

PriceReport PriceReader::latest() {
  read();
  PriceReport report = newest_.report();
  const std::int64_t silent_ns = clock_ns(CLOCK_MONOTONIC) - published_.written_monotonic_ns;
  const bool is_silent = silent_ns > clock_.wall_ns(kSilentS * kNanosecondsPerSecond);
  if (reading_ != Status::kOk) {
    report.status = reading_;
  } else if (is_silent) {
    report.status = Status::kNoFetcher;
  }
  return report;
}

Status PriceReader::first_answer(std::int64_t patience_ns) {
  const bool is_there =
      await(clock_ns(CLOCK_MONOTONIC) + patience_ns, [&] { return published_.answers > 0; });
  return is_there ? refusal_of(published_) : latest().status;
}

PublishedHistory PriceReader::await_history(std::int64_t patience_ns) {
  const bool is_there =
      await(clock_ns(CLOCK_MONOTONIC) + patience_ns, [&] { return published_.history.is_done; });
  if (is_there) return published_.history;
  return {.status = reading_ == Status::kOk ? Status::kTimeout : reading_};
}

OutlookExchange* PriceReader::await_outlook(std::int64_t patience_ns) {
  if (settings_.model == nullptr) return nullptr;
  static_cast<void>(
      await(clock_ns(CLOCK_MONOTONIC) + patience_ns, [&] { return taken_outlook_ > 0; }));
  return &exchange_;
}

void PriceReader::await_change(std::int64_t until_monotonic_ns) {
  constexpr int kUnwatchedMs = 10, kWatchedMs = 1'000;
  if (notices_.get() >= 0 && watch_ < 0) {
    watch_ =
        inotify_add_watch(notices_.get(), folder_of(settings_.path.c_str()).c_str(), IN_MOVED_TO);
    if (watch_ >= 0) return;  // the file may have changed before the watch
  }
  pollfd waiting{.fd = watch_ < 0 ? -1 : notices_.get(), .events = POLLIN, .revents = 0};
  const int most_ms = watch_ < 0 ? kUnwatchedMs : kWatchedMs;
  if (poll(&waiting, 1, ms_until(until_monotonic_ns, most_ms)) <= 0) return;
  alignas(inotify_event) char events[1'024];
  for (ssize_t size; (size = ::read(notices_.get(), events, sizeof events)) > 0;) {
    for (ssize_t at = 0; at < size;) {
      const auto* const event = reinterpret_cast<const inotify_event*>(events + at);
      if ((event->mask & IN_IGNORED) != 0) watch_ = -1;  // the folder was replaced
      at += static_cast<ssize_t>(sizeof *event + event->len);
    }
  }
}

void PriceReader::read() {
  const ssize_t size = read_beginning(settings_.path.c_str(), bytes_, SymlinkPolicy::kRefused);
  if (size < 0) {
    reading_ = Status::kNoFetcher;
    return;
  }
  const std::span<const char> bytes(bytes_, static_cast<std::size_t>(size));
  PublishedPrices published;
  reading_ = decode_published(bytes, published);
  if (reading_ != Status::kOk) return;
  if (settings_.model != nullptr && published.model_hash != model_hash_) {
    reading_ = Status::kOtherVersion;  // its plan is of another student
    return;
  }
  take_plan(bytes, published.outlook_number);
  take(published);
}

void PriceReader::take_plan(std::span<const char> bytes, std::int64_t outlook_number) {
  const bool is_new =
      settings_.model != nullptr && outlook_number != 0 && outlook_number != taken_outlook_;
  if (!is_new || decode_outlook(bytes, outlook_) != Status::kOk) return;
  taken_outlook_ = outlook_number;
  static_cast<PublishedOutlook&>(exchange_) = outlook_;
}

/// Rejects rows that a healthy bess-prices never publishes.
Status PriceReader::refusal_of(const PublishedPrices& published) const {
  if (published.status != Status::kOk) return published.status;
  const PriceRow& row = published.row;
  const std::int64_t now_utc_s = utc_seconds(clock_);
  const bool is_row =
      row.minute_utc_s > 0 && row.minute_utc_s % 60 == 0 &&
      row.minute_utc_s + 60 <= now_utc_s + kClockToleranceS &&
      std::abs(std::int64_t{row.price_centi_eur_per_mwh}) <= kPlausiblePriceMaxCentiEurPerMwh;
  return is_row ? Status::kOk : Status::kImplausible;
}

void PriceReader::take(const PublishedPrices& published) {
  published_ = published;
  // A price without any plan cannot be decided on.
  const bool lacks_plan = settings_.model != nullptr && taken_outlook_ == 0;
  if (lacks_plan || published.answers == 0 || published.answers == taken_answers_) return;
  taken_answers_ = published.answers;
  // A receipt time in the future is wrong: it counts as now at most.
  const std::int64_t received_ns =
      std::min(published.received_monotonic_ns, clock_ns(CLOCK_MONOTONIC));
  newest_.publish(refusal_of(published), published.row, received_ns, published.fetch_us);
}

}  // namespace bess
