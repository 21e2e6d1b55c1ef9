#include "edge/prices/price_json.h"

#include <cjson/cJSON.h>

#include <cmath>
#include <memory>

#include "shared/units_and_limits.h"
#include "shared/utc_text.h"

namespace bess {
namespace {

constexpr std::int64_t kClockToleranceS = 5;  // of the server's clock against ours
constexpr double kFirstMilliseconds = 1e11;   // as seconds this is the year 5138
constexpr double kLastMilliseconds = 1e14;

using Json = std::unique_ptr<cJSON, decltype(&cJSON_Delete)>;

/// The item at "a.b.c" below an object; null when there is none.
const cJSON* item_at(const cJSON* item, std::string_view path) {
  while (item != nullptr && !path.empty()) {
    const std::size_t dot = path.find('.');
    const FixedText<63> name(path.substr(0, dot));
    item = cJSON_GetObjectItemCaseSensitive(item, name.c_str());
    path = dot == std::string_view::npos ? std::string_view{} : path.substr(dot + 1);
  }
  return item;
}

bool parse_time(const cJSON* time, std::int64_t& utc_s) {
  if (cJSON_IsString(time)) return parse_utc(time->valuestring, utc_s);
  if (!cJSON_IsNumber(time)) return false;
  const double number = time->valuedouble;
  if (!(number >= 0 && number < kLastMilliseconds)) return false;
  const auto whole = static_cast<std::int64_t>(number);
  utc_s = number < kFirstMilliseconds ? whole : whole / 1'000;
  return true;
}

bool parse_price(const cJSON* price, std::int32_t& centi_eur_per_mwh) {
  if (!cJSON_IsNumber(price)) return false;  // null: not published yet
  const double centi = price->valuedouble * kCentiPerEur;
  if (!std::isfinite(centi) || std::fabs(centi) > kPlausiblePriceMaxCentiEurPerMwh) return false;
  centi_eur_per_mwh = static_cast<std::int32_t>(std::lround(centi));
  return true;
}

bool parse_row(const cJSON* item, const PriceFields& fields, std::int64_t now_utc_s,
               PriceRow& row) {
  if (!parse_time(item_at(item, fields.time.view()), row.minute_utc_s)) return false;
  if (!parse_price(item_at(item, fields.price.view()), row.price_centi_eur_per_mwh)) return false;
  if (row.minute_utc_s % 60 != 0) return false;                  // not the start of a minute
  return row.minute_utc_s + 60 <= now_utc_s + kClockToleranceS;  // else it cannot exist yet
}

}  // namespace

Status parse_prices(std::string_view json, const PriceFields& fields, std::int64_t now_utc_s,
                    const PriceRowTaker& taker, int& items) {
  items = 0;
  const Json root(cJSON_ParseWithLength(json.data(), json.size()), &cJSON_Delete);
  if (root == nullptr) return Status::kMalformed;
  const cJSON* rows = root.get();
  if (cJSON_IsObject(rows)) rows = item_at(rows, fields.rows.view());
  if (!cJSON_IsArray(rows)) return Status::kMalformed;
  bool found = false;
  const cJSON* item = nullptr;
  cJSON_ArrayForEach(item, rows) {
    ++items;
    PriceRow row;
    if (!parse_row(item, fields, now_utc_s, row)) continue;
    taker.take(taker.self, row);
    found = true;
  }
  return found ? Status::kOk : Status::kNoRow;
}

Status parse_newest_price(std::string_view json, const PriceFields& fields, std::int64_t now_utc_s,
                          PriceRow& row) {
  struct Newest {
    PriceRow& row;
    bool found = false;
  } newest{.row = row};
  int items = 0;
  const auto keep_newer = [](void* self, const PriceRow& candidate) {
    auto& best = *static_cast<Newest*>(self);
    if (!best.found || candidate.minute_utc_s > best.row.minute_utc_s) best.row = candidate;
    best.found = true;
  };
  return parse_prices(json, fields, now_utc_s, {&newest, keep_newer}, items);
}

}  // namespace bess
