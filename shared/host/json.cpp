#include "shared/host/json.h"

#include <cjson/cJSON.h>
#include <algorithm>

#include <charconv>
#include <cmath>
#include <limits>
#include <new>

#include "shared/host/text.h"
#include "shared/utc_text.h"

namespace bess {
namespace {

/// cJSON returns null when out of memory.
cJSON* made(cJSON* item) {
  if (item == nullptr) throw std::bad_alloc();
  return item;
}

/// cJSON writes numbers with 15 or 17 digits, and whole numbers as doubles.
cJSON* number_item(double number, int decimals_max) {
  if (!std::isfinite(number)) return made(cJSON_CreateNull());
  constexpr int kDigitsMax = std::numeric_limits<double>::max_exponent10 + 64;
  char digits[kDigitsMax] = {};
  char* const last = digits + kDigitsMax - 1;
  if (decimals_max < 0) {
    std::to_chars(digits, last, number);
  } else {
    std::to_chars(digits, last, number, std::chars_format::fixed, decimals_max);
  }
  return made(cJSON_CreateRaw(digits));
}

std::string taken(char* printed) {
  if (printed == nullptr) throw std::bad_alloc();
  std::string text(printed);
  cJSON_free(printed);
  return text;
}

/// Replaces NaN and Infinity by null, outside of text.
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

constexpr double kFirstMilliseconds = 1e11;  // in seconds: year 5138
constexpr double kLastMilliseconds = 1e14;

/// cJSON keeps duplicate members and returns the first.
JsonValue only_member(JsonValue object, std::string_view name) {
  JsonValue found;
  if (!object.is_object()) return found;
  for (const JsonValue member : object) {
    if (member.key() != name) continue;
    if (found.exists()) return JsonValue();
    found = member;
  }
  return found;
}

}  // namespace

bool JsonValue::is_null() const { return cJSON_IsNull(item_) != 0; }
bool JsonValue::is_object() const { return cJSON_IsObject(item_) != 0; }
bool JsonValue::is_list() const { return cJSON_IsArray(item_) != 0; }

std::optional<bool> JsonValue::boolean() const {
  if (!cJSON_IsBool(item_)) return {};
  return cJSON_IsTrue(item_) != 0;
}

std::optional<double> JsonValue::number() const {
  if (!cJSON_IsNumber(item_)) return {};
  return item_->valuedouble;
}

const char* JsonValue::text() const {
  return cJSON_IsString(item_) != 0 ? item_->valuestring : nullptr;
}

std::string_view JsonValue::key() const {
  return item_ == nullptr || item_->string == nullptr ? std::string_view() : item_->string;
}

JsonValue JsonValue::operator[](const char* key) const {
  return JsonValue(cJSON_GetObjectItemCaseSensitive(item_, key));
}

JsonValue::Iterator& JsonValue::Iterator::operator++() {
  item_ = item_->next;
  return *this;
}

JsonValue::Iterator JsonValue::begin() const {
  return Iterator(item_ == nullptr ? nullptr : item_->child);
}

std::size_t JsonValue::size() const { return static_cast<std::size_t>(cJSON_GetArraySize(item_)); }

void Json::Delete::operator()(cJSON* item) const { cJSON_Delete(item); }

bool looks_like_json(std::string_view text) {
  text = without_byte_order_mark(text);
  const std::size_t first = text.find_first_not_of(" \t\r\n");
  return first != text.npos && (text[first] == '{' || text[first] == '[');
}

Json Json::parse(std::string_view text) {
  const char* end = nullptr;
  Json json(cJSON_ParseWithLengthOpts(text.data(), text.size(), &end, 0));
  if (!json.value().exists()) return json;
  const std::string_view rest = text.substr(static_cast<std::size_t>(end - text.data()));
  if (rest.find_first_not_of(" \t\r\n") != std::string_view::npos) json.item_.reset();
  return json;
}

Json parse_answer(std::string_view text) {
  Json json = Json::parse(text);
  const bool has_words = text.find("NaN") != text.npos || text.find("Infinity") != text.npos;
  return json.value().exists() || !has_words ? std::move(json) : Json::parse(without_nan(text));
}

Json::Json(std::string_view text) : Json(made(cJSON_CreateString(std::string(text).c_str()))) {}
Json::Json(double number) : Json(number_item(number, -1)) {}
Json::Json(Decimals number) : Json(number_item(number.value, number.count)) {}
Json Json::of_boolean(bool value) { return Json(made(cJSON_CreateBool(value ? 1 : 0))); }
Json Json::of_whole(const std::string& digits) {
  return Json(made(cJSON_CreateRaw(digits.c_str())));
}
Json Json::null() { return Json(made(cJSON_CreateNull())); }
Json Json::list() { return Json(made(cJSON_CreateArray())); }

Json Json::object(std::initializer_list<JsonMember> members) {
  Json json(made(cJSON_CreateObject()));
  for (const JsonMember& member : members) json.set(member.key, std::move(member.value));
  return json;
}

void Json::set(const char* key, Json value) {
  if (!cJSON_AddItemToObject(item_.get(), key, value.item_.get())) throw std::bad_alloc();
  static_cast<void>(value.item_.release());  // owned by the object now
}

void Json::add(Json value) {
  if (!cJSON_AddItemToArray(item_.get(), value.item_.get())) throw std::bad_alloc();
  static_cast<void>(value.item_.release());
}

std::string Json::line() const { return taken(cJSON_PrintUnformatted(item_.get())); }
std::string Json::text() const { return taken(cJSON_Print(item_.get())) + "\n"; }

JsonValue value_at(JsonValue object, std::string_view path) {
  while (object.exists() && !path.empty()) {
    const std::size_t dot = path.find('.');
    object = only_member(object, path.substr(0, dot));
    path = dot == path.npos ? std::string_view{} : path.substr(dot + 1);
  }
  return object;
}

std::optional<std::int64_t> time_in(JsonValue value) {
  std::int64_t utc_s = 0;
  if (const char* const text = value.text()) {
    return parse_utc(text, utc_s) ? std::optional(utc_s) : std::nullopt;
  }
  const std::optional<double> number = value.number();
  if (!number || !(*number >= 0 && *number < kLastMilliseconds)) return {};
  const auto whole = static_cast<std::int64_t>(*number);
  return *number < kFirstMilliseconds ? whole : whole / 1'000;
}

}  // namespace bess
