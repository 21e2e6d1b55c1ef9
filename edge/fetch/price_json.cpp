#include "edge/fetch/price_json.h"

#include <cjson/cJSON.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <iterator>
#include <memory>
#include <string>

#include "shared/units_and_limits.h"
#include "shared/utc_text.h"

namespace bess {
namespace {

constexpr std::int64_t kClockToleranceS = 5;  // of the server's clock against ours
constexpr double kFirstMilliseconds = 1e11;   // as seconds this is the year 5138
constexpr double kLastMilliseconds = 1e14;

using Json = std::unique_ptr<cJSON, decltype(&cJSON_Delete)>;

/// Python and JavaScript write NaN and Infinity, which are no JSON: as null, outside of texts.
std::string without_nan(std::string_view json) {
  std::string text;
  bool is_inside = false;
  for (std::size_t i = 0; i < json.size(); ++i) {
    const std::string_view rest = json.substr(i);
    if (is_inside && json[i] == '\\') {
      text += rest.substr(0, 2);
      ++i;
      continue;
    }
    is_inside = is_inside != (json[i] == '"');
    const std::string_view words[] = {"NaN", "-Infinity", "Infinity"};
    const auto* const word =
        std::ranges::find_if(words, [&](std::string_view w) { return rest.starts_with(w); });
    if (is_inside || word == std::end(words)) {
      text += json[i];
      continue;
    }
    text += "null";
    i += word->size() - 1;
  }
  return text;
}

/// The whole text as one document; null when it is none, or when more than blanks follow it, which
/// cJSON would pass over.
Json parse_whole(std::string_view json) {
  const char* end = nullptr;
  Json root(cJSON_ParseWithLengthOpts(json.data(), json.size(), &end, 0), &cJSON_Delete);
  if (root == nullptr) return root;
  const std::string_view rest = json.substr(static_cast<std::size_t>(end - json.data()));
  if (rest.find_first_not_of(" \t\r\n") != std::string_view::npos) root.reset();
  return root;
}

Json parse_document(std::string_view json) {
  Json root = parse_whole(json);
  const bool has_words = json.find("NaN") != json.npos || json.find("Infinity") != json.npos;
  return root == nullptr && has_words ? parse_whole(without_nan(json)) : std::move(root);
}

struct Found {
  const cJSON* item = nullptr;  ///< null: there is none
  bool is_twice = false;        ///< in its object
};

/// cJSON keeps members of one name and gives the first.
Found member_of(const cJSON* object, const char* name) {
  Found found;
  if (!cJSON_IsObject(object)) return found;
  const cJSON* member = nullptr;
  cJSON_ArrayForEach(member, object) {
    if (std::strcmp(member->string, name) != 0) continue;
    found.is_twice = found.item != nullptr;
    if (found.is_twice) return found;
    found.item = member;
  }
  return found;
}

/// The item at "a.b.c" below an object.
Found item_at(const cJSON* object, std::string_view path) {
  Found found{.item = object};
  while (found.item != nullptr && !path.empty()) {
    const std::size_t dot = path.find('.');
    const FixedText<63> name(path.substr(0, dot));
    found = member_of(found.item, name.c_str());
    if (found.is_twice) return found;
    path = dot == std::string_view::npos ? std::string_view{} : path.substr(dot + 1);
  }
  return found;
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

bool parse_price(const cJSON* price, const PriceFields& fields, PriceRow& row) {
  constexpr double kExact = 1e-6;            // of doubles that were cents
  if (!cJSON_IsNumber(price)) return false;  // null: not published yet
  const double number = price->valuedouble;
  for (const double none : fields.no_price) {
    if (number == none) return false;
  }
  const double centi = number * kCentiPerEur * fields.eur_per_mwh_e1 / 10;
  if (!std::isfinite(centi) || std::fabs(centi) > kPlausiblePriceMaxCentiEurPerMwh) return false;
  row.price_centi_eur_per_mwh = static_cast<std::int32_t>(std::lround(centi));
  row.is_finer_than_cents = std::fabs(number * 100 - std::round(number * 100)) > kExact;
  return true;
}

/// kNoRow: it is passed over.
Status parse_row(const cJSON* item, const PriceFields& fields, std::int64_t now_utc_s,
                 PriceRow& row) {
  const Found time = item_at(item, fields.time.view());
  const Found price = item_at(item, fields.price.view());
  if (time.is_twice || price.is_twice) return Status::kNoRow;
  const bool is_row = parse_time(time.item, row.minute_utc_s) &&
                      parse_price(price.item, fields, row) &&
                      row.minute_utc_s % 60 == 0 &&  // the start of a minute
                      row.minute_utc_s + 60 <= now_utc_s + kClockToleranceS;  // that has ended
  return is_row ? Status::kOk : Status::kNoRow;
}

/// The list of rows; null when there is none.
const cJSON* rows_of(const cJSON* root, const PriceFields& fields) {
  const Found rows = cJSON_IsObject(root) ? item_at(root, fields.rows.view()) : Found{.item = root};
  return !rows.is_twice && cJSON_IsArray(rows.item) ? rows.item : nullptr;
}

/// kNoRow: it is passed over.
Status take_timed(const cJSON* time, const cJSON* price, const PriceFields& fields,
                  const PriceRowTaker& taker) {
  PriceRow row;
  if (!parse_time(time, row.minute_utc_s) || !parse_price(price, fields, row)) {
    return Status::kNoRow;
  }
  taker.take(taker.self, row);
  return Status::kOk;
}

Status parse_lists(const cJSON* root, const PriceFields& fields, const PriceRowTaker& taker) {
  const Found times = item_at(root, fields.time.view());
  const Found prices = item_at(root, fields.price.view());
  if (times.is_twice || prices.is_twice || !cJSON_IsArray(times.item) ||
      !cJSON_IsArray(prices.item) ||
      cJSON_GetArraySize(times.item) != cJSON_GetArraySize(prices.item)) {
    return Status::kMalformed;
  }
  Status status = Status::kNoRow;
  const cJSON* price = prices.item->child;
  for (const cJSON* time = times.item->child; time != nullptr; time = time->next) {
    if (take_timed(time, price, fields, taker) == Status::kOk) status = Status::kOk;
    price = price->next;
  }
  return status;
}

}  // namespace

Status parse_day_ahead(std::string_view json, const PriceFields& fields,
                       const PriceRowTaker& taker) {
  const Json root = parse_document(json);
  if (root == nullptr) return Status::kMalformed;
  if (fields.rows.empty()) return parse_lists(root.get(), fields, taker);
  const cJSON* const rows = rows_of(root.get(), fields);
  if (rows == nullptr) return Status::kMalformed;
  Status status = Status::kNoRow;
  const cJSON* item = nullptr;
  cJSON_ArrayForEach(item, rows) {
    const Found time = item_at(item, fields.time.view());
    const Found price = item_at(item, fields.price.view());
    if (time.is_twice || price.is_twice) continue;
    if (take_timed(time.item, price.item, fields, taker) == Status::kOk) status = Status::kOk;
  }
  return status;
}

Status parse_prices(std::string_view json, const PriceFields& fields, std::int64_t now_utc_s,
                    const PriceRowTaker& taker, int& items) {
  items = 0;
  const Json root = parse_document(json);
  const cJSON* const rows = rows_of(root.get(), fields);
  if (rows == nullptr) return Status::kMalformed;
  const cJSON* item = nullptr;
  bool found = false;
  cJSON_ArrayForEach(item, rows) {
    ++items;
    PriceRow row;
    if (parse_row(item, fields, now_utc_s, row) != Status::kOk) continue;
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
