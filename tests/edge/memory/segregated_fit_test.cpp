// The bounded-time allocator against a model of what is in use: random operations from a named
// seed, every payload's content kept, and one free block at the end.
#include "edge/memory/segregated_fit.h"

#include <gtest/gtest.h>

#include <cstring>
#include <memory>
#include <random>
#include <vector>

namespace bess {
namespace {

constexpr std::size_t kBytes = 1 << 20;

struct Pool {
  explicit Pool(std::size_t bytes = kBytes) : memory(new std::byte[bytes]) {
    fit.adopt(memory.get(), bytes);
  }
  std::unique_ptr<std::byte[]> memory;
  SegregatedFit fit;
};

bool is_aligned(const void* payload, std::size_t alignment) {
  return reinterpret_cast<std::uintptr_t>(payload) % alignment == 0;
}

TEST(SegregatedFit, EverySizeIsServedAlignedAndWhole) {
  Pool pool;
  for (std::size_t size = 0; size < 5'000; ++size) {
    void* payload = pool.fit.allocate(size);
    ASSERT_NE(payload, nullptr) << size;
    EXPECT_TRUE(is_aligned(payload, 16));
    EXPECT_GE(SegregatedFit::usable_bytes(payload), size);
    EXPECT_LT(SegregatedFit::usable_bytes(payload), size + 48);
    std::memset(payload, 0xa5, size);
    pool.fit.release(payload);
    ASSERT_TRUE(pool.fit.is_sound()) << size;
  }
  EXPECT_EQ(pool.fit.used_bytes(), 0U);
}

TEST(SegregatedFit, WideAlignmentsLeaveTheirHeadUsable) {
  Pool pool;
  for (std::size_t alignment = 16; alignment <= 65'536; alignment *= 2) {
    void* payload = pool.fit.allocate(100, alignment);
    ASSERT_NE(payload, nullptr) << alignment;
    EXPECT_TRUE(is_aligned(payload, alignment)) << alignment;
    EXPECT_LE(pool.fit.used_bytes(), 200U) << alignment;
    ASSERT_TRUE(pool.fit.is_sound());
    pool.fit.release(payload);
  }
}

TEST(SegregatedFit, RefusesWhatDoesNotFitAndRecovers) {
  Pool pool;
  EXPECT_EQ(pool.fit.allocate(kBytes), nullptr);
  EXPECT_EQ(pool.fit.allocate(SIZE_MAX), nullptr);
  EXPECT_EQ(pool.fit.allocate(SIZE_MAX - 20), nullptr);
  EXPECT_EQ(pool.fit.allocate(16, SIZE_MAX / 2 + 1), nullptr);
  std::vector<void*> payloads;
  while (void* payload = pool.fit.allocate(1'000)) payloads.push_back(payload);
  EXPECT_GT(payloads.size(), kBytes / 1'040);
  EXPECT_LT(pool.fit.largest_free_bytes(), 1'024U);
  EXPECT_TRUE(pool.fit.is_sound());
  const std::size_t largest_before = pool.fit.largest_free_bytes();
  for (std::size_t i = 0; i < payloads.size(); i += 2) pool.fit.release(payloads[i]);
  EXPECT_GT(pool.fit.largest_free_bytes(), largest_before);
  EXPECT_EQ(pool.fit.allocate(3'000), nullptr);  // half is free, but nowhere in one piece
  for (std::size_t i = 1; i < payloads.size(); i += 2) pool.fit.release(payloads[i]);
  EXPECT_NE(pool.fit.allocate(kBytes - kBytes / 16), nullptr);  // one block again
  EXPECT_TRUE(pool.fit.is_sound());
}

TEST(SegregatedFit, ALargestFreeSizeIsServed) {
  Pool pool;
  std::mt19937 random(4);
  for (int i = 0; i < 200; ++i) {
    const std::size_t largest = pool.fit.largest_free_bytes();
    if (largest == 0) break;
    void* all = pool.fit.allocate(largest);
    ASSERT_NE(all, nullptr) << largest;
    pool.fit.release(all);
    static_cast<void>(pool.fit.allocate(random() % 20'000));
  }
}

TEST(SegregatedFit, ResizesWhereThereIsRoom) {
  Pool pool;
  auto* payload = static_cast<char*>(pool.fit.allocate(100));
  std::strcpy(payload, "kept");
  EXPECT_TRUE(pool.fit.resize_in_place(payload, 10'000));
  EXPECT_GE(SegregatedFit::usable_bytes(payload), 10'000U);
  EXPECT_STREQ(payload, "kept");
  void* neighbour = pool.fit.allocate(10);
  EXPECT_FALSE(pool.fit.resize_in_place(payload, 20'000));
  EXPECT_GE(SegregatedFit::usable_bytes(payload), 10'000U);
  EXPECT_TRUE(pool.fit.resize_in_place(payload, 50));
  EXPECT_LT(pool.fit.used_bytes(), 200U);
  EXPECT_FALSE(pool.fit.resize_in_place(payload, SIZE_MAX));
  pool.fit.release(neighbour);
  pool.fit.release(payload);
  EXPECT_TRUE(pool.fit.is_sound());
  EXPECT_EQ(pool.fit.used_bytes(), 0U);
  EXPECT_GT(pool.fit.peak_bytes(), 10'000U);
}

struct Held {
  unsigned char* payload;
  std::size_t size;
  unsigned char mark;
};

bool is_kept(const Held& held) {
  for (std::size_t i = 0; i < held.size; ++i) {
    if (held.payload[i] != held.mark) return false;
  }
  return true;
}

/// Mostly small, some large: what a TLS library asks for.
std::size_t draw_size(std::mt19937& random) {
  const unsigned bits = 1 + static_cast<unsigned>(random() % 15);
  return random() % (std::size_t{1} << bits);
}

TEST(SegregatedFit, RandomOperationsKeepEveryPayload) {
  constexpr std::uint32_t kSeed = 20'040'630;
  std::mt19937 random(kSeed);
  Pool pool;
  std::vector<Held> held;
  int refused = 0;
  const auto drop = [&](std::size_t i) {
    ASSERT_TRUE(is_kept(held[i]));
    pool.fit.release(held[i].payload);
    held[i] = held.back();
    held.pop_back();
  };
  for (int step = 0; step < 200'000; ++step) {
    const std::size_t size = draw_size(random);
    const auto mark = static_cast<unsigned char>(random());
    const std::size_t kind = random() % 10;
    if (kind < 5 || held.empty()) {
      const std::size_t alignment = std::size_t{16} << (random() % 8 == 0 ? random() % 9 : 0);
      auto* payload = static_cast<unsigned char*>(pool.fit.allocate(size, alignment));
      if (payload == nullptr) {
        ++refused;
        drop(random() % held.size());
        continue;
      }
      ASSERT_TRUE(is_aligned(payload, alignment));
      std::memset(payload, mark, size);
      held.push_back({payload, size, mark});
    } else if (kind < 7) {
      Held& chosen = held[random() % held.size()];
      ASSERT_TRUE(is_kept(chosen));
      if (pool.fit.resize_in_place(chosen.payload, size)) {
        chosen.size = size;
        std::memset(chosen.payload, chosen.mark, size);
      }
    } else {
      drop(random() % held.size());
    }
    if (step % 1'000 == 0) {
      ASSERT_TRUE(pool.fit.is_sound()) << "seed " << kSeed << " step " << step;
    }
  }
  EXPECT_GT(refused, 10);  // it was full at times
  while (!held.empty()) drop(held.size() - 1);
  EXPECT_TRUE(pool.fit.is_sound());
  EXPECT_EQ(pool.fit.used_bytes(), 0U);
  EXPECT_NE(pool.fit.allocate(pool.fit.largest_free_bytes()), nullptr);
  EXPECT_GT(pool.fit.used_bytes(), kBytes - kBytes / 16);  // one block was left
}

TEST(SegregatedFit, WrongPointersEndTheProcess) {
  Pool pool;
  auto* payload = static_cast<std::byte*>(pool.fit.allocate(100));
  std::byte outside[64]{};
  EXPECT_DEATH(pool.fit.release(outside), "CHECK failed");
  EXPECT_DEATH(pool.fit.release(payload + 8), "CHECK failed");
  pool.fit.release(payload);
  EXPECT_DEATH(pool.fit.release(payload), "CHECK failed");
}

TEST(SegregatedFit, TheSmallestBufferHoldsOnePayload) {
  alignas(16) std::byte buffer[64];
  SegregatedFit fit;
  fit.adopt(buffer + 1, 63);  // rounded inwards to 48: header, 16 bytes, end mark
  void* payload = fit.allocate(16);
  EXPECT_EQ(payload, buffer + 32);
  EXPECT_EQ(fit.allocate(1), nullptr);
  fit.release(payload);
  EXPECT_TRUE(fit.is_sound());
}

}  // namespace
}  // namespace bess
