#include "edge/prices/price_feed.h"

#include <chrono>
#include <cstdlib>

namespace bess {
namespace {

std::chrono::steady_clock::time_point steady_at(std::int64_t monotonic_ns) {
  return std::chrono::steady_clock::time_point(std::chrono::nanoseconds(monotonic_ns));
}

}  // namespace

std::string_view price_status_text(Status status) {
  switch (status) {
    case Status::kNotConnected:
      return "no connection, or it was cut (are host and port of url right, is the network up?)";
    case Status::kTimeout:
      return "no complete answer in time (see timeout_ms)";
    default:
      return status_text(status);
  }
}

PriceFeed::PriceFeed(const PriceFeedSettings& settings, const ScaledClock& clock)
    : settings_(settings),
      clock_(clock),
      http_(settings.http),
      newest_(settings.step_flag_centi_eur_per_mwh, settings.hold_flagged_step) {
  thread_.start(
      [](void* feed) -> void* {
        static_cast<PriceFeed*>(feed)->run();
        return nullptr;
      },
      this);
}

PriceFeed::~PriceFeed() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

void PriceFeed::request(std::int64_t minute_utc_s, std::int64_t start_monotonic_ns,
                        std::int64_t deadline_monotonic_ns) {
  {
    const std::lock_guard lock(mutex_);
    job_ = {.minute_utc_s = minute_utc_s,
            .start_ns = start_monotonic_ns,
            .deadline_ns = deadline_monotonic_ns,
            .number = job_.number + 1};
  }
  changed_.notify_all();
}

bool PriceFeed::wait(std::int64_t until_monotonic_ns) {
  std::unique_lock lock(mutex_);
  return changed_.wait_until(lock, steady_at(until_monotonic_ns),
                             [this] { return served_number_ == job_.number; });
}

PriceReport PriceFeed::latest() {
  const std::lock_guard lock(mutex_);
  return newest_.report();
}

void PriceFeed::run() {
  while (true) {
    Job job;
    {
      std::unique_lock lock(mutex_);
      changed_.wait(lock, [this] { return stopping_ || served_number_ != job_.number; });
      if (stopping_) return;
      job = job_;
    }
    serve(job);
    {
      const std::lock_guard lock(mutex_);
      served_number_ = job.number;
    }
    changed_.notify_all();
  }
}

void PriceFeed::serve(const Job& job) {
  const std::int64_t spacing_ns =
      clock_.wall_ns(settings_.wait_s * kNanosecondsPerSecond / settings_.requests_per_cycle);
  for (int i = 0; i < settings_.requests_per_cycle; ++i) {
    const std::int64_t start_ns = job.start_ns + i * spacing_ns;
    if ((i > 0 && start_ns >= job.deadline_ns) || !pause_until(start_ns)) return;
    const std::int64_t request_ns = clock_ns(CLOCK_MONOTONIC);
    PriceRow row;
    const Status status = fetch_once(row);
    publish(status, row, request_ns);
    if (status == Status::kOk && row.minute_utc_s >= job.minute_utc_s) return;
  }
}

/// False when the feed is being stopped.
bool PriceFeed::pause_until(std::int64_t until_ns) {
  std::unique_lock lock(mutex_);
  return !changed_.wait_until(lock, steady_at(until_ns), [this] { return stopping_; });
}

void PriceFeed::publish(Status status, const PriceRow& row, std::int64_t start_ns) {
  const std::int64_t now_ns = clock_ns(CLOCK_MONOTONIC);
  const std::lock_guard lock(mutex_);
  newest_.publish(status, row, now_ns, static_cast<std::int32_t>((now_ns - start_ns) / 1'000));
}

Status PriceFeed::fetch_once(PriceRow& row) {
  std::string_view body;
  const Status status = http_.get(body);
  if (status != Status::kOk) return status;
  return parse_newest_price(body, settings_.fields, clock_.now_utc_ns() / kNanosecondsPerSecond,
                            row);
}

Status PriceFeed::fetch_page(const char* url, std::int32_t timeout_ms, const PriceRowTaker& taker,
                             int& items) {
  items = 0;
  std::string_view body;
  const Status status = http_.get(url, timeout_ms, body);
  if (status != Status::kOk) return status;
  return parse_prices(body, settings_.fields, clock_.now_utc_ns() / kNanosecondsPerSecond, taker,
                      items);
}

}  // namespace bess
