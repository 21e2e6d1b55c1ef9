#include "workstation/sweep/points.h"

#include <fmt/format.h>

#include <algorithm>
#include <functional>

#include "shared/host/file.h"
#include "shared/host/toml_reader.h"
#include "shared/host/user_error.h"
#include "workstation/chain/run_config.h"

namespace bess {
namespace {

[[noreturn]] void complain(const TomlValue& value, const std::string& what) {
  fail("{}:{}: {}", *value.file, value.line, what);
}

/// As the configuration writes it.
std::string canonical_value(const std::string& key, const TomlValue& value) {
  RunConfig config;
  set_config_key(config, key, value);
  const std::size_t dot = key.find('.');
  const std::string listed = fmt::format("[{}] {}", key.substr(0, dot), key.substr(dot + 1));
  const Entries entries = config_entries(config);
  return std::ranges::find(entries, listed, &Entries::value_type::first)->second;
}

std::vector<std::string> canonical_values(const std::string& key, const TomlValue& value) {
  const auto* list = value.as<TomlArray>();
  if (list == nullptr) return {canonical_value(key, value)};
  if (list->empty()) complain(value, key + ": the list of values is empty");
  std::vector<std::string> values;
  for (const TomlValue& one : *list) {
    values.push_back(canonical_value(key, one));
    if (std::ranges::count(values, values.back()) > 1) {
      complain(one, fmt::format("{}: {} stands there twice", key, values.back()));
    }
  }
  return values;
}

/// KEY of a plan: written "section.key" in quotes, or as section.key, which TOML makes a table of.
void for_each_key(const TomlValue& table,
                  const std::function<void(const std::string&, const TomlValue&)>& take) {
  const auto* members = table.as<TomlMembers>();
  if (members == nullptr) complain(table, "expected KEY = VALUE lines");
  for (const auto& [name, value] : *members) {
    const auto* section = value.as<TomlMembers>();
    if (name.find('.') != name.npos || section == nullptr) {
      take(name, value);
      continue;
    }
    for (const auto& [key, inner] : *section) take(name + "." + key, inner);
  }
}

std::vector<Entries> read_list(const TomlArray& list) {
  std::vector<Entries> points;
  for (const TomlValue& table : list) {
    points.emplace_back();
    for_each_key(table, [&](const std::string& key, const TomlValue& value) {
      points.back().emplace_back(key, canonical_value(key, value));
    });
  }
  return points;
}

/// Each of them once for each value.
void combine(std::vector<Entries>& points, const std::string& key, const TomlValue& values) {
  std::vector<Entries> more;
  for (const Entries& point : points) {
    for (const std::string& value : canonical_values(key, values)) {
      more.push_back(point);
      more.back().emplace_back(key, value);
    }
  }
  points = std::move(more);
}

void combine_with_set(std::vector<Entries>& points, const std::string& set) {
  const std::size_t equals = set.find('=');
  const std::string name = "--set " + set;
  if (equals == set.npos || equals == 0 || equals + 1 == set.size()) {
    fail("{}: write --set section.key=VALUE[,VALUE], such as --set distil.fidelity=1,2", name);
  }
  const std::string values = set.substr(equals + 1);
  TomlValue document;
  std::string error;
  if (!parse_toml_text("v = [" + values + "]", name, document, error)) {
    // Words need no quotes on a command line.
    std::string quoted = "v = [\"";
    for (const char c : values) quoted += c == ',' ? std::string("\",\"") : std::string(1, c);
    error.clear();
    if (!parse_toml_text(quoted + "\"]", name, document, error)) throw UserError(error);
  }
  combine(points, set.substr(0, equals), *document.find("v"));
}

}  // namespace

std::vector<Entries> read_points(const std::string& plan, const std::vector<std::string>& sets) {
  std::vector<Entries> points(1);
  TomlValue document;
  std::string error;
  const std::string text = plan.empty() ? "" : read_file(plan, kTomlBytesMax);
  if (!parse_toml_text(text, plan, document, error)) throw UserError(error);
  TomlTable root(&document, plan, "", error);
  if (const TomlArray* list = root.array("list")) points = read_list(*list);
  if (const TomlValue* grid = root.table("grid")) {
    for_each_key(*grid, [&](const std::string& key, const TomlValue& values) {
      combine(points, key, values);
    });
  }
  root.finish();
  if (!error.empty()) throw UserError(error);
  for (const std::string& set : sets) combine_with_set(points, set);
  return points;
}

}  // namespace bess
