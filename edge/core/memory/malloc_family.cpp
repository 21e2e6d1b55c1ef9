// malloc family as strong symbols that the loader prefers over the C library's, for shared
// libraries too. They forward to the C library until the process is sealed (heap_seal.h); then any
// call ends it through CHECK. Linked into bess-edge only, as an object and never hidden: with
// hidden symbols the C library's would silently be used (heap_seal checks this at start). Not in
// sanitizer builds, which have their own.
#include <bit>
#include <cerrno>
#include <cstddef>

#include "edge/core/memory/heap_seal.h"

extern "C" {

// Other names of glibc's malloc family.
void* __libc_malloc(std::size_t size);
void __libc_free(void* payload);
void* __libc_calloc(std::size_t count, std::size_t size);
void* __libc_realloc(void* payload, std::size_t size);
void* __libc_memalign(std::size_t alignment, std::size_t size);
void* __libc_valloc(std::size_t size);
void* __libc_pvalloc(std::size_t size);

void* malloc(std::size_t size) {
  bess::require_unsealed_heap();
  return __libc_malloc(size);
}

void free(void* payload) {
  if (payload == nullptr) return;
  bess::require_unsealed_heap();
  __libc_free(payload);
}

void* calloc(std::size_t count, std::size_t size) {
  bess::require_unsealed_heap();
  return __libc_calloc(count, size);
}

void* realloc(void* payload, std::size_t size) {
  bess::require_unsealed_heap();
  return __libc_realloc(payload, size);
}

void* reallocarray(void* payload, std::size_t count, std::size_t size) {
  std::size_t bytes = 0;
  if (__builtin_mul_overflow(count, size, &bytes)) {
    errno = ENOMEM;
    return nullptr;
  }
  return realloc(payload, bytes);
}

void* memalign(std::size_t alignment, std::size_t size) {
  bess::require_unsealed_heap();
  return __libc_memalign(alignment, size);
}

void* aligned_alloc(std::size_t alignment, std::size_t size) { return memalign(alignment, size); }

int posix_memalign(void** payload, std::size_t alignment, std::size_t size) {
  if (!std::has_single_bit(alignment) || alignment % sizeof(void*) != 0) return EINVAL;
  void* const found = memalign(alignment, size);
  if (found == nullptr) return ENOMEM;
  *payload = found;
  return 0;
}

void* valloc(std::size_t size) {
  bess::require_unsealed_heap();
  return __libc_valloc(size);
}

void* pvalloc(std::size_t size) {
  bess::require_unsealed_heap();
  return __libc_pvalloc(size);
}

}  // extern "C"
