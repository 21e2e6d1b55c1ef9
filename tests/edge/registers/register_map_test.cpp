// The AlphaESS map, register by register in all three dispatch variants, and the map file's own
// errors.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "edge/registers/codec.h"
#include "edge/registers/map_file.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/tokens.h"

namespace bess {
namespace {

using ::testing::ElementsAre;
using ::testing::StartsWith;

const std::string kMapPath = std::string(BESS_SOURCE_DIR) + "/edge/maps/alphaess.toml";

RegisterMap load_variant(std::string_view variant) {
  RegisterMap map;
  std::string error;
  EXPECT_TRUE(load_register_map(kMapPath, variant, map, error)) << error;
  return map;
}

std::vector<std::uint16_t> registers_of(const RegisterMap& map, Command command, int write,
                                        const PowerOrder& order) {
  RegisterBlock block;
  EXPECT_EQ(encode_block(map, map.sequence(command).writes[write], order, block), Status::kOk);
  return {block.begin(), block.end()};
}

PowerOrder order_of(std::int32_t power_w) {
  return {.power_w = power_w, .soc_min_e4 = 1'000, .soc_max_e4 = 10'000, .duration_s = 300};
}

TEST(AlphaEss, BlockVariantIsOneWriteOfElevenRegisters) {
  const RegisterMap map = load_variant("block");
  ASSERT_EQ(map.sequence(Command::kCharge).writes.size(), 1);
  EXPECT_EQ(map.sequence(Command::kCharge).writes[0].address, 0x0880);
  EXPECT_EQ(map.sequence(Command::kCharge).writes[0].function, 16);
  EXPECT_THAT(registers_of(map, Command::kCharge, 0, order_of(4'000)),
              ElementsAre(1, 0, 28'000, 0, 32'000, 2, 255, 0, 300, 255, 0));
  EXPECT_THAT(registers_of(map, Command::kIdle, 0, order_of(0)),
              ElementsAre(1, 0, 32'000, 0, 32'000, 2, 255, 0, 300, 255, 0));
  EXPECT_THAT(registers_of(map, Command::kDischarge, 0, order_of(-4'000)),
              ElementsAre(1, 0, 36'000, 0, 32'000, 2, 25, 0, 300, 255, 0));
  EXPECT_THAT(registers_of(map, Command::kRelease, 0, {}),
              ElementsAre(0, 0, 32'000, 0, 32'000, 0, 0, 0, 90, 255, 0));
}

TEST(AlphaEss, FiveWritesVariantStartsFirstAndSetsTheModeLast) {
  const RegisterMap map = load_variant("five_writes");
  const CommandSequence& charge = map.sequence(Command::kCharge);
  ASSERT_EQ(charge.writes.size(), 5);
  const int addresses[] = {0x0880, 0x0881, 0x0887, 0x0886, 0x0885};
  for (int i = 0; i < 5; ++i) EXPECT_EQ(charge.writes[i].address, addresses[i]);
  EXPECT_THAT(registers_of(map, Command::kDischarge, 0, order_of(-4'000)), ElementsAre(1));
  EXPECT_THAT(registers_of(map, Command::kDischarge, 1, order_of(-4'000)), ElementsAre(0, 36'000));
  EXPECT_THAT(registers_of(map, Command::kDischarge, 2, order_of(-4'000)), ElementsAre(0, 300));
  EXPECT_THAT(registers_of(map, Command::kDischarge, 3, order_of(-4'000)), ElementsAre(25));
  EXPECT_THAT(registers_of(map, Command::kDischarge, 4, order_of(-4'000)), ElementsAre(2));
  ASSERT_EQ(map.sequence(Command::kRelease).writes.size(), 2);
  EXPECT_THAT(registers_of(map, Command::kRelease, 0, {}), ElementsAre(0, 32'000));
  EXPECT_THAT(registers_of(map, Command::kRelease, 1, {}), ElementsAre(0));
}

TEST(AlphaEss, TenAndOneVariantStartsLast) {
  const RegisterMap map = load_variant("ten_and_one");
  const CommandSequence& charge = map.sequence(Command::kCharge);
  ASSERT_EQ(charge.writes.size(), 2);
  EXPECT_EQ(charge.writes[0].address, 0x0881);
  EXPECT_EQ(charge.writes[1].address, 0x0880);
  EXPECT_THAT(registers_of(map, Command::kCharge, 0, order_of(4'000)),
              ElementsAre(0, 28'000, 0, 32'000, 2, 255, 0, 300, 255, 0));
  EXPECT_THAT(registers_of(map, Command::kCharge, 1, order_of(4'000)), ElementsAre(1));
}

TEST(AlphaEss, SocLimitIsRoundedInwards) {
  const RegisterMap map = load_variant("block");
  PowerOrder order = order_of(4'000);
  order.soc_max_e4 = 9'550;  // 238.75 counts: a ceiling goes down
  EXPECT_EQ(registers_of(map, Command::kCharge, 0, order)[6], 238);
  order = order_of(-4'000);
  order.soc_min_e4 = 1'010;  // 25.25 counts: a floor goes up
  EXPECT_EQ(registers_of(map, Command::kDischarge, 0, order)[6], 26);
}

TEST(AlphaEss, PowerBeyondTheRangeIsRefusedAndNeverWraps) {
  const RegisterMap map = load_variant("block");
  EXPECT_EQ(check_expressible(map, order_of(32'000)), Status::kOk);
  EXPECT_EQ(check_expressible(map, order_of(32'001)), Status::kNotExpressible);
  EXPECT_EQ(check_expressible(map, order_of(-32'001)), Status::kNotExpressible);
  RegisterBlock block;
  EXPECT_EQ(encode_block(map, map.sequence(Command::kCharge).writes[0], order_of(33'000), block),
            Status::kNotExpressible);
}

TEST(AlphaEss, MeasurementsDecodeToOurSignsAndUnits) {
  const RegisterMap map = load_variant("block");
  const auto value_of = [&](std::string_view name, std::vector<std::uint16_t> raw) {
    std::int64_t value = -1;
    EXPECT_TRUE(decode(map.points[find_point(map, name)], raw.data(), value)) << name;
    return value;
  };
  EXPECT_EQ(value_of("soc", {435}), 4'350);
  EXPECT_EQ(value_of("battery_power", {static_cast<std::uint16_t>(-1500)}), 1'500);  // charging
  EXPECT_EQ(value_of("battery_power", {1'500}), -1'500);
  EXPECT_EQ(value_of("capacity", {80}), 8'000);
  EXPECT_EQ(value_of("temperature_min", {static_cast<std::uint16_t>(-55)}), -55);
  EXPECT_EQ(value_of("battery_fault", {0x8000, 0x0001}), 0x8000'0001);
  EXPECT_EQ(value_of("dispatch_power", {0, 36'000}), -4'000);
  std::int64_t value = 0;
  const std::uint16_t impossible = 1'051;
  EXPECT_FALSE(decode(map.points[find_point(map, "soc")], &impossible, value));
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

TEST(Codec, LowFirstSwapsTheWords) {
  RegisterPoint point;
  point.type = RegisterType::kU32;
  point.registers = 2;
  point.value_max = UINT32_MAX;
  RegisterBlock block;
  ASSERT_EQ(encode(point, 0x0001'0002, Rounding::kNearest, block), Status::kOk);
  EXPECT_THAT(std::vector<int>(block.begin(), block.end()), ElementsAre(1, 2));
  point.word_order = WordOrder::kLowFirst;
  block.clear();
  ASSERT_EQ(encode(point, 0x0001'0002, Rounding::kNearest, block), Status::kOk);
  EXPECT_THAT(std::vector<int>(block.begin(), block.end()), ElementsAre(2, 1));
}

/// The shipped map with one text replaced must be refused, and these codes named.
struct MapError {
  std::string before, after, codes;
};

TEST(MapFile, EveryMistakeIsOneClearLine) {
  const TemporaryFolder folder;
  std::stringstream shipped;
  shipped << std::ifstream(kMapPath).rdbuf();
  const MapError mistakes[] = {
      {"minimum_gap_ms = 400", "minimum_gap = 400", "minimum_gap"},
      {"unit = 85", "unit = \"85\"", "unit"},
      {"unit = 85", "unit = 300", "unit 0 255"},
      {"type = \"s16\"", "type = \"s15\"", "type"},
      {"dispatch_power = power", "dispatch_power = watts", "\"watts\""},
      {"\"dispatch_mode = soc_control\", \"dispatch_soc", "\"dispatch_soc", "\"dispatch_soc\""},
      {"measure = [\"soc\"", "measure = [\"sco\"", "[[point]] \"sco\""},
      {"charge_w_max = 32000", "charge_w_max = 40000", "power 40000"},
      {"name = \"temperature_min\"", "name = \"soc\"", "name"},
      {"[map]", "[map", "TOML"},
  };
  for (const MapError& mistake : mistakes) {
    std::string text = shipped.str();
    const std::size_t at = text.find(mistake.before);
    ASSERT_NE(at, std::string::npos) << mistake.before;
    text.replace(at, mistake.before.size(), mistake.after);
    const std::string path = folder.write("map.toml", text);
    RegisterMap map;
    std::string error;
    EXPECT_FALSE(load_register_map(path, "", map, error)) << mistake.after;
    EXPECT_THAT(error, StartsWith(path + ":")) << mistake.after;
    EXPECT_THAT(error, Names(mistake.codes)) << mistake.after;
    EXPECT_EQ(error.find('\n'), std::string::npos) << error;
  }
}

TEST(MapFile, UnknownVariantNamesTheKnownOnes) {
  RegisterMap map;
  std::string error;
  EXPECT_FALSE(load_register_map(kMapPath, "blok", map, error));
  EXPECT_THAT(error, Names("blok block five_writes ten_and_one"));
}

TEST(MapFile, MissingFile) {
  RegisterMap map;
  std::string error;
  EXPECT_FALSE(load_register_map("/nonexistent/map.toml", "", map, error));
  EXPECT_THAT(error, Names("/nonexistent/map.toml"));
}

}  // namespace
}  // namespace bess
