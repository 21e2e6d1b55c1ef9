#include "shared/host/day_ahead_rows.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <numeric>
#include <utility>

#include "shared/host/text.h"
#include "shared/local_time.h"
#include "shared/utc_text.h"

namespace bess {

namespace {

constexpr std::int64_t kQuarterS = 900;
constexpr std::int64_t kHourS = 3'600;
constexpr std::int64_t kAssumedMaxS = 6 * kHourS;  ///< longer gaps are missing data
constexpr double kNoPrice = std::numeric_limits<double>::quiet_NaN();

bool has_price(const DayAheadRow& row) { return !std::isnan(row.eur_per_mwh); }

void add_row(JsonValue time, JsonValue price, DayAheadAnswer& answer) {
  const std::optional<std::int64_t> utc_s = time_in(time);
  if (utc_s) {
    answer.rows.push_back({.utc_s = *utc_s, .eur_per_mwh = price.number().value_or(kNoPrice)});
  } else {
    ++answer.passed_over;
  }
}

std::string without_blanks(std::string_view text) {
  std::string plain(text);
  std::erase(plain, ' ');
  return plain;
}

/// Rows of one local day with their lengths.
class DayRows {
 public:
  DayRows(std::vector<DayAheadRow> rows, std::int64_t midnight_utc_s)
      : rows_(std::move(rows)),
        midnight_utc_s_(midnight_utc_s),
        end_utc_s_(local_midnight_utc_s(midnight_utc_s, 1)) {
    for (std::size_t i = 1; i < rows_.size(); ++i) {
      step_s_ = std::gcd(step_s_, rows_[i].utc_s - rows_[i - 1].utc_s);
    }
    if (rows_.size() == 1) step_s_ = kQuarterS;
  }

  /// Uses the last price of the previous day at midnight if this day has no row there.
  void begin_with_last_of(const DayRows& before) {
    const DayAheadRow& last = before.rows_.back();
    const std::int64_t first_utc_s = rows_.front().utc_s;
    const bool holds = before.end_utc_s_ == midnight_utc_s_ && first_utc_s > midnight_utc_s_ &&
                       before.may_go_on(before.rows_.size() - 1) &&
                       first_utc_s - last.utc_s <= kAssumedMaxS;
    if (!holds) return;
    rows_.insert(rows_.begin(), {.utc_s = midnight_utc_s_, .eur_per_mwh = last.eur_per_mwh});
    step_s_ = std::gcd(step_s_, first_utc_s - midnight_utc_s_);
  }
  [[nodiscard]] bool is_merged() const {
    for (std::size_t i = 0; i + 1 < rows_.size(); ++i) {
      if (may_go_on(i) && rows_[i + 1].utc_s > sure_end_of(i)) return true;
    }
    return false;
  }

  /// `goes_on`: the last row may be valid until midnight.
  [[nodiscard]] DayAheadDay laid_out(bool goes_on) const {
    DayAheadDay day{.midnight_utc_s = midnight_utc_s_};
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      if (!has_price(rows_[i])) continue;
      const std::int64_t sure_end = sure_end_of(i);
      const bool is_last = i + 1 == rows_.size();
      const std::int64_t next = next_of(i);
      const bool is_assumed_until_next =
          may_go_on(i) && (!is_last || goes_on) && next - rows_[i].utc_s <= kAssumedMaxS;
      const int resolution_min = resolution_of(i);
      day.resolution_min = std::max(day.resolution_min, resolution_min);
      const std::int64_t end = is_assumed_until_next ? next : sure_end;
      for (std::int64_t t = rows_[i].utc_s; t < end; t += kQuarterS) {
        day.quarter_hours.push_back({.utc_s = t,
                                     .eur_per_mwh = rows_[i].eur_per_mwh,
                                     .resolution_min = resolution_min,
                                     .published_utc_s = rows_[i].published_utc_s,
                                     .is_assumed = t >= sure_end});
      }
    }
    if (step_s_ == kQuarterS && has_one_price_an_hour(day)) day.resolution_min = 60;
    return day;
  }

 private:
  [[nodiscard]] std::int64_t next_of(std::size_t i) const {
    return i + 1 < rows_.size() ? rows_[i + 1].utc_s : end_utc_s_;
  }
  /// Sources with a resolution have no merged rows.
  [[nodiscard]] bool may_go_on(std::size_t i) const {
    return rows_[i].resolution_min == 0 && has_price(rows_[i]);
  }
  [[nodiscard]] std::int64_t length_of(std::size_t i) const {
    const std::int64_t said_s = std::int64_t{60} * rows_[i].resolution_min;
    if (said_s != 0) return rows_.size() == 1 ? said_s : std::min(said_s, step_s_);
    const bool is_an_hour = rows_[i].utc_s % kHourS == 0 && i + 1 < rows_.size() &&
                            rows_[i + 1].utc_s == rows_[i].utc_s + kHourS;
    return is_an_hour ? kHourS : step_s_;
  }
  [[nodiscard]] std::int64_t sure_end_of(std::size_t i) const {
    return std::min(rows_[i].utc_s + length_of(i), next_of(i));
  }
  [[nodiscard]] int resolution_of(std::size_t i) const {
    return std::max(rows_[i].resolution_min, static_cast<int>(length_of(i) / 60));
  }
  /// Quarter-hours made from hours: many hours, each with one price.
  [[nodiscard]] static bool has_one_price_an_hour(const DayAheadDay& day) {
    constexpr int kHoursMin = 20;
    int whole = 0, quarters = 0;
    for (std::size_t q = 0; q < day.quarter_hours.size(); ++q) {
      const DayAheadQuarterHour& now = day.quarter_hours[q];
      const bool is_same_hour =
          q > 0 && now.utc_s / kHourS == day.quarter_hours[q - 1].utc_s / kHourS;
      if (is_same_hour && now.eur_per_mwh != day.quarter_hours[q - 1].eur_per_mwh) return false;
      quarters = is_same_hour ? quarters + 1 : 1;
      whole += quarters == 4 ? 1 : 0;
    }
    return whole >= kHoursMin;
  }

