// An instant by its text.
#pragma once

#include <gtest/gtest.h>

#include <string_view>

#include "shared/utc_text.h"

namespace bess {

inline std::int64_t utc_of(std::string_view text) {
  std::int64_t utc_s = 0;
  EXPECT_TRUE(parse_utc(text, utc_s)) << text;
  return utc_s;
}

}  // namespace bess
