#include "edge/app/storage/commission_file.h"

#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <filesystem>

#include "edge/app/storage/storage_health.h"
#include "edge/records/log/atomic_file.h"
#include "shared/crc32.h"
#include "shared/host/text.h"
#include "shared/host/toml_reader.h"
#include "shared/utc_text.h"

namespace bess {
namespace {

/// More than is ever written.
constexpr std::size_t kBytesMax = 8'192;

/// Paths in order of preference. The copy survives a flipped byte, the one in memory a failed disk.
std::vector<std::string> places_of(const EdgeConfig& config) {
  std::vector<std::string> places = {state_file(config, "commissioned.toml").c_str(),
                                     state_file(config, "commissioned.copy").c_str()};
  if (!config.state.run_folder.empty()) {
    places.emplace_back(run_file(config, "commissioned.toml").c_str());
  }
  return places;
}

/// Content of one place.
struct Stored {
  std::string path;
  std::string text;
  std::string loss;  ///< why it is not usable; "" = usable
  bool is_absent = false;
  bool is_checked = false;
  TomlValue document{};
};

constexpr const char* kHidden = "is not readable by this user";

std::string why_unreadable(int cause) {
  if (cause == ENOENT) return "is missing";
  if (cause == EPERM) return "belongs to another user";
  if (cause == EACCES) return kHidden;
  return std::string("cannot be read: ") + std::strerror(cause);
}

Stored read_place(const std::string& path) {
  Stored stored{.path = path, .text = std::string(kBytesMax, '\0'), .loss = ""};
  const ssize_t size = read_beginning(path.c_str(), stored.text, SymlinkPolicy::kRefused);
  if (size < 0) {
    stored.is_absent = errno == ENOENT;
    stored.loss = why_unreadable(errno);
    stored.text.clear();
    return stored;
  }
  stored.text.resize(static_cast<std::size_t>(size));
  std::string error;
  const ChecksumState state = check_text(stored.text, kCommentChecksum);
  stored.is_checked = state == ChecksumState::kIntact;
  if (state == ChecksumState::kBroken) {
    stored.loss = "is damaged: wrong checksum";
  } else if (!parse_toml_text(stored.text, path, stored.document, error)) {
    stored.loss = "is damaged: " + error;
  } else if (stored.document.find("battery") == nullptr) {
    stored.loss = "is damaged: truncated";
  }
  return stored;
}

using AllStored = std::vector<Stored>;

/// Prefers a file with a checksum (older versions and truncated files have none), then the order of
/// places. Null if none is usable.
const Stored* find_best(const AllStored& all) {
  const Stored* best = nullptr;
  for (const Stored& one : all) {
    const bool is_better = best == nullptr || (one.is_checked && !best->is_checked);
    if (one.loss.empty() && is_better) best = &one;
  }
  return best;
}

AllStored read_places(const EdgeConfig& config) {
  AllStored all;
  for (const std::string& path : places_of(config)) all.push_back(read_place(path));
  return all;
}

std::string why_not_commissioned(const AllStored& all) {
  const Stored& first = all.front();
  if (first.loss == kHidden) {
    return first.path + " " + kHidden + ": run this as the service's user, or with sudo";
  }
  const std::string why =
      std::ranges::all_of(all, &Stored::is_absent)
          ? ": missing: the battery's sign is not checked (or the disk of [state] folder is "
            "not mounted); run once: "
          : " " + first.loss +
                ", and no copy is usable: check that its disk is mounted and healthy, or "
                "check the sign again: ";
  return first.path + why + "bess-edge commission --config FILE --yes";
}

void add_file(const std::string& path, Crc32& crc) {
  const std::string text = contents_of(path);
  crc.add_bytes(text.data(), text.size());
}

/// Checksum of the map file and its included file: an edited map is another map.
std::string map_checksum(const EdgeConfig& config) {
  const std::string path(config.battery.map_path.view());
  Crc32 crc;
  add_file(path, crc);
  TomlValue document;
  std::string error;
  const bool is_map = parse_toml_file(path, document, error);
  const TomlValue* include = is_map ? document.find("include") : nullptr;
  if (const auto* name = include == nullptr ? nullptr : include->as<std::string>()) {
    add_file((std::filesystem::path(path).parent_path() / *name).string(), crc);
  }
  return formatted("%08x", crc.value());
}

/// Address with the unit ids of the map's groups: another id is another inverter.
std::string battery_text(const EdgeConfig& config) {
  std::string text(battery_place(config.battery).view());
  for (const UnitGroup& group : config.battery.map.unit_groups) {
    text.append(", ").append(group.name.view()).append(" ").append(std::to_string(group.unit));
  }
  return text;
}

/// Measured values, for people only.
void add_direction(const char* name, const DirectionResult& direction, std::string& text) {
  if (!direction.is_tested) return;
  const StepResponseResult& speed = direction.speed;
  add_formatted(text, "%s_measured_w = %d\n%s_lag_ms = %ld\n%s_time_constant_ms = %ld\n", name,
                direction.measured_power_w, name, std::lround(speed.dynamics.dead_time_s * 1e3),
                name, std::lround(speed.dynamics.time_constant_s * 1e3));
  add_formatted(text, "%s_ramp_w_per_s = %d%s\n", name, ramp_w_per_s(speed),
                ramp_w_per_s(speed) == 0 ? "  # faster than measurable" : "");
}

std::string file_text(const EdgeConfig& config, const CommissionResult& result,
                      std::int64_t utc_s) {
  const RegisterMap& map = config.battery.map;
  std::string text = formatted(
      "# Written by: bess-edge commission. Copies: commissioned.copy in this folder,\n"
      "# and [state] run_folder; a lost or damaged file is restored from a copy.\n"
      "map = \"%s\"\nvariant = \"%s\"\nmap_crc32 = \"%s\"\nbattery = \"%s\"\n"
      "ordered_power_w = %d\nmeasured_power_w = %d\nutc = \"%s\"\n",
      map.name.c_str(), map.variant.c_str(), map_checksum(config).c_str(),
      battery_text(config).c_str(), result.ordered_power_w, result.measured_power_w,
      utc_text(utc_s).c_str());
  add_direction("charge", result.charge, text);
  add_direction("discharge", result.discharge, text);
  if (result.meter != MeterVerdict::kNotAsked) {
    add_formatted(text, "meter_percent = %d\n", result.meter_percent);
  }
  text += "# Optional points of this device, now required.\npresent = [";
  for (const std::int8_t point : result.present) {
    add_formatted(text, "%s\"%s\"", point == result.present[0] ? "" : ", ",
                  map.points[point].name.c_str());
  }
  return text + "]\n";
}

/// Expected text of every place.
std::string whole_text(const Stored& good) {
  std::string text(without_checksum(good.text, kCommentChecksum));
  text += checksum_end(text, kCommentChecksum).view();
  return text;
}

/// Whether a place with another text is a loss. Memory emptied by a boot is none, nor a missing
/// copy of an older version, which wrote one file without a checksum.
bool is_loss(const EdgeConfig& config, const AllStored& all, const Stored& one,
             const Stored& good) {
  if (!one.is_absent) return &one != &good;
  const bool is_in_memory = &one == &all.back() && !config.state.run_folder.empty();
  return !is_in_memory && good.is_checked;
}

std::string loss_line(const Stored& one, const Stored& good) {
  std::string line = one.path + " ";
  if (one.loss.empty()) {
    line += one.is_checked ? "has other content" : "has no checksum";
  }
  line += one.loss;
  if (&one != &good) line += "; " + good.path + " is used";
  return line;
}

/// A line for each place with another text; none without a usable place. `end_of(place, expected
/// text, is_lost)` ends the line; empty: no line.
template <typename EndOf>
std::vector<std::string> lines_of_others(const EdgeConfig& config, const EndOf& end_of) {
  std::vector<std::string> lines;
  const AllStored all = read_places(config);
  const Stored* const good = find_best(all);
  if (good == nullptr) return lines;
  const std::string text = whole_text(*good);
  for (const Stored& one : all) {
    if (one.text == text) continue;
    const std::string end = end_of(one.path, text, is_loss(config, all, one, *good));
    if (!end.empty()) lines.push_back(loss_line(one, *good) + end);
  }
  return lines;
}

/// Compares one key of the file; an error names it.
bool expect_same(TomlTable& table, std::string_view key, const std::string& configured) {
  FixedText<255> found;
  table.require(key);
  table.text(key, found);
  if (!table.ok() || found.view() == configured) return table.ok();
  table.fail(key, "is \"" + std::string(found.view()) + "\", but the configuration has \"" +
                      configured + "\"");
  return false;
}

}  // namespace

bool write_commission_file(const EdgeConfig& config, const CommissionResult& result,
                           std::int64_t utc_s, std::string& error) {
  make_folder(config.state.folder.c_str());  // a failure is reported when writing
  std::string text = file_text(config, result, utc_s);
  text += checksum_end(text, kCommentChecksum).view();
  const std::vector<std::string> places = places_of(config);
  if (!replace_file_durably(places.front().c_str(), text)) {
    error = places.front() + ": cannot be written: " + std::strerror(errno) +
            "; correct the folder's permissions, its disk, or [state] folder, and repeat";
    return false;
  }
  if (!config.state.run_folder.empty()) make_folder(config.state.run_folder.c_str());
  // Old copies may be of another battery: remove them if they cannot be replaced.
  for (std::size_t i = 1; i < places.size(); ++i) {
    if (!replace_file_durably(places[i].c_str(), text)) unlink(places[i].c_str());
  }
  return true;
}

bool is_commissioned(const EdgeConfig& config, std::string& error) {
  const AllStored all = read_places(config);
  const Stored* const stored = find_best(all);
  if (stored == nullptr) {
    error = why_not_commissioned(all);
    return false;
  }
  TomlTable table(&stored->document, stored->path, "", error);
  const bool same = expect_same(table, "map", std::string(config.battery.map.name.view())) &&
                    expect_same(table, "variant", std::string(config.battery.map.variant.view())) &&
                    expect_same(table, "map_crc32", map_checksum(config)) &&
                    expect_same(table, "battery", battery_text(config));
  if (!same) error += "; check the sign again: bess-edge commission --config FILE --yes";
  return same;
}

std::vector<std::int8_t> commissioned_points(const EdgeConfig& config) {
  const AllStored all = read_places(config);
  const Stored* const stored = find_best(all);
  const TomlValue* const node = stored == nullptr ? nullptr : stored->document.find("present");
  const auto* const list = node == nullptr ? nullptr : node->as<TomlArray>();
  std::vector<std::int8_t> points;
  if (list == nullptr) return points;
  for (const TomlValue& item : *list) {
    const auto* const name = item.as<std::string>();
    const int point = name == nullptr ? -1 : find_point(config.battery.map, *name);
    if (point >= 0) points.push_back(static_cast<std::int8_t>(point));
  }
  return points;
}

std::vector<std::string> commission_file_losses(const EdgeConfig& config) {
  return lines_of_others(config, [](const std::string&, const std::string&, bool is_lost) {
    return is_lost ? "; a start in control restores it" : "";
  });
}

std::vector<std::string> repair_commission_file(const EdgeConfig& config) {
  const auto restore = [](const std::string& path, const std::string& text, bool is_lost) {
    if (replace_file_durably(path.c_str(), text)) return std::string(is_lost ? "; restored" : "");
    return formatted("; cannot be written: %s", std::strerror(errno));
  };
  return lines_of_others(config, restore);
}

}  // namespace bess
