// The only memory that libraries get: a fixed buffer in .bss, served by segregated_fit under a lock
// that never allocates. malloc_family.cpp puts the C allocator on it, in bess-edge alone.
// A thread can forbid itself every further call: the control thread does, once the loop starts.
// Nobody shares the lock with that thread, so no priority can be inverted by it.
#pragma once

#include <cstddef>
#include <cstdint>

namespace bess {

/// Three times the measured peak of libcurl and OpenSSL: see the table in README.md here.
inline constexpr std::size_t kArenaBytes = 8 * 1024 * 1024;

struct ArenaStatistics {
  std::size_t used_bytes = 0;
  std::size_t peak_bytes = 0;
  std::int64_t calls = 0;            ///< of the whole family, since start
  std::int64_t failures = 0;         ///< answered with null because nothing fitted
  std::int64_t forbidden_calls = 0;  ///< by threads that had forbidden them to themselves
};

void* arena_allocate(std::size_t size, std::size_t alignment);
void* arena_resize(void* payload, std::size_t size);
void arena_release(void* payload);
[[nodiscard]] std::size_t arena_usable_bytes(const void* payload);

[[nodiscard]] bool arena_owns(const void* pointer);
[[nodiscard]] ArenaStatistics arena_statistics();

/// From now on any call by this thread ends the process through CHECK, which releases the battery.
void forbid_allocation_on_this_thread();
/// For the way out, when the destructors of the libraries run.
void permit_allocation_on_this_thread();

}  // namespace bess
