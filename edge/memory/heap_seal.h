// Makes "no heap after start-up" true for the running process, and checks that it is:
//   prepare_memory   at start: the arena serves malloc, there is no [heap] segment
//   HeapSeal         around the loop: memory locked, the control thread may not allocate, the
//                    kernel refuses to give memory, threads or programs (seccomp)
// The filter names only what is forbidden; sockets, files, clocks and futexes stay as they are.
// BESS_SECCOMP=kill in the environment ends the process at a forbidden call, for tests; otherwise
// the call fails with ENOMEM (memory) or EPERM (threads, programs) and whoever made it copes.
// Sanitizer builds allocate in their own ways: there nothing is sealed, and a note says so.
#pragma once

#include <cstddef>

namespace bess {

/// Of the control thread's stack, touched before the loop so that no page fault comes later.
inline constexpr std::size_t kControlStackBytes = 256 * 1024;

/// Once, on the control thread, before any other thread. False with one line on stderr when the
/// process is not built as it must be.
[[nodiscard]] bool prepare_memory();

/// Exists as long as the loop runs, on the control thread. What the kernel or the limits of the
/// process do not permit is noted on stderr, one line each, and left out.
class HeapSeal {
 public:
  HeapSeal();
  HeapSeal(const HeapSeal&) = delete;
  HeapSeal& operator=(const HeapSeal&) = delete;
  /// Permits allocation again, for the destructors on the way out, and writes what the arena has
  /// seen in one line on stderr. The filter stays.
  ~HeapSeal();
};

}  // namespace bess
