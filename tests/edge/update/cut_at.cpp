// Preloaded before a program: the power goes, or the disk is full, at its n-th call that changes a
// disk.
//   BESS_CUT_AT=N   which call;  BESS_CUT_KIND=kill (at it) or full (from it on: ENOSPC)
//   BESS_CUT_PROGRAM=NAME  in that program alone (bess-edge); what that one starts is left alone
//   BESS_CUT_COUNT=FILE    how many such calls it made, where it comes to its end
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

namespace {

int calls = 0;

bool is_meant() {
  const char* const name = getenv("BESS_CUT_PROGRAM");
  return strcmp(program_invocation_short_name, name == nullptr ? "bess-edge" : name) == 0;
}

/// True when this call must fail; does not return at the moment of a cut.
bool is_cut() {
  const char* const at = getenv("BESS_CUT_AT");
  const char* const kind = getenv("BESS_CUT_KIND");
  if (at == nullptr || kind == nullptr || !is_meant()) return false;
  ++calls;
  if (strcmp(kind, "kill") == 0 && calls == atoi(at)) kill(getpid(), SIGKILL);
  if (strcmp(kind, "full") != 0 || calls < atoi(at)) return false;
  errno = ENOSPC;
  return true;
}

__attribute__((destructor)) void tell_count() {
  const char* const place = getenv("BESS_CUT_COUNT");
  if (place == nullptr || calls == 0 || !is_meant()) return;
  FILE* const file = fopen(place, "w");
  if (file == nullptr) return;
  fprintf(file, "%d\n", calls);
  fclose(file);
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
