#include "edge/memory/segregated_fit.h"

#include <bit>

#include "edge/base/check.h"

namespace bess {
namespace {

constexpr std::uintptr_t align_up(std::uintptr_t value, std::size_t alignment) {
  return (value + alignment - 1) & ~(std::uintptr_t{alignment} - 1);
}

/// Position of the highest bit; std::bit_width returns different types in different libraries.
constexpr int log2_of(std::size_t value) { return static_cast<int>(std::bit_width(value)) - 1; }

}  // namespace

void SegregatedFit::adopt(void* buffer, std::size_t bytes) {
  BESS_CHECK(!has_buffer() && bytes <= kBufferBytesMax);
  const std::uintptr_t begin = align_up(reinterpret_cast<std::uintptr_t>(buffer), kAlignment);
  const std::uintptr_t end = (reinterpret_cast<std::uintptr_t>(buffer) + bytes) & ~(kAlignment - 1);
  BESS_CHECK(end > begin && end - begin >= kBlockBytesMin + sizeof(Block));
  first_ = reinterpret_cast<Block*>(begin);
  end_ = reinterpret_cast<Block*>(end - sizeof(Block));
  *first_ = {.left = nullptr, .size_flags = end - begin - 2 * sizeof(Block)};
  *end_ = {.left = first_, .size_flags = 0};  // in use for ever: nothing joins over the end
  insert_free(first_);
}

SegregatedFit::Block* SegregatedFit::right_of(Block* block) {
  return reinterpret_cast<Block*>(payload_of(block) + size_of(block));
}

std::size_t SegregatedFit::rounded_up(std::size_t size) {
  return size < kPayloadBytesMin ? kPayloadBytesMin : align_up(size, kAlignment);
}

SegregatedFit::SizeClass SegregatedFit::class_of(std::size_t size) {
  if (size < kSmallBytes) return {0, static_cast<int>(size / kAlignment)};
  const int log2 = log2_of(size);
  const int part = static_cast<int>(size >> (log2 - kSecondLevelBits)) - kSecondLevels;
  return {log2 - log2_of(kSmallBytes) + 1, part};
}

/// First block of the first list whose every member fits.
SegregatedFit::Block* SegregatedFit::find_fit(std::size_t size) {
  if (size >= kSmallBytes) {  // up to the next class border, so that no list needs to be searched
    size += (std::size_t{1} << (log2_of(size) - kSecondLevelBits)) - 1;
  }
  SizeClass wanted = class_of(size);
  if (wanted.first >= kFirstLevels) return nullptr;
  std::uint32_t second = second_map_[wanted.first] & (~std::uint32_t{0} << wanted.second);
  if (second == 0) {
    const std::uint32_t first = first_map_ & (~std::uint32_t{0} << wanted.first << 1);
    if (first == 0) return nullptr;
    wanted.first = std::countr_zero(first);
    second = second_map_[wanted.first];
  }
  return lists_[wanted.first][std::countr_zero(second)];
}

void SegregatedFit::insert_free(Block* block) {
  const SizeClass place = class_of(size_of(block));
  Block*& head = lists_[place.first][place.second];
  block->size_flags |= 1;
  links_of(block) = {.next = head, .previous = nullptr};
  if (head != nullptr) links_of(head).previous = block;
  head = block;
  first_map_ |= std::uint32_t{1} << place.first;
  second_map_[place.first] |= std::uint32_t{1} << place.second;
}

void SegregatedFit::remove_free(Block* block) {
  const SizeClass place = class_of(size_of(block));
  const FreeLinks links = links_of(block);
  if (links.next != nullptr) links_of(links.next).previous = links.previous;
  if (links.previous != nullptr) {
    links_of(links.previous).next = links.next;
  } else {
    lists_[place.first][place.second] = links.next;
    if (links.next == nullptr) second_map_[place.first] &= ~(std::uint32_t{1} << place.second);
    if (second_map_[place.first] == 0) first_map_ &= ~(std::uint32_t{1} << place.first);
  }
  block->size_flags &= ~std::size_t{1};
}

/// Cuts a block that is in no list after `size` payload bytes; returns the right part.
SegregatedFit::Block* SegregatedFit::split(Block* block, std::size_t size) {
  auto* rest = reinterpret_cast<Block*>(payload_of(block) + size);
  *rest = {.left = block, .size_flags = size_of(block) - size - sizeof(Block)};
  block->size_flags = size;
  right_of(rest)->left = rest;
  return rest;
}

/// Takes the right neighbour into `block` when it is free; neither is in a list afterwards.
SegregatedFit::Block* SegregatedFit::join_right(Block* block) {
  Block* right = right_of(block);
  if (!is_free(right)) return block;
  remove_free(right);
  block->size_flags += sizeof(Block) + size_of(right);
  right_of(block)->left = block;
  return block;
}

/// Gives back what a block in use has beyond `size`.
void SegregatedFit::trim_tail(Block* block, std::size_t size) {
  if (size_of(block) < size + kBlockBytesMin) return;
  insert_free(join_right(split(block, size)));
}

/// Gives back what lies before the first aligned payload of a block that is in no list.
SegregatedFit::Block* SegregatedFit::trim_head(Block* block, std::size_t alignment) {
  const auto payload = reinterpret_cast<std::uintptr_t>(payload_of(block));
  std::uintptr_t aligned = align_up(payload, alignment);
  if (aligned == payload) return block;
  if (aligned - payload < kBlockBytesMin) aligned = align_up(payload + kBlockBytesMin, alignment);
  Block* rest = split(block, aligned - payload - sizeof(Block));
  insert_free(block);
  return rest;
}

void* SegregatedFit::allocate(std::size_t size, std::size_t alignment) {
  if (size > kBufferBytesMax || alignment > kBufferBytesMax) return nullptr;
  size = rounded_up(size);
  const bool is_wide = alignment > kAlignment;
  Block* block = find_fit(is_wide ? size + alignment + kBlockBytesMin : size);
  if (block == nullptr) return nullptr;
  remove_free(block);
  if (is_wide) block = trim_head(block, alignment);
  trim_tail(block, size);
  note_use(size_of(block) + sizeof(Block));
  return payload_of(block);
}

bool SegregatedFit::resize_in_place(void* payload, std::size_t size) {
  if (size > kBufferBytesMax) return false;
  Block* block = block_of(payload);
  size = rounded_up(size);
  const std::size_t before = size_of(block);
  if (size > before) {
    Block* right = right_of(block);
    if (!is_free(right) || before + sizeof(Block) + size_of(right) < size) return false;
    join_right(block);
  }
  trim_tail(block, size);
  used_bytes_ -= before;
  note_use(size_of(block));
  return true;
}

void SegregatedFit::release(void* payload) {
  // A few comparisons find almost every pointer that was never given out or is free already.
  BESS_CHECK(owns(payload) && reinterpret_cast<std::uintptr_t>(payload) % kAlignment == 0);
  Block* block = block_of(payload);
  BESS_CHECK(!is_free(block) && size_of(block) <= kBufferBytesMax && owns(right_of(block)) &&
             right_of(block)->left == block);
  used_bytes_ -= size_of(block) + sizeof(Block);
  join_right(block);
  if (block->left != nullptr && is_free(block->left)) {
    Block* left = block->left;
    remove_free(left);
    left->size_flags += sizeof(Block) + size_of(block);
    right_of(left)->left = left;
    block = left;
  }
  insert_free(block);
}

std::size_t SegregatedFit::usable_bytes(const void* payload) {
  return size_of(static_cast<const Block*>(payload) - 1);
}

bool SegregatedFit::owns(const void* pointer) const {
  return pointer > static_cast<const void*>(first_) && pointer <= static_cast<const void*>(end_);
}

void SegregatedFit::note_use(std::size_t bytes) {
  used_bytes_ += bytes;
  if (used_bytes_ > peak_bytes_) peak_bytes_ = used_bytes_;
}

std::size_t SegregatedFit::largest_free_bytes() const {
  if (first_map_ == 0) return 0;
  const int first = log2_of(first_map_);
  const int second = log2_of(second_map_[first]);
  if (first == 0) return static_cast<std::size_t>(second) * kAlignment;
  // The lower border of the highest class: what every block in its list serves.
  const int log2 = first + log2_of(kSmallBytes) - 1;
  return static_cast<std::size_t>(kSecondLevels + second) << (log2 - kSecondLevelBits);
}

bool SegregatedFit::lists_are_sound(std::size_t& count) const {
  for (int first = 0; first < kFirstLevels; ++first) {
    if (((first_map_ >> first & 1) != 0) != (second_map_[first] != 0)) return false;
    for (int second = 0; second < kSecondLevels; ++second) {
      Block* previous = nullptr;
      Block* block = lists_[first][second];
      if (((second_map_[first] >> second & 1) != 0) != (block != nullptr)) return false;
      for (; block != nullptr; previous = block, block = links_of(block).next, ++count) {
        const SizeClass place = class_of(size_of(block));
        if (!owns(block + 1) || !is_free(block) || links_of(block).previous != previous)
          return false;
        if (place.first != first || place.second != second) return false;
      }
    }
  }
  return true;
}

bool SegregatedFit::is_sound() const {
  std::size_t in_lists = 0;
  if (!lists_are_sound(in_lists)) return false;
  std::size_t free_blocks = 0;
  std::size_t used = 0;
  Block* left = nullptr;
  Block* block = first_;
  for (; block < end_; left = block, block = right_of(block)) {
    if (block->left != left || size_of(block) < kPayloadBytesMin) return false;
    if (is_free(block) && left != nullptr && is_free(left)) return false;  // should be joined
    if (is_free(block)) ++free_blocks;
    if (!is_free(block)) used += size_of(block) + sizeof(Block);
  }
  return block == end_ && end_->left == left && free_blocks == in_lists && used == used_bytes_;
}

}  // namespace bess
