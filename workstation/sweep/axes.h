// What a sweep varies: a grid of every combination, a list of points, and seeded random draws. All
// come down to points, each some keys of the configuration with their values; values are looked at
// where they are written, by the configuration's own list of keys.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "shared/host/toml_document.h"
#include "workstation/base/entries.h"

namespace bess {

/// One key and the values that it takes.
struct GridAxis {
  std::string key;  ///< "section.key"
  std::vector<std::string> values;
};

/// A key that is drawn: between two bounds, evenly or by its logarithm; or one among some values.
struct RandomAxis {
  std::string key;
  double low = 0, high = 0;
  bool by_logarithm = false;
  bool is_whole = false;
  std::vector<std::string> among{};
};

struct Axes {
  std::vector<GridAxis> grid;
  std::vector<Entries> list;  ///< each is combined with the whole grid
  std::vector<RandomAxis> random;
  int draws = 0;
  std::uint64_t random_seed = 1;
};

/// As the configuration writes the value of a key. Throws UserError naming its file and line.
std::string canonical_value(const std::string& key, const TomlValue& value);

/// [grid] of a plan: KEY = [VALUES].
std::vector<GridAxis> read_grid(const TomlValue& table);
/// [[list]]: KEY = VALUE each.
std::vector<Entries> read_list(const TomlValue& tables);
/// [random]: count, seed, and KEY = { low, high, log } or { among = [VALUES] } each.
void read_random(const TomlValue& table, Axes& axes);
/// KEY=VALUE[,VALUE...] of the command line.
GridAxis read_set_option(const std::string& text);

/// Grid x list x draws, in this order, the last of the grid fastest; one empty point without any.
/// Throws UserError when a key stands on more than one of them.
std::vector<Entries> points_of(const Axes& axes);

}  // namespace bess
