#include "edge/program/commission_file.h"

#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "edge/log/whole_file.h"
#include "shared/crc32.h"
#include "shared/host/toml_reader.h"
#include "shared/utc_text.h"

namespace bess {
namespace {

std::string path_of(const EdgeConfig& config) {
  return state_file(config, "commissioned.toml").c_str();
}

void add_file(const std::string& path, Crc32& crc) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream bytes;
  bytes << file.rdbuf();
  const std::string text = bytes.str();
  crc.add_bytes(text.data(), text.size());
}

/// Of the bytes of the map file and of the one that it includes: an edited map is another map.
std::string map_checksum(const EdgeConfig& config) {
  const std::string path(config.map_path.view());
  Crc32 crc;
  add_file(path, crc);
  TomlValue document;
  std::string error;
  const bool is_map = parse_toml_file(path, document, error);
  const TomlValue* include = is_map ? document.find("include") : nullptr;
  if (const auto* name = include == nullptr ? nullptr : include->as<std::string>()) {
    add_file((std::filesystem::path(path).parent_path() / *name).string(), crc);
  }
  char hex[16];
  std::snprintf(hex, sizeof hex, "%08x", crc.value());
  return hex;
}

/// Where it is, with the unit ids of the map's groups: another id is another inverter.
std::string battery_text(const EdgeConfig& config) {
  std::string text(battery_place(config).view());
  for (const UnitGroup& group : config.map.unit_groups) {
    text.append(", ").append(group.name.view()).append(" ").append(std::to_string(group.unit));
  }
  return text;
}

/// What was found out, for people: nothing is compared with it.
void add_direction(std::string_view name, const DirectionResult& direction,
                   std::ostringstream& text) {
  if (!direction.is_tested) return;
  text << name << "_measured_w = " << direction.measured_power_w << "\n"
       << name << "_lag_ms = " << direction.lag_ms << "\n"
       << name << "_ramp_w_per_s = " << direction.ramp_w_per_s
       << (direction.ramp_w_per_s == 0 ? "  # faster than could be seen\n" : "\n");
}

std::string file_text(const EdgeConfig& config, const CommissionResult& result,
                      std::int64_t utc_s) {
  std::ostringstream text;
  text << "# Written by: bess-edge commission. Delete it to ask for a new sign check.\n"
       << "map = \"" << config.map.name.view() << "\"\n"
       << "variant = \"" << config.map.variant.view() << "\"\n"
       << "map_crc32 = \"" << map_checksum(config) << "\"\n"
       << "battery = \"" << battery_text(config) << "\"\n"
       << "ordered_power_w = " << result.ordered_power_w << "\n"
       << "measured_power_w = " << result.measured_power_w << "\n"
       << "utc = \"" << utc_text(utc_s).view() << "\"\n";
  add_direction("charge", result.charge, text);
  add_direction("discharge", result.discharge, text);
  if (result.meter != MeterVerdict::kNotAsked) {
    text << "meter_percent = " << result.meter_percent << "\n";
  }
  return text.str();
}

/// The file's keys, compared one by one; the first that differs is named.
bool expect_same(TomlTable& table, std::string_view key, const std::string& configured) {
  FixedText<255> found;
  table.require(key);
  table.text(key, found);
  if (!table.ok() || found.view() == configured) return table.ok();
  table.fail(key, "is \"" + std::string(found.view()) + "\", the configuration now has \"" +
                      configured + "\"");
  return false;
}

}  // namespace

bool write_commission_file(const EdgeConfig& config, const CommissionResult& result,
                           std::int64_t utc_s, std::string& error) {
  const std::string path = path_of(config);
  make_folder(config.state.folder.c_str());  // when it fails, the open below says why
  if (replace_file_durably(path.c_str(), file_text(config, result, utc_s))) return true;
  error = path + ": cannot write here: " + std::strerror(errno) +
          "; mend the folder's permissions, or [state] folder, and repeat";
  return false;
}

bool is_commissioned(const EdgeConfig& config, std::string& error) {
  const std::string path = path_of(config);
  if (access(path.c_str(), F_OK) != 0) {
    error = path +
            ": not there: the battery's sign has not been checked; run once: bess-edge commission "
            "--config FILE --yes";
    return false;
  }
  TomlValue document;
  if (!parse_toml_file(path, document, error)) return false;
  TomlTable table(&document, path, "", error);
  const bool same = expect_same(table, "map", std::string(config.map.name.view())) &&
                    expect_same(table, "variant", std::string(config.map.variant.view())) &&
                    expect_same(table, "map_crc32", map_checksum(config)) &&
                    expect_same(table, "battery", battery_text(config));
  if (!same) error += "; check the sign again: bess-edge commission --config FILE --yes";
  return same;
}

}  // namespace bess
