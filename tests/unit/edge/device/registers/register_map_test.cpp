// AlphaESS map, register by register in its dispatch variants, and the codec.
#include <gmock/gmock.h>

#include "edge/device/registers/codec.h"
#include "tests/support/shipped_maps.h"
#include "tests/support/tokens.h"

namespace bess {
namespace {

using ::testing::ElementsAre;

std::vector<std::uint16_t> registers_of(const RegisterMap& map, Command command, int write,
                                        const PowerOrder& order) {
  RegisterBlock block;
  EXPECT_EQ(encode_block(map, map.sequence(command).writes[write], order, block), Status::kOk);
  return {block.begin(), block.end()};
}

int address_of(const RegisterMap& map, const BlockWrite& write) {
  return map.points[write.values[0].point].address;
}

PowerOrder order_of(std::int32_t power_w) {
  return {.power_w = power_w, .soc_min_e4 = 1'000, .soc_max_e4 = 10'000, .duration_s = 300};
}

TEST(AlphaEss, FiveWritesVariantStartsFirstAndSetsTheModeLast) {
  const RegisterMap map = load_shipped_map({"alphaess", "five_writes"});
  const CommandSequence& charge = map.sequence(Command::kCharge);
  ASSERT_EQ(charge.writes.size(), 5);
  const int addresses[] = {0x0880, 0x0881, 0x0887, 0x0886, 0x0885};
  for (int i = 0; i < 5; ++i) EXPECT_EQ(address_of(map, charge.writes[i]), addresses[i]);
  const std::vector<std::uint16_t> registers[] = {{1}, {0, 36'000}, {0, 300}, {25}, {2}};
  for (int i = 0; i < 5; ++i) {
    EXPECT_EQ(registers_of(map, Command::kDischarge, i, order_of(-4'000)), registers[i]) << i;
  }
  ASSERT_EQ(map.sequence(Command::kRelease).writes.size(), 2);
  EXPECT_THAT(registers_of(map, Command::kRelease, 0, {}), ElementsAre(0, 32'000));
  EXPECT_THAT(registers_of(map, Command::kRelease, 1, {}), ElementsAre(0));
}

TEST(AlphaEss, TenAndOneVariantStartsLast) {
  const RegisterMap map = load_shipped_map({"alphaess", "ten_and_one"});
  const CommandSequence& charge = map.sequence(Command::kCharge);
  ASSERT_EQ(charge.writes.size(), 2);
  EXPECT_EQ(address_of(map, charge.writes[0]), 0x0881);
  EXPECT_EQ(address_of(map, charge.writes[1]), 0x0880);
  EXPECT_THAT(registers_of(map, Command::kCharge, 0, order_of(4'000)),
              ElementsAre(0, 28'000, 0, 32'000, 2, 255, 0, 300, 255, 0));
  EXPECT_THAT(registers_of(map, Command::kCharge, 1, order_of(4'000)), ElementsAre(1));
}

TEST(AlphaEss, SocLimitIsRoundedInwards) {
  const RegisterMap map = load_shipped_map({"alphaess", "block"});
  PowerOrder order = order_of(4'000);
  order.soc_max_e4 = 9'550;  // 238.75 counts: a ceiling goes down
  EXPECT_EQ(registers_of(map, Command::kCharge, 0, order)[6], 238);
  order = order_of(-4'000);
  order.soc_min_e4 = 1'010;  // 25.25 counts: a floor goes up
  EXPECT_EQ(registers_of(map, Command::kDischarge, 0, order)[6], 26);
}

TEST(AlphaEss, PowerBeyondTheRangeIsRefusedAndNeverWraps) {
  const RegisterMap map = load_shipped_map({"alphaess", "block"});
  EXPECT_EQ(check_expressible(map, order_of(32'000)), Status::kOk);
  EXPECT_EQ(check_expressible(map, order_of(32'001)), Status::kNotExpressible);
  EXPECT_EQ(check_expressible(map, order_of(-32'001)), Status::kNotExpressible);
  RegisterBlock block;
  EXPECT_EQ(encode_block(map, map.sequence(Command::kCharge).writes[0], order_of(33'000), block),
            Status::kNotExpressible);
}

TEST(Codec, EncodeInvertsDecodeForEveryTypeAndWordOrder) {
  for (const RegisterType type :
       {RegisterType::kU16, RegisterType::kS16, RegisterType::kU32, RegisterType::kS32}) {
    for (const WordOrder order : {WordOrder::kHighFirst, WordOrder::kLowFirst}) {
      for (const std::int32_t sign : {1, -1}) {
        RegisterPoint point;
        point.type = type;
        point.word_order = order;
        point.sign = sign;
        point.scale = 10;
        point.offset = 500;
        point.registers = type == RegisterType::kU32 || type == RegisterType::kS32 ? 2 : 1;
        point.value_min = INT64_MIN;
        point.value_max = INT64_MAX;
        for (const std::int64_t value : {-3'000, -10, 0, 10, 4'990}) {
          RegisterBlock block;
          const Status status = encode(point, value, Rounding::kNearest, block);
          if (status == Status::kNotExpressible) continue;  // below zero of an unsigned type
          std::int64_t back = 0;
          EXPECT_TRUE(decode(point, block.data(), back));
          EXPECT_EQ(back, value);
        }
      }
    }
  }
}

/// Before a device is read, its scale factor is the map's least: 10^-2.
TEST(Codec, WithoutADeviceScalesAreAssumed) {
  const RegisterMap map = load_shipped_map({"sunspec_704", ""});
  ASSERT_EQ(map.points[find_point(map, "set_power_sf")].value_min, -2);
  EXPECT_THAT(registers_of(map, Command::kCharge, 0, order_of(4'000)),
              ElementsAre(1, 0xFFF9, 0xE580));  // -400000
}

TEST(MapFile, UnknownVariantNamesTheKnownOnes) {
  RegisterMap map;
  std::string error;
  EXPECT_FALSE(load_register_map(shipped_map("alphaess"), "blok", map, error));
  EXPECT_THAT(error, Names("blok block five_writes ten_and_one"));
}

}  // namespace
}  // namespace bess
