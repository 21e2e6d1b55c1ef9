#include "tools/hil_runner/virtual/virtual_prices.h"

#include <algorithm>
#include <charconv>
#include <string_view>

#include "shared/scaled_clock.h"
#include "tools/hil_runner/scenario/publication.h"

namespace bess {

VirtualOutlook::VirtualOutlook(const Scenario& scenario, const OutlookSettings& settings,
                               const OutlookModel& model, VirtualTime& time)
    : settings_(settings),
      model_(model),
      time_(time),
      auction_(day_ahead_rows(scenario), scenario.day_ahead.value_or(AuctionSettings{})) {}

OutlookExchange* VirtualOutlook::start(std::int32_t level_centi) {
  process_ = std::make_unique<Process>(model_);
  process_->fetch_state.store = kept_;
  const std::int64_t now = time_.edge_utc_s();
  fetch(now);
  process_->planner.plan_usual_day(now, level_centi);
  plan((now + kSecondsPerStep - 1) / kSecondsPerStep * kSecondsPerStep, level_centi);
  return &process_->exchange;
}

void VirtualOutlook::cycle_done(const CycleRecord& record) {
  const std::int64_t now = time_.edge_utc_s();
  if (process_->fetch_state.is_due(settings_, now)) fetch(now);
  plan(record.utc_s + kSecondsPerStep, record.price_level.centi_eur_per_mwh());
}

void VirtualOutlook::fetch(std::int64_t now_utc_s) {
  DayAheadFetchState& fetch_state = process_->fetch_state;
  if (fetch_state.take(ask(now_utc_s), settings_, now_utc_s)) kept_ = fetch_state.store;
}

/// The server uses the true time; the requested days depend on the edge's clock.
DayAheadReply VirtualOutlook::ask(std::int64_t now_utc_s) const {
  if (time_.market() == VirtualTime::Market::kPaused) return {.status = Status::kTimeout};
  if (time_.market() == VirtualTime::Market::kDead) return {.status = Status::kNotConnected};
  const OutlookDays days = outlook_days_around(now_utc_s);
  const AuctionAnswer answer =
      auction_.answer(day_ahead_url("{today}", days), day_ahead_url("{tomorrow}", days),
                      time_.utc_ns() / kNanosecondsPerSecond);
  if (answer.fault == AuctionFault::kSlow) return {.status = Status::kTimeout};
  if (answer.status != 200) return {.status = Status::kHttpError};
  return read_day_ahead(answer.body, settings_.fields);
}

void VirtualOutlook::plan(std::int64_t tick_utc_s, std::int32_t level_centi) {
  process_->planner.plan(
      {.tick_utc_s = tick_utc_s, .level_centi = level_centi, .feed = process_->fetch_state.status},
      process_->fetch_state.store.days_at(tick_utc_s));
}

namespace {

constexpr std::int64_t kFetchNs = 30 * kMillisecondNs;  ///< duration of one answer
constexpr int kRowsAsked = 20;  ///< as in the example configuration of the edge

/// Number in the query of a URL: "limit=" in "...?limit=100&offset=0" is 100.
int number_of(std::string_view url, std::string_view key) {
  const std::size_t at = url.rfind(key);
  if (at == url.npos) return 0;
  int number = 0;
  std::from_chars(url.data() + at + key.size(), url.data() + url.size(), number);
  return number;
}

}  // namespace

VirtualPrices::VirtualPrices(const PriceFeedSettings& settings, const MarketView& market,
                             MarketFaultPlan& faults, const Scenario& scenario, VirtualTime& time)
    : settings_(settings), market_(market), faults_(faults), scenario_(scenario), time_(time) {}

void VirtualPrices::request(std::int64_t minute_utc_s, std::int64_t start_monotonic_ns,
                            std::int64_t deadline_monotonic_ns) {
  minute_utc_s_ = minute_utc_s;
  start_ns_ = start_monotonic_ns;
  deadline_ns_ = deadline_monotonic_ns;
  requests_ = 0;
  is_asking_ = is_served_ = false;
}

bool VirtualPrices::wait(std::int64_t until_monotonic_ns) {
  while (!is_served_) {
    if (!is_asking_ && !begin_next()) break;
    const std::int64_t next_ns = answer_.begun_ns > time_.monotonic_ns() || answer_.done_ns == 0
                                     ? answer_.begun_ns
                                     : answer_.done_ns;
    if (next_ns > until_monotonic_ns) {
      time_.advance_to(until_monotonic_ns);
      return false;
    }
    time_.advance_to(next_ns);
    if (answer_.done_ns == 0) {
      fetch();
      continue;
    }
    is_asking_ = false;
    newest_.publish(answer_.status, answer_.row, time_.monotonic_ns(),
                    static_cast<std::int32_t>((answer_.done_ns - answer_.begun_ns) / 1'000));
    is_served_ = answer_.status == Status::kOk && answer_.row.minute_utc_s >= minute_utc_s_;
  }
  return true;
}

/// Spreads requests over the wait like bess-prices; false when all requests are used.
bool VirtualPrices::begin_next() {
  const std::int64_t spacing_ns = kPriceWait_s * kNanosecondsPerSecond / kPriceRequests;
  const std::int64_t begin_ns = start_ns_ + requests_ * spacing_ns;
  if (requests_ >= kPriceRequests || (requests_ > 0 && begin_ns >= deadline_ns_)) {
    is_served_ = true;
    return false;
  }
  ++requests_;
  is_asking_ = true;
  answer_ = {.begun_ns = std::max(begin_ns, time_.monotonic_ns())};
  return true;
}

void VirtualPrices::fetch() {
  const Reply reply = ask({.limit = kRowsAsked}, settings_.http.timeout_ms);
  answer_.done_ns = time_.monotonic_ns() + reply.takes_ns;
  answer_.status =
      reply.status != Status::kOk
          ? reply.status
          : parse_newest_price(reply.text, settings_.fields, time_.edge_utc_s(), answer_.row);
}

Status VirtualPrices::fetch_once(PriceRow& row) {
  const Reply reply = ask({.limit = kRowsAsked}, settings_.http.timeout_ms);
  time_.advance_to(time_.monotonic_ns() + reply.takes_ns);
  if (reply.status != Status::kOk) return reply.status;
  return parse_newest_price(reply.text, settings_.fields, time_.edge_utc_s(), row);
}

PriceAnswer VirtualPrices::fetch_page(const char* url, std::int32_t timeout_ms) {
  const bool is_past = std::string_view(url).find("/ods133/") != std::string_view::npos;
  const Reply reply = ask({.dataset = is_past ? Dataset::kMinutesOfPastDays : Dataset::kMinutes,
                           .limit = number_of(url, "limit="),
                           .offset = number_of(url, "offset=")},
                          timeout_ms);
  time_.advance_to(time_.monotonic_ns() + reply.takes_ns);
  if (reply.status != Status::kOk) return {.status = reply.status};
  return parse_prices(reply.text, settings_.fields, time_.edge_utc_s());
}

VirtualPrices::Reply VirtualPrices::ask(const RecordsQuery& query, std::int32_t timeout_ms) {
  if (time_.market() == VirtualTime::Market::kPaused) {
    return {.status = Status::kTimeout, .takes_ns = timeout_ms * kMillisecondNs};
  }
  if (time_.market() == VirtualTime::Market::kDead) {
    return {.status = Status::kNotConnected, .takes_ns = kFetchNs};
  }
  const double at_s = static_cast<double>(time_.utc_ns() - scenario_.utc_ns_at(0)) / 1e9;
  const MarketFault fault = faults_.next(at_s);
  if (fault == MarketFault::kHttp500) {
    return {.status = Status::kHttpError, .takes_ns = kFetchNs};
  }
  return {.text = market_.records(query, time_.utc_ns(), fault, scenario_.price_fault_utc_s()),
          .takes_ns = kFetchNs};
}

}  // namespace bess
