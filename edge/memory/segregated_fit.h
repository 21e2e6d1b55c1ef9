// A bounded-time allocator over one buffer that its caller gives: two-level segregated fit. It
// never asks anyone for more; what does not fit is refused. Below static_arena, which puts it
// behind malloc.
//
// Blocks lie side by side in the buffer, each with a header that leads to its left neighbour:
//   | header | payload ... | header | payload ... | end mark |
// A free block keeps the links of its free list in its payload. Free lists are ordered by size
// class: first level = power of two, second level = 32 equal parts of it; two levels of bitmaps
// find the first list that surely fits in a few instructions. Freeing joins neighbours at once, so
// no operation ever loops over blocks.
// [Masmano, Ripoll, Crespo, Real: TLSF, a new dynamic memory allocator for real-time systems,
//  ECRTS 2004]
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace bess {

class SegregatedFit {
 public:
  static constexpr std::size_t kAlignment = 16;  ///< of every payload
  static constexpr std::size_t kBufferBytesMax = std::size_t{1} << 30;

  /// Constant-initialised: usable before any constructor of the program has run.
  constexpr SegregatedFit() = default;
  SegregatedFit(const SegregatedFit&) = delete;
  SegregatedFit& operator=(const SegregatedFit&) = delete;

  /// Takes a buffer over, once; it must outlive this object and all payloads.
  void adopt(void* buffer, std::size_t bytes);
  [[nodiscard]] bool has_buffer() const { return first_ != nullptr; }

  /// At least `size` bytes at a multiple of `alignment` (a power of two); null when nothing fits.
  void* allocate(std::size_t size, std::size_t alignment = kAlignment);
  /// Grows or shrinks a payload where it is; false, and nothing changes, when that is impossible.
  bool resize_in_place(void* payload, std::size_t size);
  /// Ends the process (CHECK) for what is not a payload in use.
  void release(void* payload);

  [[nodiscard]] static std::size_t usable_bytes(const void* payload);
  [[nodiscard]] bool owns(const void* pointer) const;

  /// Bytes taken from the buffer by payloads in use, headers included.
  [[nodiscard]] std::size_t used_bytes() const { return used_bytes_; }
  [[nodiscard]] std::size_t peak_bytes() const { return peak_bytes_; }
  /// Largest size that `allocate` would surely serve now.
  [[nodiscard]] std::size_t largest_free_bytes() const;
  /// Walks all blocks and lists: every link, size, flag and bitmap agrees. For tests; not bounded.
  [[nodiscard]] bool is_sound() const;

 private:
  static constexpr int kSecondLevelBits = 5;
  static constexpr int kSecondLevels = 1 << kSecondLevelBits;
  static constexpr std::size_t kSmallBytes =
      kAlignment * kSecondLevels;  ///< one list per size below
  static constexpr int kFirstLevels = 23;

  struct alignas(kAlignment) Block {
    Block* left;             ///< neighbour at the lower address; null = first
    std::size_t size_flags;  ///< payload bytes, a multiple of 16; bit 0: free
  };
  struct FreeLinks {
    Block* next;
    Block* previous;
  };
  struct SizeClass {
    int first;
    int second;
  };
  static constexpr std::size_t kPayloadBytesMin = sizeof(FreeLinks) < 16 ? 16 : sizeof(FreeLinks);
  static constexpr std::size_t kBlockBytesMin = sizeof(Block) + kPayloadBytesMin;

  static std::size_t size_of(const Block* block) { return block->size_flags & ~std::size_t{1}; }
  static bool is_free(const Block* block) { return (block->size_flags & 1) != 0; }
  static std::byte* payload_of(Block* block) { return reinterpret_cast<std::byte*>(block + 1); }
  static Block* block_of(void* payload) { return static_cast<Block*>(payload) - 1; }
  static FreeLinks& links_of(Block* block) { return *reinterpret_cast<FreeLinks*>(block + 1); }
  static Block* right_of(Block* block);
  static SizeClass class_of(std::size_t size);
  static std::size_t rounded_up(std::size_t size);

  Block* find_fit(std::size_t size);
  void insert_free(Block* block);
  void remove_free(Block* block);
  Block* split(Block* block, std::size_t size);
  void trim_tail(Block* block, std::size_t size);
  Block* trim_head(Block* block, std::size_t alignment);
  Block* join_right(Block* block);
  void note_use(std::size_t bytes);
  [[nodiscard]] bool lists_are_sound(std::size_t& count) const;

  Block* first_ = nullptr;
  Block* end_ = nullptr;
  std::size_t used_bytes_ = 0;
  std::size_t peak_bytes_ = 0;
  std::uint32_t first_map_ = 0;  ///< bit = this first level has a list that is not empty
  std::array<std::uint32_t, kFirstLevels> second_map_{};
  std::array<std::array<Block*, kSecondLevels>, kFirstLevels> lists_{};
};

}  // namespace bess
