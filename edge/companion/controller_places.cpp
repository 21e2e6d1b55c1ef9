#include "edge/companion/controller_places.h"

#include <unistd.h>

#include <filesystem>

#include "edge/log/installed_folders.h"

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
  TomlTable table(root.table("state"), root.file(), "[state]", root.error());
  table.line("folder", state);
  state = root.resolved(state);
  std::string run_folder(kInstalledEdge.run_beside(state));
  table.line("run_folder", run_folder);
  const std::string run_ring = root.resolved(run_folder) + "/decisions.ring";
  return {.config_path = root.file(),
          .program = controller_beside(),
          .ring = state + "/decisions.ring",
          .run_ring = run_folder.empty() ? "" : run_ring};
}

void read_program(TomlTable& table, ControllerPlaces& places) {
  table.line("program", places.program);
  places.program = table.resolved(places.program);
}

std::string host_name() {
  char name[65] = {};
  return gethostname(name, sizeof name - 1) == 0 && *name != '\0' ? name : "bess";
}

}  // namespace bess
