// What the market tests share: real samples, a scratch folder, the text of an error.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "tests/support/user_errors.h"

namespace bess {

/// Real prices that come with the project (tests/data/README.md).
inline std::filesystem::path real_sample(const std::string& name) {
  return std::filesystem::path(BESS_SOURCE_DIR) / "tests/data" / name;
}

/// Real prices that are kept beside the checkout; a test that needs them skips where they are
/// absent.
inline std::filesystem::path outside_sample(const std::string& name) {
  return std::filesystem::path(BESS_SOURCE_DIR) / "../shared/data" / name;
}

#define BESS_SKIP_WITHOUT(sample)                               \
  if (!std::filesystem::exists(bess::outside_sample(sample))) { \
    GTEST_SKIP() << "needs ../shared/data/" << (sample)         \
                 << " beside the checkout, which is absent";    \
  }

/// An empty folder of this test, removed at its end.
class ScratchFolder {
 public:
  ScratchFolder()
      : path_(std::filesystem::path(testing::TempDir()) /
              (std::string("bess_market_") +
               testing::UnitTest::GetInstance()->current_test_info()->name())) {
    std::filesystem::remove_all(path_);
    std::filesystem::create_directories(path_);
  }
  ~ScratchFolder() {
    std::error_code error;
    std::filesystem::remove_all(path_, error);
  }
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;
  [[nodiscard]] std::filesystem::path operator/(const std::string& name) const {
    return path_ / name;
  }

 private:
  std::filesystem::path path_;
};

/// Runs `action` and returns the text of the UserError it throws; fails the test when it throws
/// none.
template <typename Action>
std::string user_error_of(Action action) {
  const std::string error = refused_with(action);
  EXPECT_NE(error, "") << "expected a UserError";
  return error;
}

}  // namespace bess
