#include "workstation/data/market/feed/elia_fetch.h"

#include <fmt/core.h>

#include <algorithm>
#include <set>

#include "shared/host/csv.h"
#include "shared/host/json.h"
#include "shared/host/text.h"
#include "shared/host/user_error.h"
#include "shared/utc_text.h"

namespace bess {
namespace {

using Kind = HttpOutcome::Kind;

/// A month of minutes needs 450 pages if the server sends 100 rows at a time.
constexpr int kPagesMax = 2'000;

std::string where_of(const FetchWindow& window) {
  // Explicit offsets: the API reads naive times as UTC or local, depending on other parameters.
  const auto instant = [](std::int64_t utc_s) {
    std::string text(utc_text(utc_s).view());
    return text.replace(text.size() - 1, 1, "+00:00");
  };
  return url_encoded(fmt::format("datetime >= \"{}\" AND datetime < \"{}\"",
                                 instant(window.from_utc_s), instant(window.until_utc_s)));
}

/// Drops the rows whose interval [from, until) is `unwanted`.
template <typename Unwanted>
void drop_rows(MarketRows& rows, Unwanted unwanted) {
  const auto minute = [&](std::int64_t utc_s) { return unwanted(utc_s, utc_s + 60); };
  const auto quarter_hour = [&](std::int64_t utc_s) {
    return unwanted(utc_s, utc_s + kSecondsPerQuarterHour);
  };
  std::erase_if(rows.minutes, [&](const MinuteRow& row) { return minute(row.utc_s); });
  std::erase_if(rows.quarter_hours,
                [&](const QuarterHour& row) { return quarter_hour(row.utc_s); });
  std::erase_if(rows.dual_priced_minutes, minute);
  std::erase_if(rows.dual_priced_quarter_hours, quarter_hour);
}

std::int64_t step_of(const FetchWindow& window) {
  return holds_minutes(window.dataset) ? 60 : kSecondsPerQuarterHour;
}

/// First instant of the window that has not ended.
std::int64_t end_of(const FetchWindow& window, std::int64_t now_utc_s) {
  const std::int64_t step_s = step_of(window);
  return std::max(window.from_utc_s, std::min(window.until_utc_s, now_utc_s - now_utc_s % step_s));
}

/// Times of the rows of the window's own kind. With `only_settled` a quarter-hour without a price
/// is a gap; Elia publishes some minutes without one.
std::set<std::int64_t> times_of(const FetchWindow& window, const MarketRows& rows,
                                bool only_settled = false) {
  std::set<std::int64_t> times;
  if (holds_minutes(window.dataset)) {
    for (const MinuteRow& row : rows.minutes) times.insert(row.utc_s);
    return times;
  }
  for (const QuarterHour& row : rows.quarter_hours) {
    if (!only_settled || is_published(row.price_eur_per_mwh)) times.insert(row.utc_s);
  }
  return times;
}

/// Ended parts of the window without any of these times.
std::vector<Gap> gaps_between(const std::set<std::int64_t>& times, const FetchWindow& window,
                              std::int64_t now_utc_s) {
  const std::int64_t step_s = step_of(window);
  std::vector<Gap> gaps;
  std::int64_t next_s = window.from_utc_s;
  const auto missing_until = [&](std::int64_t utc_s) {
    if (next_s < utc_s) gaps.push_back({next_s, utc_s});
  };
  const std::int64_t end_s = end_of(window, now_utc_s);
  for (const std::int64_t utc_s : times) {
    if (utc_s < window.from_utc_s || utc_s >= end_s) continue;
    missing_until(utc_s);
    next_s = utc_s + step_s;
  }
  missing_until(end_s);
  return gaps;
}

/// Windows may be days, so the text names days.
std::string describe_window(const FetchRequest& request, const FetchWindow& window) {
  return fmt::format(
      "{} of {} to {} from {}", window.dataset, format_local_date(local_date_of(window.from_utc_s)),
      format_local_date(local_date_of(window.until_utc_s - 1)), host_of(request.base_url));
}

/// Attempts for one answer so far.
struct Attempts {
  int all = 0;
  int unreadable = 0;  ///< complete answers without data
  int slow = 0;
};

/// Seconds until the next attempt; throws if there is none.
double next_wait_s(const RetriedRequest& request, const RetryPolicy& retry,
                   const Attempts& attempts, const HttpOutcome& outcome) {
  const bool unreachable = outcome.kind == Kind::kUnreachable;
  const int attempts_max = unreachable ? retry.attempts_unreachable_max : retry.attempts_max;
  if (outcome.kind == Kind::kRefused || attempts.all >= attempts_max ||
      attempts.unreadable >= retry.attempts_unreadable_max ||
      attempts.slow >= retry.attempts_slow_max) {
    fail("{} ({}): {}; check --base-url and the network and {}", outcome.reason,
         counted(static_cast<std::size_t>(attempts.all), "attempt"), request.subject,
         request.again);
  }
  const double backoff_s = retry.first_wait_s * static_cast<double>(1 << (attempts.all - 1));
  const double wait_s = std::max(outcome.wait_s.value_or(0.0), backoff_s);
  if (wait_s > retry.wait_max_s) {
    fail("{}; the server asks to wait {}: {}; {}", outcome.reason, describe_wait(wait_s),
         request.subject, request.again_then);
  }
  return wait_s;
}

/// Nothing if interrupted.
std::optional<WindowDownload> get_page(const FetchRequest& request, const FetchWindow& window,
                                       const std::atomic<bool>& interrupted) {
  WindowDownload download;
  const auto read = [&](std::string body) {
    download.rows = rows_in_window(body, window.dataset, window, request.now_utc_s);
    download.text = std::move(body);
  };
  const std::string url = fmt::format(
      "{}/catalog/datasets/{}/exports/csv?where={}&order_by=datetime&timezone=UTC&delimiter=%3B",
      request.base_url, window.dataset, where_of(window));
  const RetriedRequest retried{url, window.dataset, describe_window(request, window),
                               "run the same command again, finished windows are kept",
                               "run the same command again then, finished windows are kept"};
  if (!get_with_retries(retried, request.retry, request.sleep, interrupted, read)) return {};
  return download;
}

/// Number of rows by the server; nothing if not stated or larger than the calendar allows (then it
/// counted something else).
std::optional<std::size_t> server_total(const FetchRequest& request, const FetchWindow& window,
                                        const std::atomic<bool>& interrupted) {
  constexpr double kDeadline_s = 30;
  const std::string url =
      fmt::format("{}/catalog/datasets/{}/records?where={}&limit=1&timezone=UTC", request.base_url,
                  window.dataset, where_of(window));
  const HttpOutcome outcome =
      http_get(url, interrupted, {.deadline_s = kDeadline_s, .bytes_max = std::size_t{1} << 20});
  if (outcome.kind != Kind::kDone) return std::nullopt;
  const Json json = Json::parse(outcome.body);
  const std::optional<double> total = json.value()["total_count"].number();
  const std::int64_t most = (window.until_utc_s - window.from_utc_s) / step_of(window);
  if (!total || !(*total >= 0 && *total <= static_cast<double>(most))) return std::nullopt;
  return static_cast<std::size_t>(*total);
}

/// Rows of a further answer without its header, to append to `text`. Empty if it is not CSV with
/// the same columns.
std::string_view rows_behind_header(std::string_view page, std::string_view text) {
  const std::string_view header = csv_header(text);
  if (header.empty() || csv_header(page) != header) return {};
  std::string_view rows = page.substr(page.find(header));
  take_line(rows);
  return rows;
}

/// Requests the missing parts until the rows are complete or no request adds any.
class Pager {
 public:
  Pager(const FetchRequest& request, const FetchWindow& window,
        const std::atomic<bool>& interrupted, WindowDownload& download)
      : request_(request),
        window_(window),
        interrupted_(interrupted),
        download_(download),
        times_(times_of(window, download.rows.rows)) {
    download_.rows.distinct = times_.size();
  }

