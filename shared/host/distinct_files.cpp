#include "shared/host/distinct_files.h"

#include "shared/host/file.h"
#include "shared/host/user_error.h"

namespace bess {
namespace {

namespace fs = std::filesystem;

/// Where a name leads to, whether there is a file or not.
fs::path place_of(const fs::path& path) {
  std::error_code error;
  const fs::path place = fs::weakly_canonical(fs::absolute(path), error);
  return error ? fs::absolute(path).lexically_normal() : place;
}

bool is_same_file(const fs::path& a, const fs::path& b) {
  if (a.empty() || b.empty() || is_special_file(a) || is_special_file(b)) return false;
  std::error_code error;
  return fs::equivalent(a, b, error) || place_of(a) == place_of(b);
}

}  // namespace

void require_distinct(const std::vector<GivenPath>& outputs, const std::vector<GivenPath>& inputs) {
  for (auto output = outputs.begin(); output != outputs.end(); ++output) {
    for (const GivenPath& input : inputs) {
      if (!is_same_file(output->path, input.path)) continue;
      fail("{} {}: would replace the input {} {}; write to another name", output->option,
           output->path.string(), input.option, input.path.string());
    }
    for (auto other = outputs.begin(); other != output; ++other) {
      if (!is_same_file(output->path, other->path)) continue;
      fail("{} {}: would replace what {} writes; give each a name of its own", output->option,
           output->path.string(), other->option);
    }
  }
}

std::vector<GivenPath> given_paths(const std::string& option,
                                   const std::vector<std::string>& paths) {
  std::vector<GivenPath> given;
  for (const std::string& path : paths) given.push_back({option, path});
  return given;
}

}  // namespace bess
