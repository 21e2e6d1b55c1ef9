// Heap seal, each part in a child process: what the kernel refuses afterwards, and what it still
// allows.
#include "edge/core/memory/heap_seal.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <sys/timex.h>
#include <unistd.h>

#include <cerrno>

namespace bess {
namespace {

constexpr int kAllAsExpected = 7;

struct ForbiddenSystemCall {
  const char* name;
  long number;
  int error;
};

const ForbiddenSystemCall kForbidden[] = {
    {"brk", SYS_brk, ENOMEM},
#ifdef SYS_mmap
    {"mmap", SYS_mmap, ENOMEM},
#endif
    {"mremap", SYS_mremap, ENOMEM},  {"clone", SYS_clone, EPERM},
    {"clone3", SYS_clone3, EPERM},
#ifdef SYS_fork
    {"fork", SYS_fork, EPERM},       {"vfork", SYS_vfork, EPERM},
#endif
    {"execve", SYS_execve, EPERM},   {"execveat", SYS_execveat, EPERM},
    {"bind", SYS_bind, EPERM},       {"listen", SYS_listen, EPERM},
    {"accept4", SYS_accept4, EPERM}, {"socket", SYS_socket, EPERM},  // of domain 0
};

/// Not under qemu-user.
bool has_seccomp() { return prctl(PR_GET_SECCOMP) >= 0; }

TEST(SeccompFilter, ForbiddenCallsFailWithTheirErrno) {
  if (!has_seccomp()) GTEST_SKIP() << "this kernel has no seccomp";
  for (const ForbiddenSystemCall& call : kForbidden) {
    EXPECT_EXIT(
        {
          if (install_seccomp_filter(ForbiddenCall::kFails) != 0) _exit(1);
          errno = 0;
          const long result = syscall(call.number, 0, 0, 0, 0, 0, 0);
          _exit(result == -1 && errno == call.error ? kAllAsExpected : 2);
        },
        ::testing::ExitedWithCode(kAllAsExpected), "")
        << call.name;
  }
}

TEST(SeccompFilter, ForbiddenCallsKillOnRequest) {
  if (!has_seccomp()) GTEST_SKIP() << "this kernel has no seccomp";
  for (const ForbiddenSystemCall& call : kForbidden) {
    EXPECT_EXIT(
        {
          if (install_seccomp_filter(ForbiddenCall::kKills) != 0) _exit(1);
          syscall(call.number, 0, 0, 0, 0, 0, 0);
          _exit(kAllAsExpected);
        },
        ::testing::KilledBySignal(SIGSYS), "")
        << call.name;
  }
}

int use_what_the_controller_needs() {
  const int fd = open("/proc/self/stat", O_RDONLY | O_CLOEXEC);
  char byte = 0;
  if (fd < 0 || read(fd, &byte, 1) != 1 || close(fd) != 0) return 1;
  const int pair = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  if (pair < 0 || close(pair) != 0) return 2;
  timex state{};
  if (adjtimex(&state) < 0) return 3;
  alignas(4'096) static char page[4'096];
  if (mprotect(page, sizeof page, PROT_READ) != 0) return 4;
  if (getpid() <= 0 || fdatasync(-1) != -1 || errno != EBADF) return 5;
  return kAllAsExpected;
}

TEST(SeccompFilter, EverythingElseStaysAllowed) {
  if (!has_seccomp()) GTEST_SKIP() << "this kernel has no seccomp";
  EXPECT_EXIT(
      {
        if (install_seccomp_filter(ForbiddenCall::kKills) != 0) _exit(10);
        _exit(use_what_the_controller_needs());
      },
      ::testing::ExitedWithCode(kAllAsExpected), "");
}

#ifndef BESS_SANITIZED
/// This program has the C library's malloc family: the check at the start must find it.
TEST(HeapSeal, AProcessWithoutOursIsRefused) {
  EXPECT_EXIT(_exit(prepare_memory() ? kAllAsExpected : 1), ::testing::ExitedWithCode(1), "malloc");
}
#endif

}  // namespace
}  // namespace bess
