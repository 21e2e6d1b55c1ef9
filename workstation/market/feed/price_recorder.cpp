#include "workstation/market/feed/price_recorder.h"

#include <fmt/core.h>

#include <algorithm>
#include <limits>
#include <map>

#include "shared/host/text.h"
#include "shared/host/user_error.h"
#include "shared/utc_text.h"
#include "workstation/market/feed/elia_fetch.h"
#include "workstation/market/feed/market_json.h"
#include "workstation/market/feed/recording_folder.h"

namespace bess {
namespace {

using Kind = HttpOutcome::Kind;

constexpr std::size_t kRowsPerLook = 60;   // the hour that the source promises; a poll costs 16 kB
constexpr std::size_t kRowsPerPage = 100;  // the API's most
constexpr std::size_t kPageBytesMax = std::size_t{4} << 20;  // of a hundred rows, which are 30 kB
constexpr std::size_t kRowsMax = 1600;                       // more than the longest day has
constexpr double kBackoffMax_s = 300;
constexpr std::int64_t kFutureMax_s = 86'400;  // of a clock that is off; a stray date is none
constexpr std::int64_t kEarlyMax_s =
    60;  // of clocks that are a little apart: the row is left for later

bool same(double a, double b) { return a == b || (!is_published(a) && !is_published(b)); }

/// What a row says and its minute's file does not.
bool is_news(const RecordedMinute& known, const MinuteRow& row, bool of_prices) {
  if (!of_prices) {
    return !known.system_imbalance_mw || !same(*known.system_imbalance_mw, row.system_imbalance_mw);
  }
  return !known.price_eur_per_mwh || !same(*known.price_eur_per_mwh, row.indicative_eur_per_mwh) ||
         !(known.quality == row.quality.view());
}

struct ArrivedRow {
  MinuteRow row;
  std::int64_t arrived_utc_s;
  bool seen;
};
using ArrivedRows = std::map<std::int64_t, ArrivedRow>;  ///< by minute

struct Page {
  HttpOutcome outcome;
  std::vector<MinuteRow> rows;  ///< of kDone, newest first
  std::int64_t arrived_utc_s = 0;
};

/// One data set: when to look, what to make of an answer, and its trouble.
class Follower {
 public:
  Follower(const RecordRequest& request, RecordingFolder& folder, std::string dataset,
           bool of_prices)
      : request_(request), folder_(folder), dataset_(std::move(dataset)), of_prices_(of_prices) {}

  [[nodiscard]] double next_look_s() const { return next_look_s_; }
  [[nodiscard]] bool has_answered() const { return has_answered_; }
  [[nodiscard]] std::string trouble() const { return failures_ == 0 ? std::string() : trouble_; }
  void not_before(double steady_s) { next_look_s_ = std::max(next_look_s_, steady_s); }

  /// What is new. True when the whole server is to be left alone until the next look.
  bool look(const std::atomic<bool>& interrupted, ArrivedRows& news) {
    const double start_s = request_.clock.steady_s();
    next_look_s_ = start_s + request_.poll_s;
    std::int64_t covered_from_utc_s = std::numeric_limits<std::int64_t>::min();
    std::int64_t oldest_utc_s = std::numeric_limits<std::int64_t>::max();
    std::size_t offset = 0;
    std::size_t wanted = kRowsPerLook;
    while (true) {
      const Page page = get_page(offset, wanted, interrupted);
      if (page.outcome.kind == Kind::kInterrupted) return false;
      if (page.outcome.kind != Kind::kDone) return fail_look(page.outcome, start_s);
      if (const MinuteRow* const early = row_of_the_future(page)) {
        return fail_look(clock_trouble(*early, page.arrived_utc_s), start_s);
      }
      const bool met_known = take(page, start_s, news);
      const bool source_is_done =
          page.rows.size() < wanted || page.rows.back().utc_s >= oldest_utc_s;
      if (!page.rows.empty()) oldest_utc_s = page.rows.back().utc_s;
      if (offset == 0 && !source_is_done) covered_from_utc_s = oldest_utc_s;
      thorough_ = thorough_ || !met_known;
      offset += wanted;
      if (source_is_done || !thorough_ || offset >= kRowsMax) break;
      wanted = kRowsPerPage;
    }
    thorough_ = false;
    succeed(start_s, covered_from_utc_s, news.size());
    return false;
  }

