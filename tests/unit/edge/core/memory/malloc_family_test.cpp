// malloc family of bess-edge: every member works until the process is sealed, and ends it
// afterwards, on any thread.
#include <gtest/gtest.h>
#include <malloc.h>
#include <stdlib.h>
#include <sys/prctl.h>

#include <cerrno>
#include <cstring>
#include <functional>
#include <thread>

#include "edge/core/base/check.h"
#include "edge/core/memory/heap_seal.h"

namespace bess {
namespace {

constexpr int kCheckFailed = 70;

// The compiler may drop a pair of malloc and free whose pointer is unused.
void* volatile kept = nullptr;

struct Member {
  const char* name;
  std::function<void*()> call;
  std::size_t alignment;
};

const Member kMembers[] = {
    {"malloc", [] { return malloc(100); }, 16},
    {"calloc", [] { return calloc(10, 10); }, 16},
    {"realloc", [] { return realloc(nullptr, 100); }, 16},
    {"reallocarray", [] { return reallocarray(nullptr, 10, 10); }, 16},
    {"aligned_alloc", [] { return aligned_alloc(256, 256); }, 256},
    {"memalign", [] { return memalign(4'096, 100); }, 4'096},
    {"valloc", [] { return valloc(100); }, 4'096},
    {"pvalloc", [] { return pvalloc(100); }, 4'096},
    {"posix_memalign",
     [] {
       void* payload = nullptr;
       return posix_memalign(&payload, 64, 100) == 0 ? payload : nullptr;
     },
     64},
    {"strdup", [] { return static_cast<void*>(strdup("text")); }, 16},
    {"operator new", [] { return operator new(100); }, 16},
};

TEST(MallocFamily, EveryMemberGivesMemoryBeforeTheSeal) {
  EXPECT_TRUE(prepare_memory());
  for (const Member& member : kMembers) {
    void* const payload = member.call();
    ASSERT_NE(payload, nullptr) << member.name;
    EXPECT_EQ(reinterpret_cast<std::uintptr_t>(payload) % member.alignment, 0U) << member.name;
    std::memset(payload, 0xA5, 5);
    free(payload);
  }
  void* grown = malloc(10);
  std::memcpy(grown, "123456789", 10);
  grown = realloc(grown, 10'000);
  EXPECT_STREQ(static_cast<char*>(grown), "123456789");
  free(grown);
}

TEST(MallocFamily, ErrorsAreAsTheStandardHasThem) {
  void* untouched = &untouched;
  EXPECT_EQ(posix_memalign(&untouched, 3, 10), EINVAL);
  EXPECT_EQ(untouched, &untouched);
  errno = 0;
  volatile std::size_t many = SIZE_MAX;
  EXPECT_EQ(reallocarray(nullptr, many, 2), nullptr);
  EXPECT_EQ(errno, ENOMEM);
}

using MallocFamilyDeathTest = ::testing::Test;

TEST(MallocFamilyDeathTest, EveryMemberEndsASealedProcess) {
  for (const Member& member : kMembers) {
    EXPECT_EXIT(
        {
          const HeapSeal seal;
          kept = member.call();
          _exit(0);
        },
        ::testing::ExitedWithCode(kCheckFailed), "")
        << member.name;
  }
  EXPECT_EXIT(
      {
        void* const payload = malloc(10);
        const HeapSeal seal;
        free(payload);
        _exit(0);
      },
      ::testing::ExitedWithCode(kCheckFailed), "");
}

TEST(MallocFamilyDeathTest, AnotherThreadEndsItToo) {
  EXPECT_EXIT(
      {
        std::atomic<bool> is_sealed = false;
        std::thread other([&] {
          while (!is_sealed) std::this_thread::yield();
          kept = malloc(10);
        });
        const HeapSeal seal;
        is_sealed = true;
        other.join();
        _exit(0);
      },
      ::testing::ExitedWithCode(kCheckFailed), "");
}

TEST(MallocFamilyDeathTest, BehindTheSealItGivesMemoryAgain) {
  EXPECT_EXIT(
      {
        { const HeapSeal seal; }
        kept = malloc(10);  // the filter stays; existing memory suffices
        _exit(kept != nullptr ? 7 : 1);
      },
      ::testing::ExitedWithCode(7), "");
}

}  // namespace
}  // namespace bess
