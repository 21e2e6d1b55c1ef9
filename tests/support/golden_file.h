// Golden file comparison; BESS_UPDATE_GOLDEN in the environment rewrites the file.
#pragma once

#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <sstream>
#include <string>

namespace bess {

inline void expect_golden(const std::string& path, const std::string& text) {
  if (std::getenv("BESS_UPDATE_GOLDEN") != nullptr) std::ofstream(path) << text;
  std::ifstream file(path);
  ASSERT_TRUE(file) << path;
  std::ostringstream golden;
  golden << file.rdbuf();
  EXPECT_EQ(text, golden.str()) << "if this is meant: BESS_UPDATE_GOLDEN=1 with this test renews "
                                << path << "; read the difference before you commit it";
}

}  // namespace bess
