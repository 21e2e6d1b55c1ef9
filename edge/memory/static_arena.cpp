#include "edge/memory/static_arena.h"

#include <pthread.h>

#include <cstring>

#include "edge/base/check.h"
#include "edge/memory/segregated_fit.h"

namespace bess {
namespace {

alignas(4096) std::byte arena_bytes[kArenaBytes];

// All constant-initialised: the loader allocates before any constructor runs.
constinit SegregatedFit fit;
constinit ArenaStatistics statistics;
pthread_mutex_t arena_mutex = PTHREAD_MUTEX_INITIALIZER;
constinit thread_local bool is_forbidden_here = false;

class ArenaLock {
 public:
  ArenaLock() {
    pthread_mutex_lock(&arena_mutex);
    if (!fit.has_buffer()) fit.adopt(arena_bytes, sizeof arena_bytes);
  }
  ArenaLock(const ArenaLock&) = delete;
  ArenaLock& operator=(const ArenaLock&) = delete;
  ~ArenaLock() { pthread_mutex_unlock(&arena_mutex); }
};

void count_call() {
  ++statistics.calls;
  if (!is_forbidden_here) return;
  ++statistics.forbidden_calls;
  is_forbidden_here = false;  // releasing the battery comes first, whatever it takes
  pthread_mutex_unlock(&arena_mutex);
  check_failed("no allocation on the sealed control thread", __FILE__, __LINE__);
}

}  // namespace

void* arena_allocate(std::size_t size, std::size_t alignment) {
  const ArenaLock lock;
  count_call();
  void* payload = fit.allocate(size, alignment);
  if (payload == nullptr) ++statistics.failures;
  return payload;
}

void* arena_resize(void* payload, std::size_t size) {
  {
    const ArenaLock lock;
    count_call();
    if (fit.resize_in_place(payload, size)) return payload;
  }
  void* moved = arena_allocate(size, SegregatedFit::kAlignment);
  if (moved == nullptr) return nullptr;
  const std::size_t before = arena_usable_bytes(payload);
  std::memcpy(moved, payload, before < size ? before : size);
  arena_release(payload);
  return moved;
}

void arena_release(void* payload) {
  const ArenaLock lock;
  count_call();
  fit.release(payload);
}

std::size_t arena_usable_bytes(const void* payload) { return SegregatedFit::usable_bytes(payload); }

bool arena_owns(const void* pointer) {
  const ArenaLock lock;
  return fit.owns(pointer);
}

ArenaStatistics arena_statistics() {
  const ArenaLock lock;
  ArenaStatistics now = statistics;
  now.used_bytes = fit.used_bytes();
  now.peak_bytes = fit.peak_bytes();
  return now;
}

void forbid_allocation_on_this_thread() { is_forbidden_here = true; }

void permit_allocation_on_this_thread() { is_forbidden_here = false; }

}  // namespace bess
