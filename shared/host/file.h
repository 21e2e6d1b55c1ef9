// Files: reading, also of gzip, and writing by temporary file and rename, so that a file is always
// complete. Refuses output over an input, and removes unfinished files at a signal.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace bess {

// Check, before reading, that no command overwrites its input.

/// File named on the command line: option, for messages, and path; empty path: none.
struct NamedPath {
  std::string option;
  std::filesystem::path path;
};

/// Throws UserError if one of `outputs` equals an input or another output, also by a link or
/// another spelling. Devices and pipes may be used several times.
void require_distinct(const std::vector<NamedPath>& outputs, const std::vector<NamedPath>& inputs);

/// One option given several times, and `others`.
std::vector<NamedPath> named_paths(const std::string& option, const std::vector<std::string>& paths,
                                   const std::vector<NamedPath>& others = {});

/// Files in the folder that an option names.
std::vector<NamedPath> named_files(const std::string& option, const std::filesystem::path& folder,
                                   const std::vector<std::string>& names);

// Unfinished temporary files, removed by a signal that ends the program.

/// Registers one file from before its creation until it is complete or removed. The number is
/// limited; the next writer of the same name removes others.
class UnfinishedFile {
 public:
  explicit UnfinishedFile(const std::string& path);
  UnfinishedFile(const UnfinishedFile&) = delete;
  UnfinishedFile& operator=(const UnfinishedFile&) = delete;
  ~UnfinishedFile();
  /// Call after creation: if the program is already ending, removes the file and never returns.
  void made() const;

 private:
  int slot_ = -1;
  std::string path_;
};

/// Removes all of them; creators of further files wait for the end. Async-signal-safe, for a
/// handler that ends the program.
void remove_unfinished_files();

/// Larger than any input file: a year of exported minutes is 60 MB of CSV.
inline constexpr std::size_t kFileBytesMax = std::size_t{512} << 20;

/// Content of a plain or gzip file. Throws UserError if it is missing, unreadable, truncated,
/// followed by other data, or larger than `bytes_max` when unpacked; never holds more than that.
std::string read_file(const std::filesystem::path& path, std::size_t bytes_max = kFileBytesMax);

/// `text` without its byte order mark. Throws UserError for a ZIP archive, UTF-16 or a web page,
/// which are not supported; `name` is used in the message.
std::string_view plain_text(std::string_view text, std::string_view name);

/// Writes `contents` to `path` (gzip if the name ends in .gz): to a temporary file in the same
/// folder, synced, then renamed. Creates missing parent folders. Throws UserError; never leaves a
/// partial file. Writes directly to devices and pipes; replaces the target of a symbolic link;
/// keeps the permissions of an existing file; refuses "-".
void write_file(const std::filesystem::path& path, std::string_view contents);

/// Throws UserError unless a file can be created at `path`; creates its folder. For checks before
/// long work.
void require_writable(const std::filesystem::path& path);

/// Device or pipe, which is written directly and never replaced.
bool is_special_file(const std::filesystem::path& path);

}  // namespace bess