  /// False if interrupted.
  bool complete() {
    add_around({window_.from_utc_s, window_.until_utc_s}, download_.rows.rows);
    if (!ask_all()) return false;
    // The server has rows between those received: it sent them unsorted or incomplete.
    if (download_.rows.lacks_rows_of_total()) {
      open_ = missing_in(window_, download_.rows.rows, request_.now_utc_s);
      return ask_all();
    }
    return true;
  }

 private:
  bool ask_all() {
    while (!open_.empty() && pages_ < kPagesMax) {
      const Gap stretch = open_.back();
      open_.pop_back();
      FetchWindow part = window_;
      part.from_utc_s = stretch.from_utc_s;
      part.until_utc_s = stretch.until_utc_s;
      if (part.from_utc_s >= end_of(window_, request_.now_utc_s)) continue;  // not over yet
      if (download_.rows.total && !download_.rows.lacks_rows_of_total()) break;
      if (!ask(part)) return false;
    }
    return true;
  }

  bool ask(const FetchWindow& part) {
    ++pages_;
    const std::optional<WindowDownload> page = get_page(request_, part, interrupted_);
    if (!page) return false;
    WindowRows& rows = download_.rows;
    append_rows(rows.rows, page->rows.rows);
    times_.merge(times_of(window_, page->rows.rows));
    rows.distinct = times_.size();
    rows.received += page->rows.received;
    rows.unended += page->rows.unended;
    const std::string_view more = rows_behind_header(page->text, download_.text);
    if (more.empty() && count_of(page->rows.rows) > 0) {
      download_.text.clear();
    } else if (!download_.text.empty()) {
      if (!download_.text.ends_with('\n')) download_.text += '\n';
      download_.text.append(more);
    }
    add_around({part.from_utc_s, part.until_utc_s}, page->rows.rows);
    return true;
  }

