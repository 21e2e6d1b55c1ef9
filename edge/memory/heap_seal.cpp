#include "edge/memory/heap_seal.h"

#include <malloc.h>
#include <pthread.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string_view>

#include "edge/base/check.h"
#include "edge/memory/seccomp_filter.h"

namespace bess {
namespace {

#ifdef BESS_SANITIZED
constexpr bool kIsSealed = false;
#else
constexpr bool kIsSealed = true;
#endif
constexpr std::size_t kThreadStackBytes = 256 * 1024;  // measured use of any: 20 KiB

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

std::atomic<bool> is_sealed = false;
std::atomic<std::uint32_t> allocator_calls = 0;

/// Is it malloc_family.cpp that answers?
bool counts_allocator_calls() {
  const std::uint32_t before = allocator_calls;
  std::free(strdup("whose allocator is this?"));
  return allocator_calls != before;
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
  pthread_attr_t thread;
  pthread_attr_init(&thread);
  pthread_attr_setstacksize(&thread, kThreadStackBytes);
  pthread_setattr_default_np(&thread);  // stacks are locked in whole
  pthread_attr_destroy(&thread);
  mallopt(M_ARENA_MAX, 1);  // of the C library: one for all threads, or each reserves 64 MiB
  if (counts_allocator_calls()) return true;
  put_line("%s",
           "bess-edge: the malloc family is not ours: build bess-edge with malloc_family.cpp and "
           "default visibility; unset LD_PRELOAD\n");
  return false;
}

void require_unsealed_heap() {
  allocator_calls.fetch_add(1, std::memory_order_relaxed);
  if (is_sealed.load(std::memory_order_relaxed)) {
    is_sealed = false;  // for what a failed CHECK still does
    check_failed("no allocator call after start-up", "malloc_family.cpp", 0);
  }
}

HeapSeal::HeapSeal() {
  if (!kIsSealed) {
    put_line("%s", "bess-edge: note: a sanitizer build, nothing is sealed\n");
    return;
  }
  malloc_trim(0);  // what start-up has given back need not be locked
  prefault_stack();
  lock_memory();
  forbid_system_calls();
  is_sealed = true;
}

HeapSeal::~HeapSeal() {
  if (!kIsSealed) return;
  is_sealed = false;
  put_line("%s", "bess-edge: ran sealed: no allocator call after start-up\n");
}

}  // namespace bess
