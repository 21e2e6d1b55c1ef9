// Files that other programs read while bess-edge writes them: a new text replaces the old one at
// once (written beside it, then renamed), so a reader never sees half of it. Nothing here
// allocates.
#pragma once

#include <sys/types.h>

#include <span>
#include <string_view>

#include "shared/fixed_text.h"

namespace bess {

// A checksum as the end of a text that other programs and people read as well: a comment of TOML
// and of Prometheus, or the last member of a JSON object. Nothing here allocates.

/// What stands before and behind the eight hexadecimal digits. The checksum is of all that stands
/// before.
struct ChecksumFrame {
  std::string_view before;
  std::string_view after;
};
inline constexpr ChecksumFrame kCommentChecksum{"# crc32=", "\n"};
inline constexpr ChecksumFrame kJsonChecksum{",\n  \"crc32\": \"", "\"\n}\n"};
/// Of a file that is one line.
inline constexpr ChecksumFrame kLineChecksum{" crc32=", "\n"};

/// What makes a checked text of this one.
FixedText<31> checksum_end(std::string_view text, const ChecksumFrame& frame);

enum class TextState {
  kUnchecked,  ///< of an older program, or its end is cut off
  kIntact,
  kBroken,
};
TextState check_text(std::string_view text, const ChecksumFrame& frame);

/// What the checksum is of; of an unchecked text the whole.
std::string_view without_checksum(std::string_view text, const ChecksumFrame& frame);

using FileMessage = FixedText<767>;

/// False with errno set. Not forced to the disk: such a file says how things are now, and after a
/// power cut it would be wrong anyway.
bool replace_file(const char* path, std::string_view text);

/// The same; where the disk has no room for a new one, the old text is taken away first: none says
/// less that is wrong than an old one. False with errno set.
bool replace_or_remove_file(const char* path, std::string_view text);

/// As `replace_file`, and on the disk before it returns: for what must outlast a power cut.
bool replace_file_durably(const char* path, std::string_view text);

/// Root, the user of this process, and whoever owns the folder around `path`, who can put anything
/// there.
bool is_of_the_house(uid_t owner, const char* path);

/// Whether a path may lead through a link to what another user pointed it at, and be of any owner.
enum class Links { kRefused, kFollowed };

/// Reads the beginning of a regular file, never what could block (a pipe). Returns the bytes read,
/// at most `text.size()`; negative with errno set: ENOENT where there is no such file, EPERM where
/// it is a stranger's.
ssize_t read_beginning(const char* path, std::span<char> text, Links links);

/// A new file of that name, for writing and reading: what lies there, a link as well, is removed
/// and not followed. Whoever may enter the folder may read it; made by root, it belongs to the
/// folder's owner. Negative with errno set.
int make_afresh(const char* path);

/// Makes a folder that everybody may enter, where there is none; made by root, it belongs to the
/// owner of the one around it. False with errno set.
bool make_folder(const char* path);

/// The folder that holds a file, "." for a bare name.
FixedText<639> folder_of(const char* path);

/// Of an errno: the disk is full, read-only or broken. That keeps no battery from being driven;
/// anything else is the operator's to mend.
bool is_disk_trouble(int error);

/// Makes a rename in this file's folder outlast a power cut.
void sync_folder_of(const char* path);

/// Puts "PATH: WHAT: why by errno" into `error`; always false. Keeps errno.
bool fail_with_errno(const char* path, std::string_view what, FileMessage& error);

}  // namespace bess
