#include "workstation/data/market/feed/market_files.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "shared/host/text.h"
#include "shared/utc_text.h"

namespace bess {
namespace {

using enum MarketField;

/// Names without case and punctuation.
constexpr std::array<std::pair<std::string_view, MarketField>, 17> kFieldNames{{
    {"datetime", kTime},
    {"datetimeutc", kTime},
    {"resolutioncode", kResolution},
    {"quarterhour", kQuarterHour},
    {"quarterhourutc", kQuarterHour},
    {"systemimbalance", kSystemImbalance},
    {"systemimbalancemw", kSystemImbalance},
    {"alpha", kAlpha},
    {"alphaeurmwh", kAlpha},
    {"marginalincrementalprice", kMarginalIncremental},
    {"mipeurmwh", kMarginalIncremental},
    {"marginaldecrementalprice", kMarginalDecremental},
    {"mdpeurmwh", kMarginalDecremental},
    {"imbalanceprice", kPrice},
    {"positiveimbalanceprice", kPositivePrice},
    {"negativeimbalanceprice", kNegativePrice},
    {"priceeurmwh", kPrice},
}};

/// Names used in custom files.
constexpr std::array<std::string_view, 8> kTimeNames{"datetime", "date",  "time",   "timestamp",
                                                     "",         "start", "minute", "starttime"};
constexpr std::array<std::string_view, 7> kPriceNames{
    "price", "imbalanceprice", "settledprice", "settled", "imbalance", "", "indicative"};
constexpr std::array<std::string_view, 2> kClocks{"utc", "local"};
constexpr std::array<std::string_view, 8> kUnits{"eurpermwh", "eurmwh", "mwh", "eurperkwh",
                                                 "eurkwh",    "ctkwh",  "kwh", "eur"};

constexpr std::size_t kQuotedMax = 40;

}  // namespace

bool is_absent(std::string_view text) {
  constexpr std::array<std::string_view, 7> kAbsent{"", "null", "NaN", "nan", "n/a", "N/A", "NA"};
  return std::ranges::find(kAbsent, text) != kAbsent.end();
}

/// "Alpha'" must not become "alpha": the apostrophe is spelled as in the API (alpha_prime).
std::string plain_name(std::string_view label) {
  std::string name;
  for (const char c : label) {
    if (c >= 'A' && c <= 'Z') name.push_back(static_cast<char>(c - 'A' + 'a'));
    if ((c >= 'a' && c <= 'z') || (c >= '0' && c <= '9')) name.push_back(c);
    if (c == '\'') name += "prime";
  }
  return name;
}

std::optional<MarketField> market_field_of(std::string_view label) {
  const std::string name = plain_name(label);
  for (const auto& [known, field] : kFieldNames) {
    if (name == known) return field;
  }
  return std::nullopt;
}

bool may_be_called(std::string_view label, MarketField field) {
  const std::string name = plain_name(label);
  std::string_view base = name;
  const auto without = [&base](auto ends) {
    const auto end = std::ranges::find_if(ends, [&](auto part) { return base.ends_with(part); });
    if (end != ends.end()) base.remove_suffix(end->size());
  };
  if (field == kTime) {
    without(kClocks);
    return !name.empty() && std::ranges::find(kTimeNames, base) != kTimeNames.end();
  }
  without(kUnits);
  return !name.empty() && std::ranges::find(kPriceNames, base) != kPriceNames.end();
}

void MarketRowBuilder::set_text(MarketField field, std::string_view text) {
  if (is_absent(text)) return;
  if (field == kResolution) {
    resolution_ = text;
  } else if (field == kQuarterHour) {
    has_quarter_hour_ = true;
  } else if (field == kTime) {
    std::int64_t utc_s = 0;
    if (!parse_utc(text, utc_s, kAlsoBlank)) {
      fail(
          "{}: \"{}\" is not a time with its UTC offset, e.g. 2023-01-31T00:15:00+01:00; export "
          "the file again with time zone UTC",
          place_, one_line(text, kQuotedMax));
    }
    utc_s_ = utc_s;
  } else {
    std::string number(text);
    const std::size_t comma = number.find(',');
    const bool is_decimal_comma = has_decimal_commas_ && number.find('.') == number.npos;
    if (comma != number.npos && is_decimal_comma) number[comma] = '.';
    double value = 0;
    if (!read_number(number, value) || !std::isfinite(value)) {
      fail("{}: \"{}\" is not a number; correct the row or delete it", place_,
           one_line(text, kQuotedMax));
    }
    set_number(field, value);
  }
}

void MarketRowBuilder::set_number(MarketField field, double value) {
  if (!std::isfinite(value)) fail("{}: a number is out of range; correct the row", place_);
  numbers_[static_cast<std::size_t>(field)] = value;
}

bool MarketRowBuilder::is_minute() const {
  if (resolution_ == "PT1M") return true;
  if (resolution_ == "PT15M") return false;
  if (resolution_.empty()) return has_quarter_hour_;  // tidy files have no code
  fail("{}: resolution \"{}\" is neither PT1M nor PT15M; use the imbalance price datasets", place_,
       one_line(resolution_, 20));
}

void MarketRowBuilder::finish(MarketRows& rows) const {
  if (!utc_s_) fail("{}: the row has no time; correct or delete it", place_);
  const bool minute = is_minute();
  if (*utc_s_ % (minute ? 60 : kSecondsPerQuarterHour) != 0) {
    fail("{}: {} does not start a {}; correct the time", place_, utc_text(*utc_s_).view(),
         minute ? "minute" : "quarter-hour");
  }
  const auto number = [this](MarketField field) {
    return numbers_[static_cast<std::size_t>(field)];
  };
  const PartyPrices parties{number(kPositivePrice), number(kNegativePrice)};
  const bool has_price = is_published(number(kPrice));
  const double price = has_price ? number(kPrice) : parties.single();
  if (minute) {
    rows.minutes.push_back({*utc_s_, price});
  } else {
    rows.quarter_hours.push_back({*utc_s_, price, number(kSystemImbalance), number(kAlpha),
                                  number(kMarginalIncremental), number(kMarginalDecremental)});
  }
  if (!has_price && parties.are_different()) {
    (minute ? rows.dual_priced_minutes : rows.dual_priced_quarter_hours).insert(*utc_s_);
  }
  // All Elia datasets have the resolution code, tidy files never.
  rows.sources.insert(resolution_.empty() ? MarketSource::kUnknown : MarketSource::kElia);
}

void append_rows(MarketRows& all, const MarketRows& rows) {
  if (!all.zone.empty() && !rows.zone.empty() && rows.zone != all.zone) {
    fail("prices of the zone {} and of {}; import one zone at a time", all.zone, rows.zone);
  }
  if (all.zone.empty()) all.zone = rows.zone;
  all.minutes.insert(all.minutes.end(), rows.minutes.begin(), rows.minutes.end());
  all.quarter_hours.insert(all.quarter_hours.end(), rows.quarter_hours.begin(),
                           rows.quarter_hours.end());
  const auto unite = [](auto& all_values, const auto& values) {
    all_values.insert(values.begin(), values.end());
  };
  unite(all.dual_priced_minutes, rows.dual_priced_minutes);
  unite(all.dual_priced_quarter_hours, rows.dual_priced_quarter_hours);
  unite(all.sources, rows.sources);
}

}  // namespace bess
