#include "edge/prices/fetch/price_json.h"

#include <algorithm>
#include <cmath>

#include "shared/host/json.h"
#include "shared/units_and_limits.h"

namespace bess {
namespace {

constexpr std::int64_t kClockToleranceS = 5;  // difference of the server's clock to ours

bool parse_price(JsonValue price, const PriceFields& fields, PriceRow& row) {
  constexpr double kExact = 1e-6;  // rounding error of cents in doubles
  const std::optional<double> number = price.number();
  if (!number || std::ranges::count(fields.no_price, *number) > 0) return false;
  const double centi = *number * kCentiPerEur * fields.eur_per_mwh_e1 / 10;
  if (!std::isfinite(centi) || std::fabs(centi) > kPlausiblePriceMaxCentiEurPerMwh) return false;
  row.price_centi_eur_per_mwh = static_cast<std::int32_t>(std::lround(centi));
  row.is_finer_than_cents = std::fabs(*number * 100 - std::round(*number * 100)) > kExact;
  return true;
}

bool parse_row(JsonValue item, const PriceFields& fields, std::int64_t now_utc_s, PriceRow& row) {
  row.minute_utc_s = time_in(value_at(item, fields.time.view())).value_or(-1);
  return row.minute_utc_s >= 0 && parse_price(value_at(item, fields.price.view()), fields, row) &&
         row.minute_utc_s % 60 == 0 &&                           // start of a minute
         row.minute_utc_s + 60 <= now_utc_s + kClockToleranceS;  // that has ended
}

}  // namespace

PriceAnswer parse_prices(std::string_view json, const PriceFields& fields, std::int64_t now_utc_s) {
  PriceAnswer answer{.status = Status::kMalformed};
  const Json document = parse_answer(json);
  const JsonValue root = document.value();
  const JsonValue items = root.is_object() ? value_at(root, fields.rows.view()) : root;
  if (!items.is_list()) return answer;
  for (const JsonValue item : items) {
    ++answer.items;
    PriceRow row;
    if (parse_row(item, fields, now_utc_s, row)) answer.rows.push_back(row);
  }
  answer.status = answer.rows.empty() ? Status::kNoRow : Status::kOk;
  return answer;
}

Status parse_newest_price(std::string_view json, const PriceFields& fields, std::int64_t now_utc_s,
                          PriceRow& row) {
  const PriceAnswer answer = parse_prices(json, fields, now_utc_s);
  if (!answer.rows.empty())
    row = *std::ranges::max_element(answer.rows, {}, &PriceRow::minute_utc_s);
  return answer.status;
}

}  // namespace bess