  std::vector<DayAheadRow> rows_;
  std::int64_t midnight_utc_s_;
  std::int64_t end_utc_s_;
  std::int64_t step_s_ = kHourS;  ///< 15, 30 or 60 minutes
};

/// Ascending distinct times; rows with a price take precedence.
std::vector<DayAheadRow> distinct(std::vector<DayAheadRow> rows, DayAheadLayout& layout) {
  std::ranges::stable_sort(rows, {}, &DayAheadRow::utc_s);
  std::vector<DayAheadRow> kept;
  for (const DayAheadRow& row : rows) {
    if (kept.empty() || kept.back().utc_s != row.utc_s) {
      kept.push_back(row);
      continue;
    }
    if (!has_price(row)) continue;
    DayAheadRow& before = kept.back();
    if (layout.contradiction_utc_s == 0 && has_price(before) &&
        before.eur_per_mwh != row.eur_per_mwh) {
      layout.contradiction_utc_s = row.utc_s;
      layout.contradicting_eur_per_mwh[0] = before.eur_per_mwh;
      layout.contradicting_eur_per_mwh[1] = row.eur_per_mwh;
    }
    before = row;
  }
  return kept;
}

}  // namespace

bool is_day_ahead_sentinel(double eur_per_mwh) {
  constexpr std::array kSentinels{-9'999.0, 9'999.0, -999.0};
  return std::ranges::find(kSentinels, eur_per_mwh) != kSentinels.end();
}

DayAheadAnswer parse_day_ahead_json(std::string_view text, const DayAheadFields& fields) {
  DayAheadAnswer answer;
  const Json json = parse_answer(text);
  const JsonValue root = json.value();
  const JsonValue unit = root.is_object() ? root["unit"] : JsonValue();
  if (const char* const name = unit.text(); name != nullptr && without_blanks(name) != "EUR/MWh") {
    answer.trouble = "prices in \"" + one_line(name, 20) + "\", EUR / MWh is required";
    return answer;
  }
  const JsonValue rows = root.is_list() ? root : value_at(root, fields.rows);
  if (!fields.rows.empty() && rows.is_list()) {
    for (const JsonValue row : rows) {
      add_row(value_at(row, fields.time), value_at(row, fields.price), answer);
    }
    return answer;
  }
  const JsonValue times = value_at(root, fields.time);
  const JsonValue prices = value_at(root, fields.price);
  if (!fields.rows.empty() || !times.is_list() || !prices.is_list() ||
      times.size() != prices.size()) {
    answer.trouble = fields.rows.empty()
                         ? "not two lists of equal length, " + std::string(fields.time) + " and " +
                               std::string(fields.price)
                         : "no list " + std::string(fields.rows);
    return answer;
  }
  auto price = prices.begin();
  for (const JsonValue time : times) {
    add_row(time, *price, answer);
    ++price;
  }
  return answer;
}

bool DayAheadDay::is_constant() const {
  constexpr std::size_t kHalfADay = 48;
  return quarter_hours.size() >= kHalfADay &&
         std::ranges::adjacent_find(quarter_hours, std::not_equal_to<>{},
                                    &DayAheadQuarterHour::eur_per_mwh) == quarter_hours.end();
}

DayAheadLayout lay_out_day_ahead(std::vector<DayAheadRow> rows) {
  DayAheadLayout layout;
  const auto no_quarter_hour =
      std::ranges::find_if(rows, [](const DayAheadRow& row) { return row.utc_s % kQuarterS != 0; });
  if (no_quarter_hour != rows.end()) {
    layout.trouble = std::string(utc_text(no_quarter_hour->utc_s).view()) +
                     " is not the start of a quarter-hour";
    return layout;
  }
  std::vector<DayRows> days;
  std::vector<DayAheadRow> of_day;
  std::int64_t midnight = 0, end = 0;
  const auto close_day = [&] {
    if (!of_day.empty()) days.emplace_back(std::exchange(of_day, {}), midnight);
  };
  for (const DayAheadRow& row : distinct(std::move(rows), layout)) {
    if (of_day.empty() || row.utc_s >= end) {
      close_day();
      midnight = local_midnight_utc_s(row.utc_s);
      end = local_midnight_utc_s(midnight, 1);
    }
    of_day.push_back(row);
  }
  close_day();
  const bool is_merged = std::ranges::any_of(days, &DayRows::is_merged);
  for (std::size_t d = 1; is_merged && d < days.size(); ++d) {
    days[d].begin_with_last_of(days[d - 1]);
  }
  for (const DayRows& day : days) layout.days.push_back(day.laid_out(is_merged));
  return layout;
}

}  // namespace bess
