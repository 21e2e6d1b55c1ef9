// Whole files in and out. Reading understands gzip; writing is beside-and-rename, so that a file
// under its final name is always complete. Output is refused where it would overwrite an input, and
// unfinished files are removed at a signal.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace bess {

// No command writes over what it reads: asked before any of it is read.

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

// Files that are being written under a temporary name: a signal that ends the program takes them
// along.

/// Names one such file, from before it is made until it is complete or gone. Of many at once, some
/// are not remembered: the next writer of the same name finds those.
class UnfinishedFile {
 public:
  explicit UnfinishedFile(const std::string& path);
  UnfinishedFile(const UnfinishedFile&) = delete;
  UnfinishedFile& operator=(const UnfinishedFile&) = delete;
  ~UnfinishedFile();
  /// Once the file is made: when the program is ending already, removes it and never returns.
  void made() const;

 private:
  int slot_ = -1;
  std::string path_;
};

/// Removes all of them, and whoever makes another waits for the end. For a signal's handler that
/// ends the program: calls nothing that such a handler may not.
void remove_unfinished_files();

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