  /// Adds the parts before the first and after the last row received, where a server that truncates
  /// its answers leaves one.
  void add_around(const Gap& stretch, const MarketRows& rows) {
    const std::set<std::int64_t> times = times_of(window_, rows);
    if (times.empty()) {
      // The total proves that there are rows.
      if (download_.rows.total && pages_ == 0) open_.push_back(stretch);
      return;
    }
    if (stretch.from_utc_s < *times.begin()) {
      open_.push_back({stretch.from_utc_s, *times.begin()});
    }
    const std::int64_t after_s = *times.rbegin() + step_of(window_);
    if (after_s < stretch.until_utc_s) open_.push_back({after_s, stretch.until_utc_s});
  }

  const FetchRequest& request_;
  const FetchWindow& window_;
  const std::atomic<bool>& interrupted_;
  WindowDownload& download_;
  std::set<std::int64_t> times_;  ///< of all rows so far
  std::vector<Gap> open_;         ///< stretches to be asked for
  int pages_ = 0;
};

}  // namespace

std::size_t count_of(const MarketRows& rows) {
  return rows.minutes.size() + rows.quarter_hours.size();
}

WindowRows rows_in_window(std::string_view text, const std::string& name, const FetchWindow& window,
                          std::int64_t now_utc_s) {
  WindowRows result;
  if (without_byte_order_mark(text).find_first_not_of(" \t\r\n") == text.npos) return result;
  result.rows = parse_market_text(text, name);
  result.received = count_of(result.rows);
  drop_rows(result.rows, [&window](std::int64_t from_utc_s, std::int64_t) {
    return from_utc_s < window.from_utc_s || from_utc_s >= window.until_utc_s;
  });
  const std::size_t inside = count_of(result.rows);
  drop_rows(result.rows, [now_utc_s](std::int64_t, std::int64_t until_utc_s) {
    return until_utc_s > now_utc_s;
  });
  result.unended = inside - count_of(result.rows);
  return result;
}

std::size_t expected_rows(const FetchWindow& window, std::int64_t now_utc_s) {
  return static_cast<std::size_t>((end_of(window, now_utc_s) - window.from_utc_s) /
                                  step_of(window));
}

std::vector<Gap> missing_in(const FetchWindow& window, const MarketRows& rows,
                            std::int64_t now_utc_s) {
  return gaps_between(times_of(window, rows), window, now_utc_s);
}

std::vector<Gap> holes_in(const FetchWindow& window, const MarketRows& rows,
                          std::int64_t now_utc_s) {
  return gaps_between(times_of(window, rows, true), window, now_utc_s);
}

std::optional<WindowDownload> download_window(const FetchRequest& request,
                                              const FetchWindow& window,
                                              const std::atomic<bool>& interrupted) {
  std::optional<WindowDownload> download = get_page(request, window, interrupted);
  if (!download) return std::nullopt;
  const bool has_some = count_of(download->rows.rows) + download->rows.unended > 0;
  if (download->rows.received > 0 && !has_some) {  // a retry would return the same rows
    fail("the server ignored the time window: {} received, none inside it: {}",
         counted(download->rows.received, "row"), describe_window(request, window));
  }
  if (missing_in(window, download->rows.rows, request.now_utc_s).empty()) return download;
  download->rows.total = server_total(request, window, interrupted);
  Pager pager(request, window, interrupted, *download);
  if (download->rows.total < download->rows.distinct)
    download->rows.total.reset();  // does not count these rows
  if (download->rows.total && !download->rows.lacks_rows_of_total()) return download;
  if (!pager.complete()) return std::nullopt;
  return download;
}

bool get_with_retries(const RetriedRequest& request, const RetryPolicy& retry, const Sleep& sleep,
                      const std::atomic<bool>& interrupted,
                      const std::function<void(std::string body)>& read) {
  for (Attempts attempts; !interrupted;) {
    ++attempts.all;
    HttpOutcome outcome = http_get(request.url, interrupted, retry.limits);
    attempts.slow += outcome.kind == Kind::kSlow ? 1 : 0;
    if (outcome.kind == Kind::kDone) {
      try {
        read(std::move(outcome.body));
        return true;
      } catch (const NotMarketData& error) {  // of another dataset
        outcome = {Kind::kRefused, {}, error.what(), {}};
      } catch (const UserError& error) {
        ++attempts.unreadable;
        outcome = {
            Kind::kTransient, {}, fmt::format("cannot read the answer: {}", error.what()), {}};
      }
    }
    if (outcome.kind == Kind::kInterrupted) break;
    const double wait_s = next_wait_s(request, retry, attempts, outcome);
    fmt::print(stderr, "{}: {}; next attempt in {:.0f} s\n", request.label, outcome.reason, wait_s);
    sleep(wait_s, interrupted);
  }
  return false;
}

std::string host_of(const std::string& url) {
  const std::size_t scheme = url.find("://");
  const std::size_t begin = scheme == url.npos ? 0 : scheme + 3;
  return url.substr(begin, url.find('/', begin) - begin);
}

}  // namespace bess
