// Source tree lookup for the exported header: around the current folder or around this program.
#pragma once

#include <filesystem>
#include <optional>

namespace bess {

/// edge/generated/student_weights.h of the source tree around `folder`, if any.
std::optional<std::filesystem::path> header_in_tree_around(const std::filesystem::path& folder);

/// The same around the current folder, else around this program. Throws UserError with a remedy
/// when neither is in a source tree.
std::filesystem::path header_to_replace();

}  // namespace bess
