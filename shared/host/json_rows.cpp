#include "shared/host/json_rows.h"

#include <algorithm>
#include <iterator>
#include <string>

#include "shared/utc_text.h"

namespace bess {
namespace {

constexpr double kFirstMilliseconds = 1e11;  // as seconds this is the year 5138
constexpr double kLastMilliseconds = 1e14;

/// NaN and Infinity as null, outside of texts.
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

/// cJSON keeps members of one name and gives the first.
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

Json parse_answer(std::string_view text) {
  Json json = Json::parse(text);
  const bool has_words = text.find("NaN") != text.npos || text.find("Infinity") != text.npos;
  return json.value().exists() || !has_words ? std::move(json) : Json::parse(without_nan(text));
}

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
