#include "shared/host/toml_reader.h"

#include <cmath>
#include <filesystem>

#include "shared/host/text.h"

namespace bess {

const TomlValue* TomlTable::node(std::string_view key) {
  asked_.emplace(key);
  return find(key);
}

void TomlTable::fail_at(const TomlValue& value, std::string_view message) {
  if (!error_.empty()) return;
  const std::string& file = value.file != nullptr ? *value.file : file_;  // may be an included one
  error_ = one_line(file) + ":" + std::to_string(value.line) + ": " + one_line(message);
}

void TomlTable::fail(std::string_view key, std::string_view message) {
  if (!error_.empty()) return;
  const TomlValue* at = has(key) ? find(key) : table_;
  const std::string text =
      where_ + (where_.empty() ? "" : " ") + std::string(key) + " " + std::string(message);
  if (at != nullptr) return fail_at(*at, text);
  error_ = file_ + ": " + one_line(text);
}

void TomlTable::require(std::string_view key) {
  if (!has(key)) fail(key, "is missing: add it");
}

template <typename T>
const T* TomlTable::expect(std::string_view key, std::string_view message) {
  const TomlValue* found = node(key);
  if (found == nullptr) return nullptr;
  const T* held = found->as<T>();
  if (held == nullptr) fail(key, message);
  return held;
}

void TomlTable::boolean(std::string_view key, bool& value) {
  if (const bool* found = expect<bool>(key, "must be true or false")) value = *found;
}

void TomlTable::integer(std::string_view key, std::int64_t& value, std::int64_t min,
                        std::int64_t max) {
  const auto* found = expect<std::int64_t>(key, "must be a whole number");
  if (found == nullptr) return;
  if (*found < min || *found > max) {
    return fail(key, "must lie between " + std::to_string(min) + " and " + std::to_string(max) +
                         ", not at " + std::to_string(*found));
  }
  value = *found;
}

void TomlTable::number(std::string_view key, double& value, double min, double max) {
  const TomlValue* found = node(key);
  if (found == nullptr) return;
  const auto number = found->number();
  if (!number) return fail(key, "must be a number");
  if (!std::isfinite(*number) || *number < min || *number > max) {
    const bool is_percent = max <= 1 && *number > 1 && *number / 100 >= min && *number / 100 <= max;
    const std::string remedy = is_percent
                                   ? formatted(": write %.10g for %.10g %%", *number / 100, *number)
                                   : formatted(", not at %.10g", *number);
    return fail(key, formatted("must lie between %.10g and %.10g", min, max) + remedy);
  }
  value = *number;
}

void TomlTable::scaled(std::string_view key, std::int32_t& value, double scale, double min,
                       double max) {
  if (!has(key)) return static_cast<void>(node(key));
  double found = 0;
  number(key, found, min, max);
  if (ok()) value = static_cast<std::int32_t>(std::lround(found * scale));
}

const std::string* TomlTable::text(std::string_view key) {
  return expect<std::string>(key, "must be text in quotes");
}

void TomlTable::line(std::string_view key, std::string& value) {
  const std::string* const found = text(key);
  if (found == nullptr) return;
  for (const char c : *found) {
    if (static_cast<unsigned char>(c) < 0x20) return fail(key, "must be one line of text");
  }
  value = *found;
}

std::string TomlTable::resolved(std::string_view path) const {
  return (std::filesystem::path(file_).parent_path() / path).string();
}

void TomlTable::choice(std::string_view key, int& index,
                       std::span<const std::string_view> choices) {
  const std::string* found = text(key);
  if (found == nullptr) return;
  std::string names;
  int i = 0;
  for (const std::string_view choice : choices) {
    if (choice == *found) {
      index = i;
      return;
    }
    names += (i++ == 0 ? "\"" : ", \"") + std::string(choice) + "\"";
  }
  fail(key, "must be one of " + names + ", not \"" + *found + "\"");
}

const TomlValue* TomlTable::table(std::string_view key) {
  return expect<TomlMembers>(key, "must be a table") == nullptr ? nullptr : find(key);
}

const TomlArray* TomlTable::array(std::string_view key) {
  return expect<TomlArray>(key, "must be a list in [ ]");
}

bool TomlTable::take_retired(std::string_view key) {
  retired_.emplace(key);
  return has(key);
}

void TomlTable::finish() {
  if (table_ == nullptr || !error_.empty()) return;
  for (const auto& [key, value] : *table_->as<TomlMembers>()) {
    if (asked_.contains(key) || retired_.contains(key)) continue;
    std::string known;
    for (const std::string& name : asked_) known += (known.empty() ? "" : ", ") + name;
    if (known.empty()) known = "none";
    const std::string meant = did_you_mean(key, {asked_.begin(), asked_.end()});
    return fail(key, "is not a known key here" + meant + " (known: " + known + ")");
  }
}

}  // namespace bess
