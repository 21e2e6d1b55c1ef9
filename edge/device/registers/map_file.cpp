#include "edge/device/registers/map_file.h"

#include "edge/device/registers/map_reader.h"

namespace bess {
namespace {

constexpr int kVariantsMax = 8;

std::string name_in(const TomlValue& node) {
  const TomlValue* found = node.find("name");
  const auto* name = found == nullptr ? nullptr : found->as<std::string>();
  return name == nullptr ? std::string() : *name;
}

void overlay(TomlMembers& base, TomlMembers& over);

/// Points are merged by name: a variant changes some keys of a point and keeps the others.
void overlay_points(TomlArray& base, TomlArray& over) {
  for (TomlValue& item : over) {
    TomlValue* same = nullptr;
    for (TomlValue& old : base) {
      if (!name_in(item).empty() && name_in(old) == name_in(item)) same = &old;
    }
    if (same != nullptr) {
      overlay(*same->as<TomlMembers>(), *item.as<TomlMembers>());
    } else {
      base.push_back(std::move(item));
    }
  }
}

/// Merges `over` into `base`: tables by key, points by name; other values are replaced.
void overlay(TomlMembers& base, TomlMembers& over) {
  for (auto& [key, value] : over) {
    TomlValue& old = base[key];
    auto* members = old.as<TomlMembers>();
    auto* points = key == "point" ? old.as<TomlArray>() : nullptr;
    if (members != nullptr && value.as<TomlMembers>() != nullptr) {
      overlay(*members, *value.as<TomlMembers>());
    } else if (points != nullptr && value.as<TomlArray>() != nullptr) {
      overlay_points(*points, *value.as<TomlArray>());
    } else {
      old = std::move(value);
    }
  }
}

/// Parses the file, merged over the file that it includes.
bool parse_map_file(const std::string& path, TomlValue& document, std::string& error) {
  if (!parse_toml_file(path, document, error)) return false;
  TomlTable root(&document, path, "", error);
  FixedText<63> include;
  root.text("include", include);
  if (!root.ok() || !root.has("include")) return root.ok();
  const std::string name(include.view());
  if (name.empty() || name.find('/') != std::string::npos) {
    root.fail("include", "must name a file in the same folder");
    return false;
  }
  TomlValue base;
  if (!parse_toml_file(root.resolved(name), base, error)) return false;
  if (base.find("include") != nullptr) {
    root.fail("include", "names a file that itself has an include: only one level is allowed");
    return false;
  }
  document.as<TomlMembers>()->erase("include");
  overlay(*base.as<TomlMembers>(), *document.as<TomlMembers>());
  document = std::move(base);
  return true;
}

bool list_variants(const TomlValue& document, const std::string& path,
                   std::vector<std::string>& names, std::string& error) {
  TomlTable root(&document, path, "", error);
  const TomlArray* list = root.array("variant");
  if (list == nullptr) return root.ok();
  for (const TomlValue& item : *list) {
    names.push_back(name_in(item));
    if (names.back().empty()) root.fail_at(item, "[[variant]] name is missing: add it");
  }
  if (names.empty()) root.fail("variant", "is empty: remove it");
  if (names.size() > kVariantsMax) root.fail("variant", "holds more than 8 variants");
  return root.ok();
}

/// Sections for batteries only.
void read_map_control(TomlTable& root, const MapDefaults& defaults, RegisterMap& map) {
  for (const std::string_view key : {"power", "watchdog", "command"}) root.require(key);
  read_map_limits(root, map);
  read_map_watchdog(root, map);
  read_map_commands(root, defaults, map);
}

/// Reads the map merged with one of its variants; -1 = the file has none.
bool read_map(const std::string& path, TomlValue document, int variant, RegisterMap& map,
              std::string& error) {
  map = RegisterMap{};
  if (variant >= 0) {
    auto& members = *document.as<TomlMembers>();
    TomlValue chosen =
        (*document.find("variant")->as<TomlArray>())[static_cast<std::size_t>(variant)];
    members.erase("variant");
    TomlTable header(&chosen, path, "[[variant]]", error);
    FixedText<255> description;
    header.text("name", map.variant);
    header.text("description", description);
    if (!header.ok()) return false;
    chosen.as<TomlMembers>()->erase("name");
    chosen.as<TomlMembers>()->erase("description");
    overlay(members, *chosen.as<TomlMembers>());
  }
  TomlTable root(&document, path, "", error);
  for (const std::string_view key : {"map", "state", "point"}) root.require(key);
  MapDefaults defaults;
  const RegisterName variant_name = map.variant;
  read_map_header(root, map, defaults);
  map.variant = variant_name;
  read_map_points(root, defaults, map);
  read_map_state(root, map);
  read_map_identity(root, map);
  if (!map.is_meter) read_map_control(root, defaults, map);
  read_map_policies(root, map);
  read_map_simulator(root, map);
  root.finish();
  check_map(root, map);
  return error.empty();
}

}  // namespace

bool load_register_map(const std::string& path, std::string_view variant, RegisterMap& map,
                       std::string& error) {
  TomlValue document;
  std::vector<std::string> names;
  if (!parse_map_file(path, document, error)) return false;
  if (!list_variants(document, path, names, error)) return false;
  int chosen = names.empty() && variant.empty() ? -1 : variant.empty() ? 0 : -2;
  std::string listed;
  for (std::size_t i = 0; i < names.size(); ++i) {
    listed += (i == 0 ? "" : ", ") + names[i];
    if (chosen == -2 && names[i] == variant) chosen = static_cast<int>(i);
  }
  if (chosen == -2) {
    TomlTable root(&document, path, "", error);
    root.fail("variant", quoted(variant) + " does not exist (available: " + listed + ")");
    return false;
  }
  for (int i = 0; i < static_cast<int>(names.size()); ++i) {
    if (i == chosen) continue;  // other variants must be valid too
    if (!read_map(path, document, i, map, error)) return false;
  }
  return read_map(path, std::move(document), chosen, map, error);
}

}  // namespace bess
