#include "edge/prices/fetch/price_fetcher.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <memory>
#include <vector>

#include "edge/core/control/policy.h"
#include "edge/records/log/atomic_file.h"
#include "shared/scaled_clock.h"

namespace bess {

PricePublisher::PricePublisher(std::string path) : path_(std::move(path)) {
  if (const OutlookModel* const model = student_outlook()) prices_.model_hash = model->hash();
}

void PricePublisher::publish_outlook(const OutlookExchange& exchange) {
  const std::lock_guard lock(mutex_);
  outlook_ = std::make_unique<PublishedOutlook>(exchange);
  ++prices_.outlook_number;
  write();
}

void PricePublisher::write() {
  prices_.written_monotonic_ns = clock_ns(CLOCK_MONOTONIC);
  std::vector<char> file(kPublishedBytesMax);
  const std::size_t size = encode_published(prices_, outlook_.get(), file);
  const bool is_written = replace_file(path_.c_str(), {file.data(), size});
  if (is_written == is_failing_) {
    const int cause = errno;
    say(is_written ? JournalLevel::kNotice : JournalLevel::kError,
        path_ + (is_written ? " can be written again"
                            : std::string(" cannot be written: ") + std::strerror(cause)));
  }
  is_failing_ = !is_written;
}

namespace {

constexpr std::int64_t kSecondNs = kNanosecondsPerSecond;
constexpr double kBusyPauseS = 60;  ///< if a busy server gives no time

FetchResult get(const EdgeConfig& config, const std::string& url, std::int32_t timeout_ms,
                const std::stop_token& stop) {
  return fetch(config.price.feed.http, url, timeout_ms, [&] { return stop.stop_requested(); });
}

PriceReply ask(const EdgeConfig& config, const std::string& url, UnitWatch& watch,
               const std::stop_token& stop) {
  const FetchResult fetched = get(config, url, config.price.feed.http.timeout_ms, stop);
  PriceReply reply{.status = fetched.status, .reason = fetched.reason, .wait_s = fetched.wait_s};
  if (fetched.status != Status::kOk) return reply;
  auto [status, rows, items] =
      parse_prices(fetched.body, config.price.feed.fields, utc_seconds(config.clock));
  reply.status = status;
  reply.passed_over = items - static_cast<int>(rows.size());
  std::ranges::stable_sort(rows, {}, &PriceRow::minute_utc_s);
  for (const PriceRow& row : rows) watch.observe(row);
  if (!rows.empty()) reply.newest = rows.back();
  return reply;
}

}  // namespace

PriceReply ask_price(const EdgeConfig& config, UnitWatch& watch, const std::stop_token& stop) {
  return ask(config, config.price.feed.http.url.c_str(), watch, stop);
}

PriceReply ask_first_price(const EdgeConfig& config, UnitWatch& watch,
                           const std::stop_token& stop) {
  PriceReply reply = ask(config, page_url(config.price.feed.http.url.view(), 0), watch, stop);
  const bool may_know_no_pages =
      reply.status == Status::kHttpError || reply.status == Status::kMalformed;
  return may_know_no_pages ? ask_price(config, watch, stop) : reply;
}

PublishedHistory find_history(const EdgeConfig& config, const std::stop_token& stop) {
  const auto fetch_page = [&](const char* url, std::int32_t timeout_ms) -> PriceAnswer {
    const FetchResult fetched = get(config, url, timeout_ms, stop);
    if (fetched.status != Status::kOk) return {.status = fetched.status};
    return parse_prices(fetched.body, config.price.feed.fields, utc_seconds(config.clock));
  };
  return fetch_history(config.price, config.clock, fetch_page,
                       [&] { return stop.stop_requested(); });
}

void PriceFetcher::run(const std::function<bool()>& is_over) {
  const std::int64_t begin_ns = clock_ns(CLOCK_MONOTONIC);
  static_cast<void>(publish(ask_first_price(config_, unit_, stop_), begin_ns));
  std::int64_t served_utc_s = 0;
  while (!stop_.stop_requested()) {
    const std::int64_t tick_utc_s = std::max(
        utc_seconds(config_.clock) / kSecondsPerStep * kSecondsPerStep, config_.clock.anchor_utc_s);
    // If started long after a tick, the initial request covered it.
    const bool is_waited_for =
        served_utc_s != 0 || utc_seconds(config_.clock) < tick_utc_s + kPriceWait_s;
    const bool is_new = tick_utc_s > served_utc_s && is_waited_for;
    if (is_new) serve(tick_utc_s);
    served_utc_s = tick_utc_s;
    if (is_over()) return;
    if (!sleep_until(tick_utc_s + kSecondsPerStep)) return;
  }
}

void PriceFetcher::serve(std::int64_t tick_utc_s) {
  const std::int64_t minute_utc_s = tick_utc_s - 60;
  if (utc_seconds(config_.clock) < busy_utc_s_)
    not_before_utc_s_ = 0;  // the clock was stepped back
  bool is_refused = false;
  bool is_found = false;
  for (int i = 0; i < kPriceRequests && !is_found; ++i) {
    const std::int64_t at_utc_s =
        std::max(tick_utc_s + timing_.first_s() + i * timing_.spacing_s(), not_before_utc_s_);
    if (at_utc_s >= tick_utc_s + kPriceWait_s && i > 0) break;
    if (at_utc_s >= tick_utc_s + kSecondsPerStep || !sleep_until(at_utc_s)) break;
    const std::int64_t begin_ns = clock_ns(CLOCK_MONOTONIC);
    const PriceReply answer = publish(ask_price(config_, unit_, stop_), begin_ns);
    is_found = answer.status == Status::kOk && answer.newest.minute_utc_s >= minute_utc_s;
    is_refused = is_refused || answer.status == Status::kServerBusy;
    const bool has_learnt = answer.status == Status::kOk || answer.status == Status::kNoRow;
    if (i == 0 && has_learnt) timing_.learn(is_found, false);
  }
  if (is_refused) timing_.learn(true, true);
  publisher_.publish([&](PublishedPrices& prices) { prices.served_minute_utc_s = minute_utc_s; });
}

PriceReply PriceFetcher::publish(PriceReply answer, std::int64_t begin_ns) {
  if (stop_.stop_requested()) return answer;
  const std::int64_t now_ns = clock_ns(CLOCK_MONOTONIC);
  if (answer.status == Status::kOk && unit_.is_doubtful()) {
    answer.status = Status::kDoubtfulUnit;
    answer.reason = status_text(answer.status);
  }
  if (answer.status == Status::kServerBusy) {
    const double pause_s = answer.wait_s > 0 ? answer.wait_s : kBusyPauseS;
    busy_utc_s_ = utc_seconds(config_.clock);
    not_before_utc_s_ = busy_utc_s_ + static_cast<std::int64_t>(pause_s) + 1;
  }
  if (answer.status != reported_) {
    const bool is_well = answer.status == Status::kOk;
    const std::string reason =
        answer.reason.empty() ? std::string(status_text(answer.status)) : answer.reason;
    say(is_well ? JournalLevel::kNotice : JournalLevel::kWarning,
        "prices: " + (is_well ? "ok" : reason));
    reported_ = answer.status;
  }
  publisher_.publish([&](PublishedPrices& prices) {
    ++prices.answers;
    prices.status = answer.status;
    if (answer.status != Status::kOk) return;
    prices.row = answer.newest;
    prices.received_monotonic_ns = now_ns;
    prices.fetch_us = static_cast<std::int32_t>((now_ns - begin_ns) / 1'000);
  });
  return answer;
}

bool PriceFetcher::sleep_until(std::int64_t utc_s) const {
  constexpr std::int64_t kSliceNs = kSecondNs / 10;
  const ScaledClock& clock = config_.clock;
  std::int64_t left_before_ns = INT64_MAX - kSecondNs;
  while (!stop_.stop_requested()) {
    const std::int64_t now_ns = clock_ns(CLOCK_MONOTONIC);
    const std::int64_t left_ns = clock.monotonic_ns_at(utc_s * kSecondNs) - now_ns;
    if (left_ns <= 0 || left_ns > left_before_ns + kSecondNs) return true;
    left_before_ns = left_ns;
    sleep_until_monotonic(now_ns + std::min(left_ns, kSliceNs));
  }
  return false;
}

}  // namespace bess
