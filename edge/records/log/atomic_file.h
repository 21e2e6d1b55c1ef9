// Atomic replacement of files that other programs read: the new text is written to a second file
// and renamed, so a reader never sees a part of it. Nothing here allocates.
#pragma once

#include <sys/types.h>

#include <span>
#include <string_view>

#include "shared/fixed_text.h"

namespace bess {

// Checksum at the end of a text: a comment of TOML and Prometheus, or the last JSON member.

/// Text before and after the eight hexadecimal digits. The checksum covers all preceding text.
struct ChecksumFrame {
  std::string_view before;
  std::string_view after;
};
inline constexpr ChecksumFrame kCommentChecksum{"# crc32=", "\n"};
inline constexpr ChecksumFrame kJsonChecksum{",\n  \"crc32\": \"", "\"\n}\n"};
/// For a file of one line.
inline constexpr ChecksumFrame kLineChecksum{" crc32=", "\n"};

/// Checksum with its frame, to append to `text`.
FixedText<31> checksum_end(std::string_view text, const ChecksumFrame& frame);

enum class ChecksumState {
  kUnchecked,  ///< no checksum: older version, or truncated
  kIntact,
  kBroken,
};
ChecksumState check_text(std::string_view text, const ChecksumFrame& frame);

/// Text without its checksum; an unchecked text in full.
std::string_view without_checksum(std::string_view text, const ChecksumFrame& frame);

using FileMessage = FixedText<767>;

/// False with errno set. Not synced: the file shows the current state, which a power cut
/// invalidates anyway.
bool replace_file(const char* path, std::string_view text);

/// The same; on a full disk the old text is removed first, because no file is better than an old
/// one. False with errno set.
bool replace_or_remove_file(const char* path, std::string_view text);

/// As `replace_file`, synced to disk: for data that must survive a power cut.
bool replace_file_durably(const char* path, std::string_view text);

/// Appends all of `text` or nothing: half a line would spoil the next one. False with errno set.
bool append_whole(int fd, std::string_view text);

/// Trusted owner check: root, the user of this process, or the owner of the folder of `path`.
bool has_trusted_owner(uid_t owner, const char* path);

/// Whether a path may be a link, and have any owner.
enum class SymlinkPolicy { kRefused, kFollowed };

/// Reads the beginning of a regular file, never a pipe, which could block. Returns the bytes read,
/// at most `text.size()`; negative with errno set: ENOENT without a file, EPERM for a file of an
/// untrusted user.
ssize_t read_beginning(const char* path, std::span<char> text, SymlinkPolicy symlinks);

/// Creates a file for writing and reading. An existing file or link is removed, not followed.
/// Permissions follow the folder; made by root, it belongs to the folder's owner. Negative with
/// errno set.
int make_afresh(const char* path);

/// Creates a missing folder, open to all users; made by root, it belongs to its parent's owner.
/// False with errno set.
bool make_folder(const char* path);

/// Folder of a file, "." for a bare name.
FixedText<639> folder_of(const char* path);

/// True for an errno of a full, read-only or broken disk. Control continues then; other errors need
/// the operator.
bool is_disk_trouble(int error);

/// Syncs the folder of a file, so that a rename survives a power cut.
void sync_folder_of(const char* path);

/// Puts "PATH: WHAT: errno text" into `error`; always false. Keeps errno.
bool fail_with_errno(const char* path, std::string_view what, FileMessage& error);

}  // namespace bess
