#include "edge/memory/heap_seal.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string_view>

#include "edge/memory/seccomp_filter.h"
#include "edge/memory/static_arena.h"

namespace bess {
namespace {

#ifdef BESS_SANITIZED
constexpr bool kIsSealed = false;
#else
constexpr bool kIsSealed = true;
#endif

/// One line on stderr by write(2): stdio would allocate its buffer.
template <typename... Values>
void put_line(const char* format, Values... values) {
  char line[256];
  const int length = std::snprintf(line, sizeof line, format, values...);
  const auto size = static_cast<std::size_t>(length) < sizeof line
                        ? static_cast<std::size_t>(length)
                        : sizeof line - 1;
  const ssize_t ignored = write(STDERR_FILENO, line, size);
  static_cast<void>(ignored);
}

/// Touches the stack that the control thread will need, so that it is there before it is needed.
void prefault_stack() {
  volatile char stack[kControlStackBytes];
  for (std::size_t i = 0; i < sizeof stack; i += 512) stack[i] = 0;
}

/// True when /proc/self/maps names a heap segment: somebody has called brk.
bool has_heap_segment() {
  const int fd = open("/proc/self/maps", O_RDONLY | O_CLOEXEC);
  if (fd < 0) return false;
  constexpr std::string_view kHeap = "[heap]";
  char text[4'096 + kHeap.size()];
  std::size_t kept = 0;  // the end of the block before: the name may lie across
  bool found = false;
  for (ssize_t got = 0; !found && (got = read(fd, text + kept, sizeof text - kept)) > 0;) {
    const std::string_view block(text, kept + static_cast<std::size_t>(got));
    found = block.find(kHeap) != std::string_view::npos;
    kept = block.size() < kHeap.size() ? block.size() : kHeap.size();
    std::memmove(text, block.data() + block.size() - kept, kept);
  }
  close(fd);
  return found;
}

bool arena_serves_malloc() {
  char* text = strdup("whose memory is this?");
  const bool served = arena_owns(text);
  std::free(text);
  return served;
}

void lock_memory() {
  if (mlockall(MCL_CURRENT | MCL_FUTURE) == 0) return;
  const int error = errno;
  rlimit limit{};
  getrlimit(RLIMIT_MEMLOCK, &limit);
  munlockall();  // all or nothing: half a lock would make a later page fault fatal
  put_line(
      "bess-edge: note: memory is not locked (%s, limit %llu KiB): set LimitMEMLOCK=infinity in "
      "the unit, or ulimit -l\n",
      std::strerror(error), static_cast<unsigned long long>(limit.rlim_cur / 1'024));
}

void forbid_system_calls() {
  const char* wish = std::getenv("BESS_SECCOMP");
  const bool kills = wish != nullptr && std::string_view(wish) == "kill";
  const int error = install_seccomp_filter(kills ? ForbiddenCall::kKills : ForbiddenCall::kFails);
  if (error == 0) return;
  put_line("bess-edge: note: this kernel has no seccomp (%s): going on without its filter\n",
           std::strerror(error));
}

}  // namespace

bool prepare_memory() {
  if (!kIsSealed) return true;
  if (!arena_serves_malloc()) {
    put_line("%s",
             "bess-edge: malloc does not draw from the static arena: build bess-edge with "
             "malloc_family.cpp and default visibility\n");
    return false;
  }
  if (has_heap_segment()) {
    put_line("%s",
             "bess-edge: the process has a heap segment: something called brk at start-up; unset "
             "LD_PRELOAD\n");
    return false;
  }
  return true;
}

HeapSeal::HeapSeal() {
  if (!kIsSealed) {
    put_line("%s", "bess-edge: note: a sanitizer build, nothing is sealed\n");
    return;
  }
  prefault_stack();
  lock_memory();
  forbid_system_calls();
  forbid_allocation_on_this_thread();
}

HeapSeal::~HeapSeal() {
  if (!kIsSealed) return;
  permit_allocation_on_this_thread();
  const ArenaStatistics arena = arena_statistics();
  put_line(
      "bess-edge: arena used=%zu peak=%zu of=%zu calls=%lld failures=%lld "
      "control_thread_calls=%lld "
      "heap_segment=%d\n",
      arena.used_bytes, arena.peak_bytes, kArenaBytes, static_cast<long long>(arena.calls),
      static_cast<long long>(arena.failures), static_cast<long long>(arena.forbidden_calls),
      has_heap_segment());
}

}  // namespace bess
