#include "shared/host/json_reader.h"

#include <cmath>
#include <set>
#include <string_view>

namespace bess {

JsonReader::JsonReader(JsonValue object, std::string file, std::string kind)
    : object_(object), file_(std::move(file)), kind_(std::move(kind)) {
  std::set<std::string_view> keys;
  for (const JsonValue each : object) {
    if (!each.key().empty() && !keys.insert(each.key()).second) {
      fail("{}: not {}: duplicate \"{}\"", file_, kind_, each.key());
    }
  }
}

JsonValue JsonReader::member(const char* key) const {
  const JsonValue found = object_[key];
  if (!found.exists()) fail("{}: not {}: \"{}\" is missing", file_, kind_, key);
  return found;
}

std::string JsonReader::text(const char* key) const {
  const char* found = member(key).text();
  if (found == nullptr) fail("{}: \"{}\" is not a text", file_, key);
  return found;
}

double JsonReader::number(const char* key) const {
  const auto found = member(key).number();
  if (!found) fail("{}: \"{}\" is not a number", file_, key);
  return *found;
}

JsonReader JsonReader::object(const char* key) const {
  const JsonValue found = member(key);
  if (!found.is_object()) fail("{}: \"{}\" is not an object", file_, key);
  return {found, file_, kind_};
}

std::int64_t JsonReader::whole(const char* key, std::int64_t min, std::int64_t max) const {
  const double value = number(key);
  if (!(value >= static_cast<double>(min) && value <= static_cast<double>(max)) ||
      value != std::trunc(value)) {
    fail("{}: \"{}\" is not a whole number in {}..{}", file_, key, min, max);
  }
  return static_cast<std::int64_t>(value);
}

}  // namespace bess
