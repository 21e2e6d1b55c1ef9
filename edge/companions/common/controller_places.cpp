#include "edge/companions/common/controller_places.h"

#include <filesystem>

#include "edge/records/log/battery_name.h"

namespace bess {
namespace {

std::string controller_beside() {
  std::error_code ignored;
  const auto self = std::filesystem::read_symlink("/proc/self/exe", ignored);
  return (self.parent_path() / "bess-edge").string();
}

}  // namespace

ControllerPlaces controller_places(TomlTable& root) {
  std::string state = "state";
  root.child("state").line("folder", state);
  state = root.resolved(state);
  TomlTable battery = root.child("battery");
  std::string name = default_battery_name(state);
  battery.line("name", name);
  if (root.ok() && !is_battery_name(name)) {
    battery.fail("name", "must be 1 to 63 letters, digits, - and _");
  }
  return {.name = name,
          .id = battery_id(state),
          .config_path = root.file(),
          .program = controller_beside(),
          .state_folder = state};
}

}  // namespace bess