 private:
  Page get_page(std::size_t offset, std::size_t limit, const std::atomic<bool>& interrupted) const {
    const std::string url = fmt::format(
        "{}/catalog/datasets/{}/records?order_by=datetime%20desc&limit={}&offset={}&timezone=UTC",
        request_.base_url, dataset_, limit, offset);
    Page page{
        http_get(url, interrupted, {.deadline_s = request_.deadline_s, .bytes_max = kPageBytesMax}),
        {},
        request_.clock.utc_s()};
    if (page.outcome.kind != Kind::kDone) return page;
    try {
      page.rows = parse_market_json(page.outcome.body, dataset_).minutes;
      std::ranges::sort(page.rows, std::greater{}, &MinuteRow::utc_s);
    } catch (const UserError& error) {
      page.outcome = {
          Kind::kTransient, {}, fmt::format("cannot read the answer: {}", error.what()), {}};
    }
    return page;
  }

  static std::int64_t early_s(const MinuteRow& row, std::int64_t arrived_utc_s) {
    return row.utc_s + 60 - arrived_utc_s;
  }

  /// A row so early that one of the two clocks is wrong: then no row of the page has arrived when
  /// it seems.
  static const MinuteRow* row_of_the_future(const Page& page) {
    for (const MinuteRow& row : page.rows) {
      const std::int64_t by_s = early_s(row, page.arrived_utc_s);
      if (by_s > kEarlyMax_s && by_s <= kFutureMax_s) return &row;
    }
    return nullptr;
  }

  static HttpOutcome clock_trouble(const MinuteRow& row, std::int64_t arrived_utc_s) {
    return {Kind::kWrongClock, {}, early_text(row, arrived_utc_s), {}};
  }

  static std::string early_text(const MinuteRow& row, std::int64_t arrived_utc_s) {
    return fmt::format(
        "the row of {} came at {}, {} s before its minute had ended: is this computer's clock "
        "right, and the source's?",
        utc_text(row.utc_s).view(), utc_text(arrived_utc_s).view(), early_s(row, arrived_utc_s));
  }

  /// True when the oldest row of the page was known.
  bool take(const Page& page, double start_s, ArrivedRows& news) {
    const bool looked_lately = start_s - last_look_s_ <= 2 * request_.poll_s;
    bool oldest_known = true;
    for (const MinuteRow& row : page.rows) {
      if (row.utc_s + 60 >
          page.arrived_utc_s) {  // its minute has not ended: nothing arrives before
        tell_clock(row, page.arrived_utc_s);
        continue;
      }
      const RecordedMinute known = folder_.recorded(row.utc_s);
      oldest_known =
          of_prices_ ? known.price_eur_per_mwh.has_value() : known.system_imbalance_mw.has_value();
      if (!is_news(known, row, of_prices_)) continue;
      const bool seen = looked_lately && row.utc_s >= covered_from_utc_s_;
      news.try_emplace(row.utc_s, ArrivedRow{row, page.arrived_utc_s, seen});
    }
    return oldest_known;
  }

  void succeed(double start_s, std::int64_t covered_from_utc_s, std::size_t rows) {
    last_look_s_ = start_s;
    covered_from_utc_s_ = covered_from_utc_s;
    has_answered_ = true;
    if (failures_ > 0) {
      request_.tell(
          {RecorderEvent::Kind::kOver, dataset_,
           fmt::format("answers again after {:.0f} s: {} to catch up",
                       request_.clock.steady_s() - trouble_since_s_, counted(rows, "row"))});
    }
    failures_ = 0;
  }

