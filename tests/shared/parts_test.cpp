// The small shared parts: the one argmax, the checksum, the fixed-capacity vector and text.
#include <gtest/gtest.h>

#include "edge/base/static_vector.h"
#include "shared/action.h"
#include "shared/crc32.h"
#include "shared/fixed_text.h"

namespace bess {
namespace {

TEST(Argmax, TiesGoToTheLowestAction) {
  const struct {
    int value[kActionCount];
    Action best;
  } cases[] = {
      {{0, 0, 0}, Action::kDischarge},    {{1, 1, 0}, Action::kDischarge},
      {{1, 0, 1}, Action::kDischarge},    {{0, 1, 1}, Action::kIdle},
      {{0, 0, 1}, Action::kCharge},       {{0, 1, 0}, Action::kIdle},
      {{-1, -2, -3}, Action::kDischarge}, {{INT32_MIN, INT32_MIN, INT32_MAX}, Action::kCharge},
  };
  for (const auto& c : cases) {
    EXPECT_EQ(argmax_action(c.value), c.best)
        << c.value[0] << ' ' << c.value[1] << ' ' << c.value[2];
  }
}

TEST(Argmax, PowerAndNameOfEachAction) {
  EXPECT_EQ(power_sign(Action::kDischarge), -1);
  EXPECT_EQ(power_sign(Action::kIdle), 0);
  EXPECT_EQ(power_sign(Action::kCharge), 1);
  EXPECT_EQ(action_name(Action::kCharge), "charge");
}

TEST(Crc32, CheckValueOfTheStandard) {
  Crc32 crc;
  EXPECT_EQ(crc.value(), 0u);
  crc.add_bytes("123456789", 9);
  EXPECT_EQ(crc.value(), 0xCBF43926u);
}

TEST(Crc32, IntegersAreTheirLittleEndianBytes) {
  Crc32 integers;
  integers.add_integer(std::int32_t{-2});
  integers.add_integer(std::int16_t{0x0102});
  Crc32 bytes;
  for (const int byte : {0xFE, 0xFF, 0xFF, 0xFF, 0x02, 0x01}) {
    bytes.add_byte(static_cast<std::uint8_t>(byte));
  }
  EXPECT_EQ(integers.value(), bytes.value());
}

TEST(StaticVector, RefusesMoreThanItHolds) {
  StaticVector<int, 2> items;
  EXPECT_TRUE(items.try_push_back(1) && items.try_push_back(2));
  EXPECT_FALSE(items.try_push_back(3));
  EXPECT_EQ(items.size(), 2);
  EXPECT_EQ(items[1], 2);
  EXPECT_DEATH(items.push_back(3), "CHECK failed");
  EXPECT_DEATH(static_cast<void>(items[2]), "CHECK failed");
}

TEST(FixedText, CutsAndSaysSo) {
  FixedText<4> text;
  EXPECT_TRUE(text.assign("four"));
  EXPECT_FALSE(text.assign("fives"));
  EXPECT_EQ(text.view(), "five");
  EXPECT_EQ(text.c_str()[4], '\0');
}

}  // namespace
}  // namespace bess
