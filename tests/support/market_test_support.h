// Shared support of the market tests: real samples, a scratch folder, the text of an error.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "tests/support/temporary_folder.h"
#include "tests/support/user_error_of.h"

namespace bess {

/// Real prices that come with the project (tests/data/README.md).
inline std::filesystem::path real_sample(const std::string& name) {
  return std::filesystem::path(BESS_SOURCE_DIR) / "tests/data" / name;
}

/// Real prices outside the checkout; a test that needs them is skipped if they are absent.
inline std::filesystem::path outside_sample(const std::string& name) {
  return std::filesystem::path(BESS_SOURCE_DIR) / "../shared/data" / name;
}

#define BESS_SKIP_WITHOUT(sample)                               \
  if (!std::filesystem::exists(bess::outside_sample(sample))) { \
    GTEST_SKIP() << "needs ../shared/data/" << (sample)         \
                 << " next to the checkout, which is absent";   \
  }

/// An empty folder of this test, removed at its end.
struct ScratchFolder : TemporaryFolder {
  [[nodiscard]] std::filesystem::path operator/(const std::string& name) const {
    return file(name);
  }
};

}  // namespace bess
