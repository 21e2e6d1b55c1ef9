#include "edge/storage/file_owner.h"

#include <unistd.h>

#include <cstdio>

namespace bess {
bool is_trusted(uid_t owner) { return owner == 0 || owner == geteuid(); }

FileMessage strangers_file(const char* path) {
  struct stat info {};
  const bool is_known = lstat(path, &info) == 0;
  char line[768];
  std::snprintf(
      line, sizeof line,
      "%.500s belongs to user %ld, neither to root nor to the user that runs this bess-edge "
      "(%ld): if nothing of that user should be there, remove it",
      path, is_known ? static_cast<long>(info.st_uid) : -1L, static_cast<long>(geteuid()));
  return {line};
}

bool refuse_stranger(const char* path, FileMessage& error) {
  struct stat info {};
  if (lstat(path, &info) != 0 || is_trusted(info.st_uid)) return true;
  error = strangers_file(path);
  return false;
}

bool refuse_roots_leftover(const char* path, FileMessage& error) {
  struct stat info {};
  if (geteuid() == 0 || lstat(path, &info) != 0 || info.st_uid != 0) return true;
  char line[1'400];  // what is too long for a message is cut
  std::snprintf(
      line, sizeof line,
      "%s is root's, of a bess-edge that was started as root: if none runs any more (pgrep "
      "-u root -x bess-edge), it was killed; remove its lock: sudo rm %s",
      path, path);
  error = FileMessage(line);
  return false;
}

bool is_believable(const char* path) {
  struct stat file {};
  return lstat(path, &file) != 0 || is_of_the_house(file.st_uid, path);
}

}  // namespace bess
