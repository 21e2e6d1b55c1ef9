#include "tests/support/count_allocations.h"

#include <atomic>
#include <cstddef>

namespace {
std::atomic<long> allocations{0};
}  // namespace

// The linker's --wrap redirects calls of malloc and operator new in this program here.
extern "C" {
void* __real_malloc(std::size_t size);
void* __wrap_malloc(std::size_t size) {
  ++allocations;
  return __real_malloc(size);
}
void* __real__Znwm(std::size_t size);
void* __wrap__Znwm(std::size_t size) {
  ++allocations;
  return __real__Znwm(size);
}
}

namespace bess {
long allocation_count() { return allocations; }
}  // namespace bess
