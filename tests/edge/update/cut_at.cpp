// Preloaded before a program: the power goes, or the disk is full, at its n-th call that changes a
// disk.
//   BESS_CUT_AT=N   which call;  BESS_CUT_KIND=kill (at it) or full (from it on: ENOSPC)
// Only in the program named bess-edge; what that one starts is left alone.
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

namespace {

/// True when this call must fail; does not return at the moment of a cut.
bool is_cut() {
  static int calls = 0;
  const char* const at = getenv("BESS_CUT_AT");
  const char* const kind = getenv("BESS_CUT_KIND");
  if (at == nullptr || kind == nullptr || strcmp(program_invocation_short_name, "bess-edge") != 0) {
    return false;
  }
  ++calls;
  if (strcmp(kind, "kill") == 0 && calls == atoi(at)) kill(getpid(), SIGKILL);
  if (strcmp(kind, "full") != 0 || calls < atoi(at)) return false;
  errno = ENOSPC;
  return true;
}

template <typename Call>
Call next(const char* name) {
  return reinterpret_cast<Call>(dlsym(RTLD_NEXT, name));
}

}  // namespace

extern "C" {
int rename(const char* from, const char* to) noexcept {
  return is_cut() ? -1 : next<int (*)(const char*, const char*)>("rename")(from, to);
}
int symlink(const char* target, const char* path) noexcept {
  return is_cut() ? -1 : next<int (*)(const char*, const char*)>("symlink")(target, path);
}
int fsync(int fd) { return is_cut() ? -1 : next<int (*)(int)>("fsync")(fd); }
}
