// Whole files in and out. Reading understands gzip; writing is beside-and-rename, so that a file
// under its final name is always complete.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>

namespace bess {

/// More than any file that is read here has: a year of an exporter's minutes is 60 MB of CSV.
inline constexpr std::size_t kFileBytesMax = std::size_t{512} << 20;

/// Contents of a plain or gzip file. Throws UserError when it is missing, unreadable, truncated,
/// followed by what is no gzip, or larger than `bytes_max` once unpacked: then no more than that
/// was held.
std::string read_file(const std::filesystem::path& path, std::size_t bytes_max = kFileBytesMax);

/// Writes `contents` to `path` (gzip when the name ends in .gz): to a temporary file in the same
/// folder, synced, then renamed. Creates missing parent folders. Throws UserError; never leaves a
/// partial file. A device or pipe of that name is written to as it is; a symbolic link's target
/// is replaced; permissions of an existing file are kept. "-" is refused.
void write_file(const std::filesystem::path& path, std::string_view contents);

/// Throws UserError unless a file can be made at `path`, creating its folder: asked before hours of
/// work.
void require_writable(const std::filesystem::path& path);

/// A device or a pipe, which is written to, never replaced.
bool is_special_file(const std::filesystem::path& path);

}  // namespace bess
