#include "workstation/market/feed/market_json.h"

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

#include "shared/host/json.h"
#include "shared/host/text.h"
#include "shared/host/user_error.h"

namespace bess {
namespace {

/// Which of two members of one name is meant nobody knows.
void require_each_once(JsonValue object, std::string_view place) {
  std::vector<std::string_view> keys;
  for (const JsonValue item : object) keys.emplace_back(item.key());
  std::ranges::sort(keys);
  const auto twice = std::ranges::adjacent_find(keys);
  if (twice == keys.end()) return;
  fail("{}: \"{}\" stands twice in one object; download the file again", place,
       one_line(*twice, 40));
}

JsonValue find_records(JsonValue root, std::string_view name) {
  if (root.is_list()) return root;
  if (root.is_object()) require_each_once(root, name);
  for (const char* key : {"results", "records"}) {
    const JsonValue records = root[key];
    if (records.is_list()) return records;
  }
  fail("{}: no list of records (an array, or \"results\"); expected an answer of Elia's API", name);
}

void parse_record(JsonValue record, std::string_view place, MarketRows& rows) {
  if (!record.is_object()) fail("{}: is not an object; download the file again", place);
  require_each_once(record, place);
  const JsonValue fields = record["fields"];
  if (fields.is_object()) require_each_once(fields, place);
  MarketRowBuilder builder(place);
  for (const JsonValue item : fields.is_object() ? fields : record) {
    const std::optional<MarketField> field = market_field_of(item.key());
    if (!field) continue;
    const bool is_text = *field == MarketField::kTime || *field == MarketField::kResolution ||
                         *field == MarketField::kQuarterHour;
    if (const char* text = item.text()) {
      builder.set_text(*field, text);
    } else if (const auto number = item.number(); number && !is_text) {
      builder.set_number(*field, *number);
    } else if (!item.is_null()) {
      fail("{}: \"{}\" has a value of the wrong kind; download the file again", place,
           one_line(item.key(), 40));
    }
  }
  builder.finish(rows);
}

}  // namespace

MarketRows parse_market_json(std::string_view text, std::string_view name) {
  const Json json = Json::parse(text);
  if (!json.value().exists()) {
    fail("{}: not valid JSON, perhaps cut short; download it again", name);
  }
  MarketRows rows;
  std::size_t number = 0;
  std::string place;
  for (const JsonValue record : find_records(json.value(), name)) {
    place.assign(name).append(": record ").append(std::to_string(++number));
    parse_record(record, place, rows);
  }
  return rows;
}

}  // namespace bess