  bool fail_look(const HttpOutcome& outcome, double start_s) {
    if (outcome.kind == Kind::kRefused && of_prices_ && !has_answered_) {
      fail("{}: {}: {}; check --url", request_.base_url, dataset_, outcome.reason);
    }
    if (outcome.kind == Kind::kWrongClock && !has_answered_) {
      fail("{}: {}: {} Nothing is recorded until they agree", request_.base_url, dataset_,
           outcome.reason);
    }
    const double doubled_s = request_.poll_s * static_cast<double>(1 << std::min(failures_, 10));
    const double told_s = outcome.wait_s.value_or(0);
    const double wait_s =
        std::max(told_s, std::min(doubled_s, std::max(kBackoffMax_s, request_.poll_s)));
    next_look_s_ = request_.clock.steady_s() + wait_s;
    trouble_ = outcome.reason;
    if (failures_++ == 0) {
      trouble_since_s_ = start_s;
      request_.tell(
          {RecorderEvent::Kind::kOutage, dataset_,
           fmt::format("{}{}; next look in {:.0f} s, and so on until it answers", outcome.reason,
                       told_s < kWaitMax_s ? "" : "; the server asks to wait a day or longer",
                       wait_s)});
    }
    return outcome.kind == Kind::kUnreachable || outcome.kind == Kind::kBusy;
  }

  void tell_clock(const MinuteRow& row, std::int64_t arrived_utc_s) {
    if (clock_told_) return;
    clock_told_ = true;
    request_.tell({RecorderEvent::Kind::kClock, dataset_,
                   early_text(row, arrived_utc_s) + " It is taken when its minute has ended"});
  }

  const RecordRequest& request_;
  RecordingFolder& folder_;
  std::string dataset_;
  bool of_prices_;
  double next_look_s_ = 0;
  double last_look_s_ = -1e18;           ///< that was answered to its end
  std::int64_t covered_from_utc_s_ = 0;  ///< how far back that look reached
  bool thorough_ = true;                 ///< page back to the source's first row
  bool has_answered_ = false;
  int failures_ = 0;  ///< since the last answer
  double trouble_since_s_ = 0;
  std::string trouble_;
  bool clock_told_ = false;
};

RecordedLine line_of(const ArrivedRow& arrived) {
  RecordedLine line;
  line.minute_utc_s = arrived.row.utc_s;
  line.seen = arrived.seen;
  return line;
}

/// One line a minute, two where one of its values was seen and the other found.
std::vector<RecordedLine> lines_of(const ArrivedRows& prices, const ArrivedRows& imbalances) {
  std::vector<RecordedLine> lines;
  for (const auto& [minute, price] : prices) {
    lines.push_back(line_of(price));
    lines.back().price_eur_per_mwh = {price.row.indicative_eur_per_mwh, price.arrived_utc_s};
    lines.back().quality = price.row.quality;
  }
  const std::size_t priced = lines.size();
  for (const auto& [minute, imbalance] : imbalances) {
    const auto end = lines.begin() + static_cast<std::ptrdiff_t>(priced);
    auto line = std::lower_bound(lines.begin(), end, minute,
                                 [](const auto& a, std::int64_t b) { return a.minute_utc_s < b; });
    if (line == end || line->minute_utc_s != minute || line->seen != imbalance.seen) {
      lines.push_back(line_of(imbalance));
      line = lines.end() - 1;
    }
    line->system_imbalance_mw = {imbalance.row.system_imbalance_mw, imbalance.arrived_utc_s};
  }
  std::ranges::stable_sort(lines, {}, &RecordedLine::minute_utc_s);
  return lines;
}

class Recorder {
 public:
  explicit Recorder(const RecordRequest& request)
      : request_(request),
        folder_(request.folder, request.base_url,
                [&request](const std::string& file, const std::string& what) {
                  request.tell({RecorderEvent::Kind::kMended, file, what});
                }) {}

