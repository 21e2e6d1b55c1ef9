#include "workstation/data/market/feed/market_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <limits>
#include <unordered_map>

#include "shared/host/file.h"
#include "shared/host/text.h"
#include "shared/host/user_error.h"
#include "shared/units_and_limits.h"
#include "shared/utc_text.h"

namespace bess {

namespace {

/// Joined minute files must agree where they overlap, because both claim to be the market.
/// Downloads differ: a later one corrects an earlier one.
class Overlap {
 public:
  /// Compares the rows of a minute file with those of the previous files.
  void add(const std::string& name, const MarketRows& rows) {
    names_.push_back(name);
    for (const MinuteRow& row : rows.minutes) {
      add_price(minutes_, "indicative", row.utc_s, row.indicative_eur_per_mwh);
    }
    for (const QuarterHour& row : rows.quarter_hours) {
      add_price(quarter_hours_, "settled", row.utc_s, row.price_eur_per_mwh);
    }
  }
  /// One error if any two disagree, otherwise none.
  [[nodiscard]] std::vector<Finding> findings() const {
    if (disagreements_ == 0) return {};
    Finding finding = first_;
    finding.what += fmt::format(" ({} in all); remove one", counted(disagreements_, "difference"));
    return {finding};
  }

 private:
  struct Price {
    double eur_per_mwh;
    std::size_t file;  ///< index into names_
  };
  using Prices = std::unordered_map<std::int64_t, Price>;

  void add_price(Prices& known, const char* column, std::int64_t utc_s, double eur_per_mwh) {
    if (!is_published(eur_per_mwh)) return;
    const std::size_t file = names_.size() - 1;
    const auto [found, is_new] = known.try_emplace(utc_s, Price{eur_per_mwh, file});
    if (is_new || found->second.eur_per_mwh == eur_per_mwh || found->second.file == file) return;
    if (disagreements_++ > 0) return;
    first_ = {"overlap", true,
              fmt::format("{} and {} disagree about {}: {} price {:g} and {:g}",
                          names_[found->second.file], names_[file], utc_text(utc_s).view(), column,
                          found->second.eur_per_mwh, eur_per_mwh),
              utc_s};
  }

