// Texts with their own checksum: every flipped bit and every truncation is found.
#include "edge/records/log/atomic_file.h"

#include <gtest/gtest.h>

#include <string>

namespace bess {
namespace {

struct Form {
  ChecksumFrame frame;
  const char* body;
};
const Form kForms[] = {{kCommentChecksum, "a = 1\nb = 2\n"},
                       {kJsonChecksum, "{\n  \"a\": 1,\n  \"b\": 2"}};

std::string checked(const Form& form) {
  return form.body + std::string(checksum_end(form.body, form.frame).view());
}

TEST(TextChecksum, EndsWithTheKnownCrc32) {
  EXPECT_EQ(checksum_end("123456789", kCommentChecksum).view(), "# crc32=cbf43926\n");
  EXPECT_EQ(checksum_end("123456789", kJsonChecksum).view(), ",\n  \"crc32\": \"cbf43926\"\n}\n");
}

TEST(TextChecksum, AWholeTextIsIntactAndGivesItsBody) {
  for (const Form& form : kForms) {
    EXPECT_EQ(check_text(checked(form), form.frame), ChecksumState::kIntact);
    EXPECT_EQ(without_checksum(checked(form), form.frame), form.body);
    EXPECT_EQ(check_text(form.body, form.frame), ChecksumState::kUnchecked);
    EXPECT_EQ(without_checksum(form.body, form.frame), form.body);
  }
}

TEST(TextChecksum, NoFlippedBitAndNoCutIsIntact) {
  for (const Form& form : kForms) {
    const std::string good = checked(form);
    for (std::size_t i = 0; i < good.size(); ++i) {
      for (int bit = 0; bit < 8; ++bit) {
        std::string bad = good;
        bad[i] = static_cast<char>(bad[i] ^ (1 << bit));
        EXPECT_NE(check_text(bad, form.frame), ChecksumState::kIntact) << i << " " << bit;
        // A change of the text itself is always found.
        if (i < std::string(form.body).size()) {
          EXPECT_EQ(check_text(bad, form.frame), ChecksumState::kBroken) << i << " " << bit;
        }
      }
      EXPECT_NE(check_text(good.substr(0, i), form.frame), ChecksumState::kIntact) << i;
      EXPECT_NE(check_text(good.substr(i + 1), form.frame), ChecksumState::kIntact) << i;
    }
    EXPECT_NE(check_text(std::string(good.size(), '\0'), form.frame), ChecksumState::kIntact);
    EXPECT_NE(check_text("", form.frame), ChecksumState::kIntact);
  }
}

}  // namespace
}  // namespace bess
