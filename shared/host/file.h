// Whole files in and out. Reading understands gzip; writing is beside-and-rename, so that a file
// under its final name is always complete.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace bess {

/// Contents of a plain or gzip file. Throws UserError when it is missing, unreadable or truncated.
std::string read_file(const std::filesystem::path& path);

/// Writes `contents` to `path` (gzip when the name ends in .gz): to a temporary file in the same
/// folder, synced, then renamed. Creates missing parent folders. Throws UserError; never leaves a
/// partial file. A device or pipe of that name is written to as it is; a symbolic link's target
/// is replaced; permissions of an existing file are kept. "-" is refused.
void write_file(const std::filesystem::path& path, std::string_view contents);

/// Throws UserError unless a file can be made at `path`, creating its folder: asked before hours of work.
void require_writable(const std::filesystem::path& path);

/// A device or a pipe, which is written to, never replaced.
bool is_special_file(const std::filesystem::path& path);

}  // namespace bess