  std::vector<std::string> names_;
  Prices minutes_, quarter_hours_;
  std::size_t disagreements_ = 0;
  Finding first_{};
};

/// A series is dense: a wrong date must not allocate centuries.
constexpr std::int64_t kSpanSecondsMax = 40LL * 366 * kSecondsPerDay;

/// Stable sort by time: among equal times the last one read stays last.
template <typename Row, typename Price>
std::vector<Row> without_duplicates(std::vector<Row> rows, Price price_of, JoinReport& report) {
  std::stable_sort(rows.begin(), rows.end(),
                   [](const Row& a, const Row& b) { return a.utc_s < b.utc_s; });
  std::vector<Row> kept;
  kept.reserve(rows.size());
  for (const Row& row : rows) {
    if (kept.empty() || kept.back().utc_s != row.utc_s) {
      kept.push_back(row);
      continue;
    }
    ++report.duplicates;
    if (!is_published(price_of(row))) continue;
    if (is_published(price_of(kept.back())) && price_of(kept.back()) != price_of(row)) {
      ++report.duplicates_changed;
    }
    kept.back() = row;
  }
  return kept;
}

MinuteSeries empty_series(std::int64_t from_utc_s, std::int64_t until_utc_s) {
  MinuteSeries series;
  series.start_utc_s = from_utc_s;
  series.indicative.assign(static_cast<std::size_t>((until_utc_s - from_utc_s) / 60),
                           kNotPublished);
  series.settled = series.indicative;
  return series;
}

void settle_from_minute_14(MinuteSeries& series) {
  for (std::size_t m = 0; m < series.size(); ++m) {
    const bool is_last = series.utc_s(m) % kSecondsPerQuarterHour == kSecondsPerQuarterHour - 60;
    if (!is_last || m + 1 < kMinutesPerQuarterHour) continue;
    std::fill_n(
        series.settled.begin() + static_cast<std::ptrdiff_t>(m + 1 - kMinutesPerQuarterHour),
        kMinutesPerQuarterHour, series.indicative[m]);
  }
}

std::int64_t quarter_hour_floor(std::int64_t utc_s) {
  const std::int64_t rest = utc_s % kSecondsPerQuarterHour;
  return utc_s - (rest < 0 ? rest + kSecondsPerQuarterHour : rest);
}

struct Span {
  std::int64_t from_utc_s, until_utc_s;
};

/// Whole quarter-hours at the start, so that each minute has its quarter-hour.
Span span_of(const std::vector<MinuteRow>& minutes, const std::vector<QuarterHour>& quarter_hours) {
  Span span{std::numeric_limits<std::int64_t>::max(), std::numeric_limits<std::int64_t>::min()};
  if (!minutes.empty()) {
    span = {quarter_hour_floor(minutes.front().utc_s), minutes.back().utc_s + 60};
  }
  if (!quarter_hours.empty()) {
    span.from_utc_s = std::min(span.from_utc_s, quarter_hours.front().utc_s);
    span.until_utc_s =
        std::max(span.until_utc_s, quarter_hours.back().utc_s + kSecondsPerQuarterHour);
  }
  return span;
}

/// Throws UserError if the rows are too far apart for a dense series.
void check_span(std::int64_t from_utc_s, std::int64_t until_utc_s, std::string_view name) {
  if (until_utc_s - from_utc_s <= kSpanSecondsMax) return;
  fail("{}: the rows span {} to {}, more than 40 years; correct the wrong date", name,
       utc_text(from_utc_s).view(), utc_text(until_utc_s).view());
}

}  // namespace

std::vector<QuarterHour> sorted_quarter_hours(std::vector<QuarterHour> rows, JoinReport& report) {
  return without_duplicates(
      std::move(rows), [](const QuarterHour& row) { return row.price_eur_per_mwh; }, report);
}

JoinedMarket join_market(MarketRows rows, std::string_view name) {
  if (rows.minutes.empty() && rows.quarter_hours.empty()) fail("{}: has no rows", name);
  JoinedMarket market;
  const std::vector<MinuteRow> minutes = without_duplicates(
      std::move(rows.minutes), [](const MinuteRow& row) { return row.indicative_eur_per_mwh; },
      market.report);
  const std::vector<QuarterHour> quarter_hours =
      sorted_quarter_hours(std::move(rows.quarter_hours), market.report);
  market.report.dual_priced_minutes = rows.dual_priced_minutes.size();
  market.report.dual_priced_quarter_hours = rows.dual_priced_quarter_hours.size();
  market.report.findings = std::move(rows.findings);
  market.report.minutes = minutes.size();
  market.report.quarter_hours = quarter_hours.size();
  const auto [from_utc_s, until_utc_s] = span_of(minutes, quarter_hours);
  check_span(from_utc_s, until_utc_s, name);
  MinuteSeries& series = market.series = empty_series(from_utc_s, until_utc_s);
  for (const MinuteRow& row : minutes) {
    series.indicative[static_cast<std::size_t>((row.utc_s - from_utc_s) / 60)] =
        row.indicative_eur_per_mwh;
  }
  for (const QuarterHour& row : quarter_hours) {
    std::fill_n(series.settled.begin() + (row.utc_s - from_utc_s) / 60, kMinutesPerQuarterHour,
                row.price_eur_per_mwh);
  }
  market.report.settled_from_minutes = quarter_hours.empty();
  if (quarter_hours.empty()) settle_from_minute_14(series);
  if (has_no_price(series.indicative) && has_no_price(series.settled)) {
    fail("{}: has rows without any price; choose other days", name);
  }
  return market;
}

MarketRows read_market_files(const std::vector<std::string>& paths, const CustomCsvFormat& own) {
  MarketRows all;
  Overlap overlap;
  for (const std::string& path : paths) {
    const MarketRows rows = parse_market_text(read_file(path), path, own);
    if (rows.is_minute_file) overlap.add(path, rows);
    append_rows(all, rows);
  }
  all.findings = overlap.findings();
  return all;
}

SettledQuarterHours read_quarter_hour_files(const std::vector<std::string>& paths) {
  MarketRows rows = read_market_files(paths);
  if (rows.quarter_hours.empty() && !rows.minutes.empty()) {
    fail("{}: has minute rows without settled prices; use settled quarter-hours (ods047, ods134)",
         fmt::join(paths, ", "));
  }
  if (rows.quarter_hours.empty()) fail("{}: has no rows", fmt::join(paths, ", "));
  SettledQuarterHours settled;
  settled.sources = rows.sources;
  settled.sources.erase(MarketSource::kDrawn);  // the minutes will be redrawn
  settled.minutes_unused = rows.minutes.size();
  settled.report.findings = std::move(rows.findings);
  settled.report.dual_priced_quarter_hours = rows.dual_priced_quarter_hours.size();
  settled.quarter_hours = sorted_quarter_hours(std::move(rows.quarter_hours), settled.report);
  check_span(settled.quarter_hours.front().utc_s, settled.quarter_hours.back().utc_s,
             paths.front());
  return settled;
}

std::string describe_dual_priced(const JoinReport& report) {
  const auto line = [](std::size_t count, std::string_view noun, std::string_view price) {
    if (count == 0) return std::string();
    return fmt::format("{} with different prices for long and short: no {} price stored\n",
                       counted(count, noun), price);
  };
  return line(report.dual_priced_quarter_hours, "quarter-hour", "settled") +
         line(report.dual_priced_minutes, "minute", "indicative");
}

std::string describe_join(const JoinedMarket& market) {
  const JoinReport& report = market.report;
  std::string text = fmt::format("{} and {} from {} to {}\n", counted(report.minutes, "minute"),
                                 counted(report.quarter_hours, "quarter-hour"),
                                 utc_text(market.series.start_utc_s).view(),
                                 utc_text(market.series.utc_s(market.series.size())).view());
  if (report.duplicates > 0) {
    text += fmt::format("{} dropped, {} of them with another price (the last one read was kept)\n",
                        counted(report.duplicates, "duplicate row"), report.duplicates_changed);
  }
  text += describe_dual_priced(report);
  if (report.settled_from_minutes) {
    text +=
        "no quarter-hour file was given: the settled price is the indicative one of minute 14, "
        "which validation may still change\n";
  }
  if (report.minutes == 0) {
    text +=
        "no minute file was given: there are no indicative prices; 'bess-train prices "
        "reconstruct' can draw them\n";
  }
  const auto settled_gaps = gaps_in(market.series.settled, market.series.start_utc_s, 60);
  text += describe_gaps("settled price", settled_gaps);
  if (report.minutes > 0) {
    text += describe_gaps("indicative price",
                          gaps_in(market.series.indicative, market.series.start_utc_s, 60));
  }
  return text;
}

}  // namespace bess
