// "No heap after start-up", for the running process:
//   prepare_memory   at start: the malloc family is ours
//   HeapSeal         around the loop: memory locked, any call of the malloc family by any thread
//                    ends the process through CHECK, which releases the battery; the kernel refuses
//                    to give memory, threads, programs and other sockets (seccomp)
// The filter names only what is forbidden; files, clocks and futexes stay as they are.
// BESS_SECCOMP=kill in the environment ends the process at a forbidden call, for tests; otherwise
// the call fails with ENOMEM (memory) or EPERM (all else), and the caller handles the error.
// Sanitizer builds allocate in their own ways: there nothing is sealed, and a note says so.
#pragma once

#include <cstddef>

namespace bess {

// The kernel's part of the seal: system calls that give memory, threads or programs are forbidden
// to every thread of the process from now on. Raw BPF, for x86-64, aarch64 and armhf.

enum class ForbiddenCall {
  kFails,  ///< with ENOMEM (memory) or EPERM (threads, programs)
  kKills,  ///< the process, with SIGSYS
};

/// 0, or the errno of a kernel without seccomp (qemu-user: ENOSYS or EINVAL).
int install_seccomp_filter(ForbiddenCall consequence);

/// Of the control thread's stack, touched before the loop so that no page fault comes later.
inline constexpr std::size_t kControlStackBytes = 256 * 1024;

/// Once, on the control thread, before any other thread, whose stacks get a size of their own.
/// False with one line on stderr when the process is not built as it must be.
[[nodiscard]] bool prepare_memory();

/// Of malloc_family.cpp, before each call: fails a CHECK once the process is sealed.
void require_unsealed_heap();

/// Exists as long as the loop runs, on the control thread. What the kernel or the limits of the
/// process do not permit is noted on stderr, one line each, and left out.
class HeapSeal {
 public:
  HeapSeal();
  HeapSeal(const HeapSeal&) = delete;
  HeapSeal& operator=(const HeapSeal&) = delete;
  /// Permits allocation again, for the destructors on the way out. The filter stays.
  ~HeapSeal();
};

}  // namespace bess
