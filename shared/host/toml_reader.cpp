#include "shared/host/toml_reader.h"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstring>

#include "shared/host/toml_text.h"

namespace bess {
namespace {

std::string number_text(double value) {
  char buffer[32];
  std::snprintf(buffer, sizeof buffer, "%.10g", value);
  return buffer;
}

/// A user's text may hold line ends; a message is one line.
std::string in_one_line(std::string_view message) {
  std::string text(message);
  std::replace_if(
      text.begin(), text.end(), [](unsigned char c) { return c < 0x20 || c == 0x7F; }, '?');
  return text;
}

std::string range_text(double min, double max) {
  return "must lie between " + number_text(min) + " and " + number_text(max);
}

}  // namespace

bool TomlTable::has(std::string_view key) const {
  return table_ != nullptr && table_->get(key) != nullptr;
}

const toml::node* TomlTable::node(std::string_view key) {
  asked_.emplace(key);
  return table_ == nullptr ? nullptr : table_->get(key);
}

void TomlTable::fail_at(const toml::node& node, std::string_view message) {
  if (!error_.empty()) return;
  const auto& path = node.source().path;  // of an included file, when the node came from there
  error_ = in_one_line(path != nullptr ? *path : file_) + ":" +
           std::to_string(node.source().begin.line) + ": " + in_one_line(message);
}

void TomlTable::fail(std::string_view key, std::string_view message) {
  if (!error_.empty()) return;
  const toml::node* at = table_ == nullptr ? nullptr : table_->get(key);
  if (at == nullptr) at = table_;
  const std::string text =
      where_ + (where_.empty() ? "" : " ") + std::string(key) + " " + std::string(message);
  if (at != nullptr) return fail_at(*at, text);
  error_ = file_ + ": " + in_one_line(text);
}

void TomlTable::require(std::string_view key) {
  if (!has(key)) fail(key, "is missing: add it");
}

template <typename T>
const toml::value<T>* TomlTable::find(std::string_view key, std::string_view type_name) {
  const toml::node* found = node(key);
  if (found == nullptr) return nullptr;
  const toml::value<T>* value = found->as<T>();
  if (value == nullptr) fail(key, "must be " + std::string(type_name));
  return value;
}

void TomlTable::boolean(std::string_view key, bool& value) {
  if (const auto* found = find<bool>(key, "true or false")) value = found->get();
}

void TomlTable::integer(std::string_view key, std::int64_t& value, std::int64_t min,
                        std::int64_t max) {
  const auto* found = find<std::int64_t>(key, "a whole number");
  if (found == nullptr) return;
  if (found->get() < min || found->get() > max) {
    return fail(key, "must lie between " + std::to_string(min) + " and " + std::to_string(max));
  }
  value = found->get();
}

void TomlTable::integer(std::string_view key, std::int32_t& value, std::int64_t min,
                        std::int64_t max) {
  std::int64_t wide = value;
  integer(key, wide, min, max);
  value = static_cast<std::int32_t>(wide);
}

void TomlTable::scaled(std::string_view key, std::int32_t& value, double scale, double min,
                       double max) {
  const toml::node* found = node(key);
  if (found == nullptr) return;
  const auto number = found->value<double>();  // accepts 4 as well as 4.0
  if (!number || found->is_boolean()) return fail(key, "must be a number");
  if (!std::isfinite(*number) || *number < min || *number > max) {
    return fail(key, range_text(min, max));
  }
  value = static_cast<std::int32_t>(std::lround(*number * scale));
}

bool TomlTable::find_text(std::string_view key, std::string_view& value) {
  const auto* found = find<std::string>(key, "text in quotes");
  if (found == nullptr) return false;
  value = found->get();
  return true;
}

void TomlTable::choice(std::string_view key, int& index,
                       std::initializer_list<std::string_view> choices) {
  std::string_view found;
  if (!find_text(key, found)) return;
  std::string names;
  int i = 0;
  for (const std::string_view choice : choices) {
    if (choice == found) {
      index = i;
      return;
    }
    names += (i++ == 0 ? "\"" : ", \"") + std::string(choice) + "\"";
  }
  fail(key, "must be one of " + names);
}

const toml::table* TomlTable::table(std::string_view key) {
  const toml::node* found = node(key);
  if (found == nullptr) return nullptr;
  if (!found->is_table()) fail(key, "must be a table");
  return found->as_table();
}

const toml::array* TomlTable::array(std::string_view key) {
  const toml::node* found = node(key);
  if (found == nullptr) return nullptr;
  if (!found->is_array()) fail(key, "must be a list in [ ]");
  return found->as_array();
}

void TomlTable::finish() {
  if (table_ == nullptr || !error_.empty()) return;
  for (const auto& [key, value] : *table_) {
    if (asked_.contains(key.str())) continue;
    std::string known;
    for (const std::string& name : asked_) known += (known.empty() ? "" : ", ") + name;
    if (known.empty()) known = "none";
    return fail(key.str(), "is not a known key here (known: " + known + ")");
  }
}

bool parse_toml_file(const std::string& path, toml::table& document, std::string& error) {
  std::FILE* file = std::fopen(path.c_str(), "rb");
  if (file == nullptr) {
    error = path + ": cannot open: " + std::strerror(errno);
    return false;
  }
  std::string text;
  char buffer[4096];
  for (std::size_t got = 0; (got = std::fread(buffer, 1, sizeof buffer, file)) > 0;) {
    text.append(buffer, got);
  }
  const bool read_failed = std::ferror(file) != 0;
  std::fclose(file);
  if (read_failed) {
    error = path + ": cannot read (is it a folder?)";
    return false;
  }
  if (const int line = line_of_bare_non_ascii(text); line > 0) {
    error = path + ":" + std::to_string(line) + ": " + std::string(kBareNonAsciiMessage);
    return false;
  }
  toml::parse_result result = toml::parse(text, path);
  if (result.failed()) {
    error = path + ":" + std::to_string(result.error().source().begin.line) +
            ": not valid TOML: " + in_one_line(result.error().description());
    return false;
  }
  document = std::move(result).table();
  return true;
}

}  // namespace bess
