#include "edge/records/log/battery_name.h"

#include <unistd.h>

#include <cstdio>
#include <filesystem>
#include <fstream>

#include "shared/crc32.h"

namespace bess {
namespace {

constexpr std::size_t kNameMax = 63;

std::string host_name() {
  char name[kNameMax + 1] = {};
  return gethostname(name, sizeof name - 1) == 0 && *name != '\0' ? name : "bess";
}

/// Differs between machines from one image with the same host name.
std::string machine_id() {
  std::string id;
  std::ifstream("/etc/machine-id") >> id;
  return id.empty() ? host_name() : id;
}

}  // namespace

bool is_battery_name(std::string_view name) {
  return !name.empty() && name.size() <= kNameMax &&
         name.find_first_not_of(kNameCharacters) == name.npos;
}

std::string battery_id(const std::string& state_folder) {
  std::error_code ignored;
  const auto folder = std::filesystem::weakly_canonical(state_folder, ignored).string();
  const std::string text = machine_id() + "\n" + (folder.empty() ? state_folder : folder);
  char hex[16];
  std::snprintf(hex, sizeof hex, "%08x", crc32_of(text.data(), text.size()));
  return hex;
}

std::string default_battery_name(const std::string& state_folder) {
  const std::string id = "-" + battery_id(state_folder).substr(0, 4);
  std::string name = host_name().substr(0, kNameMax - id.size());
  for (char& c : name) c = is_battery_name({&c, 1}) ? c : '_';
  return name + id;
}

}  // namespace bess
