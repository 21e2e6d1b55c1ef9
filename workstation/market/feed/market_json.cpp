// JSON downloads: the API's records (`results`), exports (a bare array) and version 1
// (`records[].fields`).
#include <cjson/cJSON.h>

#include <memory>
#include <string>

#include "shared/host/text.h"
#include "shared/host/user_error.h"
#include "workstation/market/feed/market_rows.h"

namespace bess {
namespace {

struct Delete {
  void operator()(cJSON* json) const { cJSON_Delete(json); }
};

const cJSON* find_records(const cJSON* root, std::string_view name) {
  if (cJSON_IsArray(root)) return root;
  for (const char* key : {"results", "records"}) {
    const cJSON* records = cJSON_GetObjectItemCaseSensitive(root, key);
    if (cJSON_IsArray(records)) return records;
  }
  fail("{}: no list of records (an array, or \"results\"); expected an answer of Elia's API", name);
}

void parse_record(const cJSON* record, std::string_view place, MarketRows& rows) {
  if (!cJSON_IsObject(record)) fail("{}: is not an object; download the file again", place);
  const cJSON* fields = cJSON_GetObjectItemCaseSensitive(record, "fields");
  MarketRowBuilder builder(place);
  for (const cJSON* item = cJSON_IsObject(fields) ? fields->child : record->child; item != nullptr;
       item = item->next) {
    const std::optional<MarketField> field = market_field_of(item->string);
    if (!field) continue;
    const bool is_text = *field == MarketField::kTime || *field == MarketField::kResolution ||
                         *field == MarketField::kQuarterHour;
    if (cJSON_IsString(item)) {
      builder.set_text(*field, item->valuestring);
    } else if (cJSON_IsNumber(item) && !is_text) {
      builder.set_number(*field, item->valuedouble);
    } else if (!cJSON_IsNull(item)) {
      fail("{}: \"{}\" has a value of the wrong kind; download the file again", place,
           one_line(item->string, 40));
    }
  }
  builder.finish(rows);
}

}  // namespace

MarketRows parse_market_json(std::string_view text, std::string_view name) {
  const std::unique_ptr<cJSON, Delete> root(cJSON_ParseWithLength(text.data(), text.size()));
  if (!root) fail("{}: not valid JSON, perhaps cut short; download it again", name);
  MarketRows rows;
  std::size_t number = 0;
  std::string place;
  for (const cJSON* record = find_records(root.get(), name)->child; record != nullptr;
       record = record->next) {
    place.assign(name).append(": record ").append(std::to_string(++number));
    parse_record(record, place, rows);
  }
  return rows;
}

}  // namespace bess
