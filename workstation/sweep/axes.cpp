#include "workstation/sweep/axes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "shared/host/user_error.h"
#include "workstation/base/random.h"
#include "workstation/chain/run_config.h"

namespace bess {
namespace {

[[noreturn]] void complain(const TomlValue& value, const std::string& what) {
  fail("{}:{}: {}", *value.file, value.line, what);
}

/// "[section] key" as the configuration lists it.
std::string listed_name(const std::string& key) {
  const std::size_t dot = key.find('.');
  return fmt::format("[{}] {}", key.substr(0, dot), key.substr(dot + 1));
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

const TomlMembers* members_of(const TomlValue& value) { return value.as<TomlMembers>(); }

/// KEY of a plan: written "section.key" in quotes, or as section.key, which TOML makes a table of.
template <typename Take>
void for_each_key(const TomlValue& table, const Take& take) {
  const auto* members = table.as<TomlMembers>();
  if (members == nullptr) complain(table, "expected KEY = VALUE lines");
  for (const auto& [name, value] : *members) {
    const TomlMembers* section = members_of(value);
    if (name.find('.') != name.npos || section == nullptr) {
      take(name, value);
      continue;
    }
    for (const auto& [key, inner] : *section) take(name + "." + key, inner);
  }
}

double bound(const TomlValue& table, const char* name, const std::string& key) {
  const TomlValue* value = table.find(name);
  const auto number = value == nullptr ? std::nullopt : value->number();
  if (!number) {
    complain(table, fmt::format("{}: write {{ low = NUMBER, high = NUMBER }}, with log = true for "
                                "draws by the logarithm, or {{ among = [VALUES] }}",
                                key));
  }
  (void)canonical_value(key, *value);  // within the key's range
  return *number;
}

RandomAxis read_random_axis(const std::string& key, const TomlValue& value) {
  RandomAxis axis;
  axis.key = key;
  if (const TomlValue* among = value.find("among")) {
    axis.among = canonical_values(key, *among);
    return axis;
  }
  axis.low = bound(value, "low", key);
  axis.high = bound(value, "high", key);
  axis.is_whole = value.find("low")->as<std::int64_t>() != nullptr &&
                  value.find("high")->as<std::int64_t>() != nullptr;
  const TomlValue* log = value.find("log");
  axis.by_logarithm = log != nullptr && log->as<bool>() != nullptr && *log->as<bool>();
  if (!(axis.low < axis.high)) complain(value, key + ": low must be below high");
  if (axis.by_logarithm && axis.low <= 0) complain(value, key + ": log needs low above 0");
  return axis;
}

/// A decimal number of six digits: what is drawn can be typed again.
std::string drawn_value(const RandomAxis& axis, Random& random) {
  if (!axis.among.empty()) return axis.among[random.index(axis.among.size())];
  const double share = random.uniform();
  const double value = axis.by_logarithm ? axis.low * std::pow(axis.high / axis.low, share)
                                         : axis.low + (axis.high - axis.low) * share;
  if (axis.is_whole) return fmt::format("{}", std::lround(value));
  return fmt::format("{}", std::stod(fmt::format("{:.6g}", value)));
}

std::vector<Entries> with_grid(std::vector<Entries> points, const std::vector<GridAxis>& grid) {
  for (const GridAxis& axis : grid) {
    std::vector<Entries> more;
    for (const Entries& point : points) {
      for (const std::string& value : axis.values) {
        more.push_back(point);
        more.back().emplace_back(axis.key, value);
      }
    }
    points = std::move(more);
  }
  return points;
}

void require_one_axis_a_key(const Axes& axes) {
  std::set<std::string> keys;
  const auto add = [&](const std::string& key) {
    if (!keys.insert(key).second) fail("{}: stands on more than one axis; leave it on one", key);
  };
  for (const GridAxis& axis : axes.grid) add(axis.key);
  for (const RandomAxis& axis : axes.random) add(axis.key);
  std::set<std::string> listed;
  for (const Entries& point : axes.list) {
    for (const auto& entry : point) listed.insert(entry.first);
  }
  for (const std::string& key : listed) add(key);
}

}  // namespace

std::string canonical_value(const std::string& key, const TomlValue& value) {
  RunConfig config;
  set_config_key(config, key, value);
  const Entries entries = config_entries(config);
  return std::ranges::find(entries, listed_name(key), &Entries::value_type::first)->second;
}

std::vector<GridAxis> read_grid(const TomlValue& table) {
  std::vector<GridAxis> grid;
  for_each_key(table, [&](const std::string& key, const TomlValue& value) {
    grid.push_back({key, canonical_values(key, value)});
  });
  return grid;
}

std::vector<Entries> read_list(const TomlValue& tables) {
  const auto* list = tables.as<TomlArray>();
  if (list == nullptr) complain(tables, "write [[list]], once for each point");
  std::vector<Entries> points;
  for (const TomlValue& table : *list) {
    points.emplace_back();
    for_each_key(table, [&](const std::string& key, const TomlValue& value) {
      points.back().emplace_back(key, canonical_value(key, value));
    });
  }
  return points;
}

void read_random(const TomlValue& table, Axes& axes) {
  for_each_key(table, [&](const std::string& key, const TomlValue& value) {
    const auto* whole = value.as<std::int64_t>();
    if (key == "count" || key == "seed") {
      const std::int64_t low = key == "count" ? 1 : 0;
      if (whole == nullptr || *whole < low || *whole > 1'000'000) {
        complain(value, fmt::format("[random] {}: use {} to 1000000", key, low));
      }
      if (key == "count") axes.draws = static_cast<int>(*whole);
      if (key == "seed") axes.random_seed = static_cast<std::uint64_t>(*whole);
      return;
    }
    axes.random.push_back(read_random_axis(key, value));
  });
  if (axes.draws == 0) complain(table, "[random] needs count = NUMBER, how many points are drawn");
}

GridAxis read_set_option(const std::string& text) {
  const std::size_t equals = text.find('=');
  const std::string name = "--set " + text;
  if (equals == text.npos || equals == 0 || equals + 1 == text.size()) {
    fail("{}: write --set section.key=VALUE[,VALUE], such as --set distil.fidelity=1,2", name);
  }
  const std::string values = text.substr(equals + 1);
  TomlValue document;
  std::string error;
  if (!parse_toml_text("v = [" + values + "]", name, document, error)) {
    // Words need no quotes on a command line.
    std::string quoted = "v = [\"";
    for (const char c : values) quoted += c == ',' ? std::string("\",\"") : std::string(1, c);
    error.clear();
    if (!parse_toml_text(quoted + "\"]", name, document, error)) throw UserError(error);
  }
  const std::string key = text.substr(0, equals);
  return {key, canonical_values(key, *document.find("v"))};
}

std::vector<Entries> points_of(const Axes& axes) {
  require_one_axis_a_key(axes);
  std::vector<Entries> listed = axes.list.empty() ? std::vector<Entries>(1) : axes.list;
  std::vector<Entries> points;
  Random random(axes.random_seed);
  for (int draw = 0; draw < std::max(1, axes.draws); ++draw) {
    Entries drawn;
    for (const RandomAxis& axis : axes.random) {
      drawn.emplace_back(axis.key, drawn_value(axis, random));
    }
    for (Entries point : listed) {
      point.insert(point.end(), drawn.begin(), drawn.end());
      points.push_back(std::move(point));
    }
  }
  return with_grid(std::move(points), axes.grid);
}

}  // namespace bess
