// No command writes over what it reads: asked before any of it is read.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace bess {

/// A file as the command line names it: the option, for messages, and its path; an empty path names
/// none.
struct GivenPath {
  std::string option;
  std::filesystem::path path;
};

/// Throws UserError when one of `outputs` is one of `inputs` or another output, also by a link or
/// under another spelling. Devices and pipes may serve for several.
void require_distinct(const std::vector<GivenPath>& outputs, const std::vector<GivenPath>& inputs);

/// The same option given several times.
std::vector<GivenPath> given_paths(const std::string& option,
                                   const std::vector<std::string>& paths);

}  // namespace bess
