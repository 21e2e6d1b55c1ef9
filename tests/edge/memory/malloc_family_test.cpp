// This test program runs on the static arena, as bess-edge does: the whole C allocator, its errors,
// several threads at once, and the end of a thread that had forbidden it to itself.
#include <gtest/gtest.h>
#include <malloc.h>
#include <pthread.h>
#include <stdlib.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <random>
#include <vector>

#include "edge/base/check.h"
#include "edge/memory/heap_seal.h"
#include "edge/memory/static_arena.h"

namespace bess {
namespace {

// The compiler may drop a pair of malloc and free whose pointer goes nowhere.
void* volatile kept = nullptr;

bool is_aligned(const void* payload, std::size_t alignment) {
  return reinterpret_cast<std::uintptr_t>(payload) % alignment == 0;
}

TEST(MallocFamily, EveryMemberDrawsFromTheArena) {
  void* aligned = nullptr;
  ASSERT_EQ(posix_memalign(&aligned, 64, 100), 0);
  struct Member {
    const char* name;
    void* payload;
    std::size_t alignment;
  };
  const Member members[] = {{"malloc", malloc(100), 16},
                            {"calloc", calloc(10, 10), 16},
                            {"realloc", realloc(nullptr, 100), 16},
                            {"reallocarray", reallocarray(nullptr, 10, 10), 16},
                            {"aligned_alloc", aligned_alloc(256, 256), 256},
                            {"memalign", memalign(4'096, 100), 4'096},
                            {"valloc", valloc(100), 4'096},
                            {"pvalloc", pvalloc(100), 4'096},
                            {"posix_memalign", aligned, 64},
                            {"strdup", strdup("text"), 16},
                            {"operator new", operator new(100), 16}};
  for (const Member& member : members) {
    EXPECT_TRUE(arena_owns(member.payload)) << member.name;
    EXPECT_TRUE(is_aligned(member.payload, member.alignment)) << member.name;
    EXPECT_GE(malloc_usable_size(member.payload), 5U) << member.name;
    free(member.payload);
  }
  EXPECT_EQ(malloc_usable_size(nullptr), 0U);
  free(nullptr);
}

TEST(MallocFamily, CallocClearsWhatWasUsedBefore) {
  void* used = malloc(1'000);
  std::memset(used, 0xff, 1'000);
  kept = used;
  free(used);
  auto* cleared = static_cast<unsigned char*>(calloc(1'000, 1));
  for (int i = 0; i < 1'000; ++i) ASSERT_EQ(cleared[i], 0) << i;
  free(cleared);
}

TEST(MallocFamily, ReallocKeepsTheContentInPlaceOrNot) {
  auto* text = static_cast<char*>(malloc(8));
  std::strcpy(text, "kept");
  for (std::size_t size = 16; size <= (1 << 20); size *= 2) {
    void* wall = malloc(16);  // now and then in the way
    text = static_cast<char*>(realloc(text, size));
    ASSERT_NE(text, nullptr);
    ASSERT_STREQ(text, "kept");
    free(wall);
  }
  text = static_cast<char*>(realloc(text, 5));
  EXPECT_STREQ(text, "kept");
  EXPECT_EQ(realloc(text, 0), nullptr);
}

TEST(MallocFamily, WhatDoesNotFitIsRefusedWithErrno) {
  volatile std::size_t huge = kArenaBytes + 1;  // else the compiler sees it and warns
  volatile std::size_t half = SIZE_MAX / 2 + 2;
  const std::int64_t failures = arena_statistics().failures;
  const auto is_refused = [](void* payload) {
    const int error = errno;
    errno = 0;
    return payload == nullptr && error == ENOMEM;
  };
  errno = 0;
  EXPECT_TRUE(is_refused(malloc(huge)));
  EXPECT_TRUE(is_refused(calloc(half, 2)));
  EXPECT_TRUE(is_refused(reallocarray(nullptr, half, 2)));
  EXPECT_TRUE(is_refused(pvalloc(huge)));
  void* payload = malloc(10);
  EXPECT_TRUE(is_refused(realloc(payload, huge)));
  free(payload);
  EXPECT_EQ(posix_memalign(&payload, 16, huge), ENOMEM);
  EXPECT_EQ(posix_memalign(&payload, 24, 8), EINVAL);
  volatile std::size_t odd = 24;
  EXPECT_EQ(memalign(odd, 8), nullptr);
  EXPECT_EQ(errno, EINVAL);
  EXPECT_EQ(arena_statistics().failures, failures + 3);  // the three that only size forbade
}

TEST(MallocFamily, AnExhaustedArenaServesAgainOnceSomethingIsFreed) {
  std::vector<void*> blocks(100, nullptr);
  std::size_t count = 0;
  while (count < blocks.size() && (blocks[count] = malloc(1 << 20)) != nullptr) ++count;
  EXPECT_GE(count, 6U);
  EXPECT_LE(count, 8U);
  for (void* block : blocks) free(block);
  void* again = malloc(6 << 20);
  EXPECT_NE(again, nullptr);
  free(again);
}

void* churn(void* seed) {
  std::mt19937 random(reinterpret_cast<std::uintptr_t>(seed));
  unsigned char* slots[32] = {};
  std::size_t sizes[32] = {};
  for (int step = 0; step < 20'000; ++step) {
    const std::size_t i = random() % 32;
    for (std::size_t k = 0; k < sizes[i]; ++k) {
      if (slots[i][k] != static_cast<unsigned char>(i)) return slots[i];
    }
    sizes[i] = random() % 2'000;
    auto* moved = static_cast<unsigned char*>(realloc(slots[i], sizes[i] + 1));
    if (moved == nullptr) return slots[i];
    slots[i] = moved;
    std::memset(slots[i], static_cast<int>(i), sizes[i]);
  }
  for (unsigned char* slot : slots) free(slot);
  return nullptr;
}

TEST(MallocFamily, ThreadsDoNotDisturbEachOther) {
  pthread_t threads[4];
  for (std::uintptr_t i = 0; i < 4; ++i) {
    ASSERT_EQ(pthread_create(&threads[i], nullptr, churn, reinterpret_cast<void*>(i + 1)), 0);
  }
  for (pthread_t& thread : threads) {
    void* damaged = nullptr;
    pthread_join(thread, &damaged);
    EXPECT_EQ(damaged, nullptr);
  }
}

TEST(MallocFamily, AForbiddenCallEndsTheProcessAndOnlyOnItsThread) {
  const auto call = [](auto allocator_call) {
    void* before = malloc(10);
    kept = before;
    forbid_allocation_on_this_thread();
    allocator_call(before);
  };
  EXPECT_DEATH(call([](void*) { kept = malloc(1); }), "CHECK failed: no allocation on the sealed");
  EXPECT_DEATH(call([](void* p) { free(p); }), "CHECK failed: no allocation on the sealed");
  EXPECT_DEATH(call([](void* p) { kept = realloc(p, 99); }), "CHECK failed: no allocation");
  EXPECT_DEATH(call([](void*) { kept = new int(3); }), "CHECK failed: no allocation");

  pthread_t other{};
  forbid_allocation_on_this_thread();
  permit_allocation_on_this_thread();
  ASSERT_EQ(pthread_create(
                &other, nullptr,
                [](void*) -> void* {
                  forbid_allocation_on_this_thread();
                  return nullptr;
                },
                nullptr),
            0);
  pthread_join(other, nullptr);
  kept = malloc(1);  // this thread's permission is its own
  free(kept);
}

TEST(MallocFamily, ThisProgramPassesTheCheckAtStart) { EXPECT_TRUE(prepare_memory()); }

TEST(MallocFamily, TheSealForbidsAndItsEndPermits) {
  EXPECT_DEATH(
      {
        const HeapSeal seal;
        kept = malloc(1);
      },
      "CHECK failed: no allocation on the sealed");
  EXPECT_EXIT(
      {
        { const HeapSeal seal; }
        kept = malloc(1);
        _exit(arena_owns(kept) ? 7 : 1);
      },
      ::testing::ExitedWithCode(7), "arena used=.* control_thread_calls=0 heap_segment=0");
}

/// What a broken promise calls first may allocate: the release of the battery must not be stopped.
TEST(MallocFamily, TheCheckHandlerMayStillAllocate) {
  const auto call = [] {
    check_handler() = [](const char*, const char*, int) {
      kept = malloc(1);
      std::fprintf(stderr, "handler ran\n");
    };
    forbid_allocation_on_this_thread();
    kept = malloc(1);
  };
  EXPECT_DEATH(call(), "handler ran");
}

/// The handler drives the very code whose promise was broken: a second failure must end it.
TEST(MallocFamily, AFailureInTheCheckHandlerEndsTheProcess) {
  const auto call = [] {
    check_handler() = [](const char*, const char*, int) { BESS_CHECK(kept == &kept); };
    BESS_CHECK(kept == &kept);
  };
  EXPECT_EXIT(call(), ::testing::ExitedWithCode(70), "CHECK failed");
}

TEST(MallocFamily, StatisticsCountCallsAndBytes) {
  const ArenaStatistics before = arena_statistics();
  kept = malloc(100'000);
  const ArenaStatistics during = arena_statistics();
  free(kept);
  const ArenaStatistics after = arena_statistics();
  EXPECT_EQ(during.calls, before.calls + 1);
  EXPECT_EQ(after.calls, before.calls + 2);
  EXPECT_GE(during.used_bytes, before.used_bytes + 100'000);
  EXPECT_EQ(after.used_bytes, before.used_bytes);
  EXPECT_GE(after.peak_bytes, during.used_bytes);
  EXPECT_EQ(after.forbidden_calls, 0);
}

}  // namespace
}  // namespace bess
