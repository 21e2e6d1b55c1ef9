// Whose word counts: a lock or a status that anybody could have put there would keep the controller
// from starting, or tell of one that has long ended.
#pragma once

#include <sys/stat.h>

#include "edge/log/whole_file.h"

namespace bess {

/// Root, and the user of this process.
bool is_trusted(uid_t owner);

/// "PATH belongs to user N, ...", with the mend.
FileMessage strangers_file(const char* path);

/// For a file that this process is going to rely on or to replace: false with one line when it is
/// there and belongs to a stranger. A link is looked at itself.
bool refuse_stranger(const char* path, FileMessage& error);

/// For a file of root's that this process may not open: false with one line that names the command
/// which removes it.
bool refuse_roots_leftover(const char* path, FileMessage& error);

/// For a file that is only read: also of whoever owns its folder, who can put anything there. A
/// file that is not there is nobody's.
bool is_believable(const char* path);

}  // namespace bess
