// Where the edge's header belongs: the source tree that somebody works in, or that this program was
// built in.
#pragma once

#include <filesystem>
#include <optional>

namespace bess {

/// edge/generated/student_weights.h of the source tree around `folder`; none when there is no such
/// tree.
std::optional<std::filesystem::path> header_in_tree_around(const std::filesystem::path& folder);

/// The same around the current folder, or else around this program. Throws UserError when neither
/// lies in a source tree, naming the mend.
std::filesystem::path header_to_replace();

}  // namespace bess
