// Heap seal: no allocation after start-up, for the running process.
//   prepare_memory   at start: replaces the malloc family
//   HeapSeal         around the loop: memory locked; any call of the malloc family by any thread
//                    ends the process through CHECK, which releases the battery; the kernel refuses
//                    memory, threads, programs and other sockets (seccomp)
// The filter lists only forbidden calls; files, clocks and futexes are unaffected.
// BESS_SECCOMP=kill in the environment ends the process at a forbidden call, for tests; otherwise
// the call fails with ENOMEM (memory) or EPERM (others), and the caller handles the error.
// Sanitizer builds allocate in their own ways: they are not sealed, and a note says so.
#pragma once

#include <cstddef>

namespace bess {

// Kernel part of the seal: system calls for memory, threads or programs are forbidden to every
// thread of the process from now on. Raw BPF, for x86-64, aarch64 and armhf.

enum class ForbiddenCall {
  kFails,  ///< with ENOMEM (memory) or EPERM (threads, programs)
  kKills,  ///< the process, with SIGSYS
};

/// 0, or the errno of a kernel without seccomp (qemu-user: ENOSYS or EINVAL).
int install_seccomp_filter(ForbiddenCall consequence);

/// Part of the control thread's stack touched before the loop, so that no page fault occurs later.
inline constexpr std::size_t kControlStackBytes = 256 * 1024;

/// Called once, on the control thread, before any other thread, because it sets the stack size of
/// threads. False with one line on stderr if the build is wrong.
[[nodiscard]] bool prepare_memory();

/// Called by malloc_family.cpp before each call: fails a CHECK once the process is sealed.
void require_unsealed_heap();

/// Lives as long as the loop, on the control thread. Parts that the kernel or process limits do not
/// permit are skipped, with one line each on stderr.
class HeapSeal {
 public:
  HeapSeal();
  HeapSeal(const HeapSeal&) = delete;
  HeapSeal& operator=(const HeapSeal&) = delete;
  /// Permits allocation again, for destructors at exit. The filter remains.
  ~HeapSeal();
};

}  // namespace bess
