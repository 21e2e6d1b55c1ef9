// Temporary user without access to the files that the test made for itself: root reads everything.
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

namespace bess {

class AsNobody {
 public:
  AsNobody() {
    if (is_root_) become(kNobody);
  }
  ~AsNobody() {
    if (is_root_) become(0);
  }
  AsNobody(const AsNobody&) = delete;
  AsNobody& operator=(const AsNobody&) = delete;

 private:
  static void become(uid_t user) { EXPECT_EQ(seteuid(user), 0); }

  static constexpr uid_t kNobody = 65'534;
  const bool is_root_ = geteuid() == 0;
};

}  // namespace bess
