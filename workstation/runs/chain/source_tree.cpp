#include "workstation/runs/chain/source_tree.h"

#include "shared/host/user_error.h"

namespace bess {
namespace {

namespace fs = std::filesystem;

/// Relative to the current folder if inside it.
fs::path shortened(const fs::path& path) {
  std::error_code error;
  const fs::path relative = fs::relative(path, error);
  return error || relative.empty() || *relative.begin() == ".." ? path : relative;
}

}  // namespace

std::optional<fs::path> header_in_tree_around(const fs::path& folder) {
  for (fs::path at = folder; !at.empty(); at = at.parent_path()) {
    const fs::path header = at / "edge" / "generated" / "student_weights.h";
    if (fs::exists(header) && fs::exists(at / "edge" / "CMakeLists.txt")) return header;
    if (at == at.root_path()) break;
  }
  return std::nullopt;
}

fs::path header_to_replace() {
  std::error_code error;
  if (const auto header = header_in_tree_around(fs::current_path())) return shortened(*header);
  const fs::path program = fs::read_symlink("/proc/self/exe", error);
  if (const auto header = header_in_tree_around(program.parent_path())) return shortened(*header);
  fail(
      "no source tree with edge/generated/student_weights.h around {} or {}; change to it, or name "
      "the header with --out",
      fs::current_path().string(), program.string());
}

}  // namespace bess
