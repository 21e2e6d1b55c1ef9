// The bounded-time allocator, driven by bytes: four of them are one operation on one of 64 slots.
#include "edge/memory/segregated_fit.h"

#include <cstring>
#include <memory>

#include "tests/fuzz/fuzz_target.h"

namespace {

constexpr std::size_t kBytes = 64 * 1024;
constexpr int kSlots = 64;

struct Slot {
  void* payload = nullptr;
  std::size_t size = 0;
};

void fill(const Slot& slot, int mark) { std::memset(slot.payload, mark, slot.size); }

void check_filled(const Slot& slot, int mark) {
  const auto* bytes = static_cast<const unsigned char*>(slot.payload);
  for (std::size_t i = 0; i < slot.size; ++i) bess::must(bytes[i] == mark, "payload kept");
}

/// code: two bits of operation, six of alignment or nothing.
void operate(bess::SegregatedFit& fit, Slot& slot, int mark, int code, std::size_t size) {
  if (slot.payload == nullptr) {
    const std::size_t alignment = std::size_t{16} << (code / 4 % 9);
    slot = {fit.allocate(size, alignment), size};
    if (slot.payload == nullptr) return;
    bess::must(reinterpret_cast<std::uintptr_t>(slot.payload) % alignment == 0, "aligned");
    bess::must(bess::SegregatedFit::usable_bytes(slot.payload) >= size, "large enough");
    return fill(slot, mark);
  }
  check_filled(slot, mark);
  if (code % 4 != 0) {
    if (!fit.resize_in_place(slot.payload, size)) return;
    slot.size = size;
    return fill(slot, mark);
  }
  fit.release(slot.payload);
  slot = {};
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace bess;
  const std::unique_ptr<std::byte[]> memory(new std::byte[kBytes]);
  SegregatedFit fit;
  fit.adopt(memory.get(), kBytes);
  Slot slots[kSlots];
  for (std::size_t i = 0; i + 4 <= size; i += 4) {
    const int slot = data[i] % kSlots;
    operate(fit, slots[slot], slot + 1, data[i + 1], data[i + 2] + 256U * data[i + 3]);
  }
  must(fit.is_sound(), "sound after any operations");
  for (Slot& slot : slots) {
    if (slot.payload != nullptr) fit.release(slot.payload);
  }
  must(fit.is_sound() && fit.used_bytes() == 0, "nothing left");
  must(fit.allocate(kBytes - kBytes / 16) != nullptr, "one block again");
  return 0;
}
