#include "edge/registers/map_file.h"

#include "edge/registers/map_reader.h"

namespace bess {
namespace {

constexpr int kVariantsMax = 8;

std::string name_in(const toml::node& node) {
  const toml::table* table = node.as_table();
  const auto* name = table == nullptr ? nullptr : table->get_as<std::string>("name");
  return name == nullptr ? std::string() : name->get();
}

void overlay(toml::table& base, toml::table& over);

/// Points are overlaid by name: a variant changes some keys of one point and leaves the others.
void overlay_points(toml::array& base, toml::array& over) {
  for (toml::node& item : over) {
    toml::node* same = nullptr;
    for (toml::node& old : base) {
      if (item.is_table() && !name_in(item).empty() && name_in(old) == name_in(item)) same = &old;
    }
    if (same != nullptr) {
      overlay(*same->as_table(), *item.as_table());
    } else {
      base.push_back(std::move(item));
    }
  }
}

/// Lays `over` upon `base`: tables key by key, points by name, everything else replaces. Nodes are
/// moved, because only so they keep the line that error messages name.
void overlay(toml::table& base, toml::table& over) {
  for (auto&& [key, node] : over) {
    toml::node* old = base.get(key);
    if (old != nullptr && old->is_table() && node.is_table()) {
      overlay(*old->as_table(), *node.as_table());
    } else if (old != nullptr && key == "point" && old->is_array() && node.is_array()) {
      overlay_points(*old->as_array(), *node.as_array());
    } else {
      base.insert_or_assign(key, std::move(node));
    }
  }
}

std::string file_beside(const std::string& path, const std::string& name) {
  const auto slash = path.find_last_of('/');
  return slash == std::string::npos ? name : path.substr(0, slash + 1) + name;
}

/// The file, upon the file that it includes.
bool parse_map_file(const std::string& path, toml::table& document, std::string& error) {
  if (!parse_toml_file(path, document, error)) return false;
  TomlTable root(&document, path, "", error);
  FixedText<63> include;
  root.text("include", include);
  if (!root.ok() || !root.has("include")) return root.ok();
  const std::string name(include.view());
  if (name.empty() || name.find('/') != std::string::npos) {
    root.fail("include", "must name a file beside this one");
    return false;
  }
  toml::table base;
  if (!parse_toml_file(file_beside(path, name), base, error)) return false;
  if (base.get("include") != nullptr) {
    root.fail("include", "names a file that includes another one: one level only");
    return false;
  }
  document.erase("include");
  overlay(base, document);
  document = std::move(base);
  return true;
}

bool list_variants(toml::table& document, const std::string& path, std::vector<std::string>& names,
                   std::string& error) {
  TomlTable root(&document, path, "", error);
  const toml::array* list = root.array("variant");
  if (list == nullptr) return root.ok();
  for (const toml::node& item : *list) {
    names.push_back(name_in(item));
    if (names.back().empty()) root.fail_at(item, "[[variant]] name is missing: add it");
  }
  if (names.empty()) root.fail("variant", "holds nothing: leave it out");
  if (names.size() > kVariantsMax) root.fail("variant", "holds more than 8 variants");
  return root.ok();
}

/// The map with one of its variants laid upon it; -1 = the file has none.
bool read_map(const std::string& path, int variant, RegisterMap& map, std::string& error) {
  toml::table document;
  if (!parse_map_file(path, document, error)) return false;
  map = RegisterMap{};
  if (variant >= 0) {
    toml::array variants = std::move(*document.get_as<toml::array>("variant"));
    document.erase("variant");
    toml::table& chosen = *variants.get(static_cast<std::size_t>(variant))->as_table();
    TomlTable header(&chosen, path, "[[variant]]", error);
    FixedText<255> description;
    header.text("name", map.variant);
    header.text("description", description);
    if (!header.ok()) return false;
    chosen.erase("name");
    chosen.erase("description");
    overlay(document, chosen);
  }
  TomlTable root(&document, path, "", error);
  for (const std::string_view key : {"map", "power", "watchdog", "state", "point", "command"}) {
    root.require(key);
  }
  MapDefaults defaults;
  const RegisterName variant_name = map.variant;
  read_map_header(root, map, defaults);
  map.variant = variant_name;
  read_map_points(root, defaults, map);
  read_map_limits(root, map);
  read_map_watchdog(root, map);
  read_map_state(root, map);
  read_map_identity(root, map);
  read_map_commands(root, defaults, map);
  read_map_policies(root, map);
  read_map_simulator(root, map);
  root.finish();
  check_map(root, map);
  return error.empty();
}

}  // namespace

bool load_register_map(const std::string& path, std::string_view variant, RegisterMap& map,
                       std::string& error) {
  toml::table document;
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
    root.fail("variant", quoted(variant) + " does not exist (there are: " + listed + ")");
    return false;
  }
  for (int i = 0; i < static_cast<int>(names.size()); ++i) {
    if (i == chosen) continue;  // variants that are not chosen must be valid all the same
    if (!read_map(path, i, map, error)) return false;
  }
  return read_map(path, chosen, map, error);
}

}  // namespace bess