  RecordSummary run(const std::atomic<bool>& interrupted) {
    while (!interrupted && !is_over()) {
      round(interrupted);
      if (interrupted) break;
      request_.clock.sleep(pause_s(), interrupted);
    }
    summary_.lateness = tally_.result();
    summary_.answered = prices_.has_answered();
    summary_.trouble = prices_.trouble();
    return summary_;
  }

 private:
  [[nodiscard]] bool is_over() const {
    return request_.until_utc_s && request_.clock.utc_s() >= *request_.until_utc_s;
  }

  [[nodiscard]] double pause_s() const {
    const double next_s = std::min(prices_.next_look_s(), imbalances_.next_look_s());
    double pause = std::max(0.0, next_s - request_.clock.steady_s());
    if (request_.until_utc_s) {
      const auto left = static_cast<double>(*request_.until_utc_s - request_.clock.utc_s());
      pause = std::min(pause, std::max(0.0, left));
    }
    return pause;
  }

  void round(const std::atomic<bool>& interrupted) {
    ArrivedRows prices;
    ArrivedRows imbalances;
    look(prices_, imbalances_, interrupted, prices);
    look(imbalances_, prices_, interrupted, imbalances);
    const std::vector<RecordedLine> lines = lines_of(prices, imbalances);
    if (lines.empty()) return;
    std::vector<RecordedMinute> before;
    for (const RecordedLine& line : lines) before.push_back(folder_.recorded(line.minute_utc_s));
    folder_.append(lines);
    for (std::size_t i = 0; i < lines.size(); ++i) count(before[i], lines[i]);
    tell(lines);
  }

  void look(Follower& follower, Follower& other, const std::atomic<bool>& interrupted,
            ArrivedRows& news) {
    if (interrupted || follower.next_look_s() > request_.clock.steady_s()) return;
    if (follower.look(interrupted, news)) other.not_before(follower.next_look_s());
  }

  void count(const RecordedMinute& before, const RecordedLine& line) {
    ++summary_.lines;
    if (const auto& price = line.price_eur_per_mwh; price && is_published(price->value)) {
      if (!before.had_price) {
        ++summary_.prices;
        tally_.add(line.minute_utc_s, price->arrived_utc_s, line.seen);
      } else if (!same(*before.price_eur_per_mwh, price->value)) {
        ++summary_.revised;
      }
    }
    if (line.system_imbalance_mw) {
      ++(before.system_imbalance_mw ? summary_.revised : summary_.imbalances);
    }
  }

  void tell(const std::vector<RecordedLine>& lines) {
    const RecordedLine& newest = lines.back();
    newest_utc_s_ = std::max(newest_utc_s_, newest.minute_utc_s);
    const auto& price = newest.price_eur_per_mwh;
    std::string text = fmt::format("{}, newest of {}", counted(lines.size(), "line"),
                                   utc_text(newest.minute_utc_s).view());
    if (price && is_published(price->value)) text += fmt::format(": {} EUR/MWh", price->value);
    request_.tell({RecorderEvent::Kind::kRecorded, "", text});
    for (const RecordedDaySummary& day : folder_.close_days_before(newest_utc_s_)) {
      request_.tell(
          {RecorderEvent::Kind::kDay, day.file,
           fmt::format("{} of {} minutes have a price", day.minutes_with_price, day.minutes)});
    }
  }

  const RecordRequest& request_;
  RecordingFolder folder_;
  Follower prices_{request_, folder_, "ods161", true};
  Follower imbalances_{request_, folder_, "ods169", false};
  RecordSummary summary_;
  LatenessTally tally_;
  std::int64_t newest_utc_s_ = 0;
};

}  // namespace

RecordSummary record_prices(const RecordRequest& request, const std::atomic<bool>& interrupted) {
  return Recorder(request).run(interrupted);
}

}  // namespace bess
