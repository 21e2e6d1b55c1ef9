// malloc and its relatives on the static arena: strong symbols that the loader prefers over the C
// library's, for every shared library too. Linked into bess-edge alone, as an object, never hidden
// (hidden symbols would silently leave the C library's heap in use: heap_seal checks that at
// start), and not in sanitizer builds, which bring their own.
#include <unistd.h>

#include <bit>
#include <cerrno>
#include <cstddef>
#include <cstring>

#include "edge/memory/segregated_fit.h"
#include "edge/memory/static_arena.h"

namespace {

constexpr std::size_t kAlignment = bess::SegregatedFit::kAlignment;

void* allocate(std::size_t size, std::size_t alignment) {
  void* payload = bess::arena_allocate(size, alignment < kAlignment ? kAlignment : alignment);
  if (payload == nullptr) errno = ENOMEM;
  return payload;
}

std::size_t page_bytes() { return static_cast<std::size_t>(sysconf(_SC_PAGESIZE)); }

void* refuse(int error) {
  errno = error;
  return nullptr;
}

}  // namespace

extern "C" {

void* malloc(std::size_t size) { return allocate(size, kAlignment); }

void free(void* payload) {
  if (payload == nullptr) return;
  const int error = errno;  // free must leave it alone
  bess::arena_release(payload);
  errno = error;
}

void* calloc(std::size_t count, std::size_t size) {
  std::size_t bytes = 0;
  if (__builtin_mul_overflow(count, size, &bytes)) return refuse(ENOMEM);
  void* payload = allocate(bytes, kAlignment);
  if (payload != nullptr) std::memset(payload, 0, bytes);
  return payload;
}

void* realloc(void* payload, std::size_t size) {
  if (payload == nullptr) return allocate(size, kAlignment);
  if (size == 0) {  // as the C library does
    bess::arena_release(payload);
    return nullptr;
  }
  void* resized = bess::arena_resize(payload, size);
  if (resized == nullptr) errno = ENOMEM;
  return resized;
}

void* reallocarray(void* payload, std::size_t count, std::size_t size) {
  std::size_t bytes = 0;
  if (__builtin_mul_overflow(count, size, &bytes)) return refuse(ENOMEM);
  return realloc(payload, bytes);
}

void* memalign(std::size_t alignment, std::size_t size) {
  if (!std::has_single_bit(alignment)) return refuse(EINVAL);
  return allocate(size, alignment);
}

void* aligned_alloc(std::size_t alignment, std::size_t size) { return memalign(alignment, size); }

int posix_memalign(void** payload, std::size_t alignment, std::size_t size) {
  if (!std::has_single_bit(alignment) || alignment % sizeof(void*) != 0) return EINVAL;
  void* found = bess::arena_allocate(size, alignment < kAlignment ? kAlignment : alignment);
  if (found == nullptr) return ENOMEM;
  *payload = found;
  return 0;
}

void* valloc(std::size_t size) { return allocate(size, page_bytes()); }

void* pvalloc(std::size_t size) {
  const std::size_t page = page_bytes();
  if (size > bess::kArenaBytes) return refuse(ENOMEM);
  return allocate((size + page - 1) / page * page, page);
}

std::size_t malloc_usable_size(void* payload) {
  return payload == nullptr ? 0 : bess::arena_usable_bytes(payload);
}

}  // extern "C"
