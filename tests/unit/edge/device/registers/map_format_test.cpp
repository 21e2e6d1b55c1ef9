// Map format: types, word orders, scales, masks, missing values, included files, variants; and
// every mistake is one line with file, line and correction.
#include <gmock/gmock.h>

#include <bit>

#include "edge/device/registers/codec.h"
#include "edge/device/registers/map_file.h"
#include "tests/support/shipped_maps.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/tokens.h"

namespace bess {
namespace {

using ::testing::ElementsAre;
using ::testing::StartsWith;

constexpr const char* kHead = R"([map]
name = "test"
unit = 7
address_base = 1
[power]
charge_w_max = 1000
discharge_w_max = 1000
[watchdog]
kind = "none"
[state]
measure = ["soc", "battery_power"]
active = ["enable = 1"]
[[point]]
name = "soc"
address = 1
min = 0
max = 10000
[[point]]
name = "battery_power"
address = 2
type = "s16"
min = -1000
max = 1000
[[point]]
name = "enable"
address = 3
names = { off = 0, on = 1 }
bits = { ready = 0, failed = 15 }
min = 0
max = 65535
[command]
order = ["enable = on", "power = power"]
release = ["enable = off"]
[[point]]
name = "power"
address = 4
)";
const std::string kGood = std::string(kHead) + "type = \"s32\"\nmin = -1000\nmax = 1000\n";

class MapFormat : public ::testing::Test {
 protected:
  /// A map whose point "power" has these keys.
  RegisterMap with_point(const std::string& keys) {
    std::string head = kHead;  // no command writes the point under test: any type is allowed
    head.replace(head.find("power = power"), 13, "battery_power = power");
    return loaded(head + keys + "\nmin = -5000000000\nmax = 5000000000\n");
  }
  RegisterMap loaded(const std::string& text, const std::string& variant = "") {
    return load_good_map(folder_.write("map.toml", text), variant);
  }
  std::int64_t decoded(const std::string& keys, std::vector<std::uint16_t> raw) {
    const RegisterMap map = with_point(keys);
    std::int64_t value = -99;
    decodes_ = decode(map.points[find_point(map, "power")], raw.data(), value);
    return value;
  }
  std::vector<int> encoded(const std::string& keys, std::int64_t value,
                           Rounding rounding = Rounding::kNearest) {
    const RegisterMap map = with_point(keys);
    RegisterBlock block;
    status_ = encode(map.points[find_point(map, "power")], value, rounding, block);
    return {block.begin(), block.end()};
  }
  std::string error_of(const std::string& text) {
    RegisterMap map;
    std::string error;
    EXPECT_FALSE(load_register_map(folder_.write("map.toml", text), "", map, error)) << text;
    EXPECT_EQ(error.find('\n'), std::string::npos) << error;
    return error;
  }

  TemporaryFolder folder_;
  bool decodes_ = false;
  Status status_ = Status::kOk;
};

TEST_F(MapFormat, AddressesCountFromTheBase) {
  const RegisterMap map = with_point("type = \"s32\"");
  EXPECT_EQ(map.points[find_point(map, "soc")].address, 0);
  EXPECT_EQ(map.points[find_point(map, "power")].address, 3);
}

TEST_F(MapFormat, FloatsBecomeWholeUnits) {
  const std::uint32_t bits = std::bit_cast<std::uint32_t>(-1'234.567F);
  const auto high = static_cast<std::uint16_t>(bits >> 16);
  const auto low = static_cast<std::uint16_t>(bits);
  EXPECT_EQ(decoded("type = \"f32\"", {high, low}), -1'235);
  EXPECT_EQ(decoded("type = \"f32\"\nscale = 10\nsign = -1", {high, low}), 12'346);
  EXPECT_EQ(decoded("type = \"f32\"\nword_order = \"low_first\"", {low, high}), -1'235);
  EXPECT_THAT(encoded("type = \"f32\"\nscale = 10", -12'340),
              ElementsAre(0xC49A, 0x4000));  // -1234.0
  decoded("type = \"f32\"", {0x7FC0, 0});
  EXPECT_FALSE(decodes_) << "not a number";
  decoded("type = \"f32\"", {0x7F80, 0});
  EXPECT_FALSE(decodes_) << "infinity";
  RegisterPoint any;  // no range rejects what rounding makes of it
  any.type = RegisterType::kF32;
  any.registers = 2;
  any.value_min = INT64_MIN;
  any.value_max = INT64_MAX;
  const std::uint16_t not_a_number[] = {0x7FC0, 0};
  std::int64_t value = 0;
  EXPECT_FALSE(decode(any, not_a_number, value));
}

TEST_F(MapFormat, WideNumbers) {
  EXPECT_EQ(decoded("type = \"u64\"", {0, 1, 2, 3}), (std::int64_t{1} << 32) + (2 << 16) + 3);
  EXPECT_EQ(decoded("type = \"u64\"\nword_order = \"low_first\"", {3, 2, 1, 0}),
            (std::int64_t{1} << 32) + (2 << 16) + 3);
  decoded("type = \"u64\"", {0x8000, 0, 0, 0});
  EXPECT_FALSE(decodes_);
}

TEST_F(MapFormat, ExtremesAreNoValuesByType) {
  const std::string head = std::string(kGood).insert(6, "not_implemented = \"extremes\"\n");
  const std::pair<const char*, std::vector<std::uint64_t>> cases[] = {
      {"u16", {0xFFFF}},
      {"s16", {0x8000, 0x7FFF}},
      {"u32", {0xFFFF'FFFF}},
      {"s32", {0x8000'0000, 0x7FFF'FFFF}}};
  for (const auto& [type, nothing] : cases) {
    const RegisterMap map = loaded(head + "[[point]]\nname = \"probe\"\naddress = 9\nmin = -9\n" +
                                   "max = 4294967295\ntype = \"" + type + "\"\n");
    const auto& found = map.points[find_point(map, "probe")].not_implemented;
    EXPECT_EQ(std::vector<std::uint64_t>(found.begin(), found.end()), nothing) << type;
  }
}

TEST_F(MapFormat, AnOptionalPointIsNoScaleOfAnother) {
  std::string head = kGood;
  head.insert(head.find("active ="), "alarms = [\"rare\"]\n");
  head.insert(head.rfind("[[point]]"),
              "[[point]]\nname = \"rare\"\naddress = 9\nmin = 0\nmax = 9\noptional = true\n");
  loaded(head);
  EXPECT_THAT(error_of(head + "clamp_to = \"rare\"\n"), Names("\"power\" \"rare\""));
}

TEST_F(MapFormat, TextsAreComparedWithoutTheirPadding) {
  RegisterPoint point;
  point.type = RegisterType::kText;
  point.registers = 4;
  const std::uint16_t raw[] = {'S' << 8 | 'H', '1' << 8 | '0', '\0', 0x2020};
  EXPECT_EQ(decode_text(point, raw).view(), "SH10");
}

TEST_F(MapFormat, OffsetSignScaleAndMissingValues) {
  EXPECT_EQ(decoded("type = \"u16\"\noffset = 32000\nsign = -1", {28'000}), 4'000);
  EXPECT_THAT(encoded("type = \"u16\"\noffset = 32000\nsign = -1", 4'000), ElementsAre(28'000));
  EXPECT_EQ(decoded("type = \"s16\"\nscale_divisor = 10", {0xFFF1}), -1);  // -1.5
  decoded("type = \"u16\"\nnot_implemented = [0xFFFF, 0xFFFE]", {0xFFFE});
  EXPECT_FALSE(decodes_);
  decoded("type = \"u16\"\nnot_implemented = [0xFFFF, 0xFFFE]", {0xFFFD});
  EXPECT_TRUE(decodes_);
}

TEST_F(MapFormat, RoundingAndSteps) {
  const std::string ten = "type = \"s16\"\nscale = 10\n";
  EXPECT_THAT(encoded(ten, 15), ElementsAre(2));
  EXPECT_THAT(encoded(ten, 19, Rounding::kDown), ElementsAre(1));
  EXPECT_THAT(encoded(ten, 11, Rounding::kUp), ElementsAre(2));
  // Rounding down applies to the value, not the raw count behind a mirrored sign.
  EXPECT_THAT(encoded(ten + "sign = -1", 19, Rounding::kDown), ElementsAre(0xFFFF));
  EXPECT_THAT(encoded("type = \"s16\"\nstep = 100", 999), ElementsAre(900));
  EXPECT_THAT(encoded("type = \"s16\"\nstep = 100", -999), ElementsAre(65'536 - 900));
}

TEST_F(MapFormat, TwoFactsInOneRegister) {
  RegisterPoint high;
  high.mask = 0xFF00;
  high.value_max = 255;
  RegisterPoint low = high;
  low.mask = 0x00FF;
  const std::uint16_t raw = 0x0201;
  std::int64_t value = 0;
  ASSERT_TRUE(decode(high, &raw, value));
  EXPECT_EQ(value, 2);
  ASSERT_TRUE(decode(low, &raw, value));
  EXPECT_EQ(value, 1);
}

/// The map's name of a point's value; empty if it has none.
std::string_view name_of_value(const RegisterMap& map, int point, std::int64_t value) {
  for (const NamedValue& named : map.names) {
    if (named.point == point && !named.is_bit && named.value == value) return named.name.view();
  }
  return {};
}

TEST_F(MapFormat, NamesOfValuesAndBits) {
  const RegisterMap map = with_point("type = \"s32\"");
  EXPECT_EQ(name_of_value(map, find_point(map, "enable"), 1), "on");
  EXPECT_EQ(name_of_value(map, find_point(map, "enable"), 9), "");
  std::string text = kGood;
  text.replace(
      text.find("active = [\"enable = 1\"]"), 23,
      "active = [\"enable = on\"]\nalarms = [\"enable has failed\"]\noff_grid = \"enable != on\"");
  const RegisterMap named = loaded(text);
  EXPECT_TRUE(named.alarms[0].holds(0x8001));
  EXPECT_FALSE(named.alarms[0].holds(0x7FFF));
  EXPECT_TRUE(named.off_grid.holds(0));
}

TEST_F(MapFormat, AnIncludedFileIsChangedPointByPointAndByVariants) {
  folder_.write("base.toml", kGood);
  const std::string child = R"(include = "base.toml"
[map]
unit = 9
[[point]]
name = "soc"
address = 101
[[variant]]
name = "small"
[[variant]]
name = "large"
[variant.power]
charge_w_max = 900
[[variant.point]]
name = "power"
address = 201
)";
  RegisterMap map = loaded(child);
  EXPECT_EQ(map.variant.view(), "small");
  EXPECT_EQ(map.unit, 9);
  EXPECT_EQ(map.points[find_point(map, "soc")].address, 100);
  EXPECT_EQ(map.points[find_point(map, "soc")].value_max, 10'000);  // the included file's
  EXPECT_EQ(map.charge_w_max, 1'000);
  map = loaded(child, "large");
  EXPECT_EQ(map.charge_w_max, 900);
  EXPECT_EQ(map.points[find_point(map, "power")].address, 200);
  EXPECT_EQ(map.sequence(Command::kCharge).writes[1].values[0].point, find_point(map, "power"));
}

TEST_F(MapFormat, AWriteOfItsOwnFunctionIsReadBackExactlyUnlessSaid) {
  std::string text = kGood;
  const std::string plain = "\"enable = on\", \"power";
  text.replace(text.find(plain), plain.size(),
               "{ write = \"enable = on\", function = 16 }, \"power");
  const RegisterMap map = loaded(text);
  const BlockWrite& write = map.sequence(Command::kCharge).writes[0];
  EXPECT_EQ(write.function, 16);
  EXPECT_EQ(write.read_back, ReadBack::kExact);
}

TEST_F(MapFormat, MistakesNameTheFileInWhichTheyAre) {
  const std::string base_path =
      folder_.write("base.toml", std::string(kHead) + "type = \"s31\"\nmin = -1000\nmax = 1000\n");
  const std::string path = folder_.write("child.toml", "include = \"base.toml\"\n");
  RegisterMap map;
  std::string error;
  EXPECT_FALSE(load_register_map(path, "", map, error));
  EXPECT_THAT(error, StartsWith(base_path + ":37: "));
  EXPECT_THAT(error_of("include = \"../secret.toml\"\n"), Names("include"));
  folder_.write("loop.toml", "include = \"map.toml\"\n");
  EXPECT_THAT(error_of("include = \"loop.toml\"\n"), Names("include"));
}

TEST_F(MapFormat, ATimeThatDoesNotFitIsTheWatchdogsMistake) {
  const auto map_with = [](const std::string& argument, const std::string& max) {
    std::string text = kGood;
    const auto put = [&text](std::string_view before, const std::string& after) {
      text.replace(text.find(before), before.size(), after);
    };
    put("kind = \"none\"", "kind = \"duration\"\nduration_s = 601\nrefresh_s = 60");
    put("\"power = power\"", "\"power = power\", \"time = " + argument + "\"");
    put("[command]",
        "[[point]]\nname = \"time\"\naddress = 9\nmin = 0\nmax = " + max + "\n[command]");
    return text;
  };
  EXPECT_THAT(error_of(map_with("duration", "600")), Names("duration_s 601 s \"time\""));
  EXPECT_THAT(error_of(map_with("duration_minutes", "10")), Names("duration_s 601 11 \"time\""));
  loaded(map_with("duration_minutes", "11"));
}

TEST_F(MapFormat, EveryMistakeHasItsCorrection) {
  const struct {
    std::string before, after, codes;
  } mistakes[] = {
      {"unit = 7", "unit = 7\nunti = 7", "unti"},
      {"unit = 7", "unit = \"7\"", "unit"},
      {"unit = 7", "unit = 300", "unit 0 255"},
      {"type = \"s32\"", "type = \"s31\"", "type"},
      {"power = power", "power = watts", "\"watts\""},
      {"measure = [\"soc\", ", "measure = [\"sco\", ", "[[point]] \"sco\""},
      {"measure = [\"soc\", ", "alive = { point = \"soc\" }\nmeasure = [\"soc\", ", "max_age_s"},
      {"measure = [\"soc\", ",
       "alive = { point = \"soc\", max_age_s = 60, age = 1 }\nmeasure = [\"soc\", ", "alive age"},
      {"charge_w_max = 1000", "charge_w_max = 40000", "power 40000"},
      {"name = \"battery_power\"", "name = \"soc\"", "name"},
      {"[map]", "[map", "TOML"},
      {"kind = \"none\"", "kind = \"none\"\nduration = 3", "[watchdog] duration"},
      {"kind = \"none\"", "kind = \"rewrite\"\nduration_s = 60\nrefresh_s = 31", "refresh_s"},
      {"kind = \"none\"", "kind = \"duration\"\nduration_s = 60\nrefresh_s = 30", "\"heartbeat\""},
      {"kind = \"none\"", "kind = \"rewrite\"", "duration_s"},
      {"active = [\"enable = 1\"]", "active = [\"enable = maybe\"]", "enable"},
      {"active = [\"enable = 1\"]", "active = [\"unable = 1\"]", "unable"},
      {"active = [\"enable = 1\"]", "alarms = [\"soc has 16384\"]",
       "\"soc 16384\" \"soc\" 0 10000"},
      {"active = [\"enable = 1\"]", "alarms = [\"enable has 65536\"]", "65536 \"enable\" 0 65535"},
      {"active = [\"enable = 1\"]", "alarms = [\"battery_power has 65536\"]",  // bit 16 of 0 to 15
       "65536 \"battery_power\" -1000 1000"},
      {"active = [\"enable = 1\"]", "warnings = [\"enable has 0\"]", "\"enable has 0\""},
      {"active = [\"enable = 1\"]", "off_grid = \"soc = 10001\"", "\"soc\" 0 10000"},
      {"measure = [\"soc\", ", "measure = [", "\"soc\""},
      {"measure = [\"soc\", ", "measure = [\"soc\", \"soc\", ", "\"soc\""},
      {"name = \"battery_power\"", "name = \"battery power\"", "name"},
      {"\"enable = on\", \"power", "\"enable\", \"power", "map.toml:32"},
      {"\"enable = on\", \"power", "{ function = 6 }, \"power", "write"},
      {"\"enable = on\", \"power",
       "{ write = \"enable = on\", read_back = \"tolerance\" }, \"power", "tolerance"},
      {"\"enable = on\", \"power", "{ write = \"enable = on\", function = 7 }, \"power",
       "function 6 16"},
      {"release = [\"enable = off\"]", "", "release"},
      {"release = [\"enable = off\"]", "release = [\"enable = saved\"]", "save"},
      {"release = [\"enable = off\"]", "release = [\"enable = rating\"]", "percent_of"},
      {"type = \"s32\"", "type = \"s32\"\nmodel = 124", "model [sunspec] models"},
      {"type = \"s32\"", "type = \"s32\"\nunit_group = \"x\"", "unit_group [unit_groups]"},
      {"type = \"s32\"", "type = \"s32\"\nmask = 3", "mask type"},
      {"type = \"s32\"", "type = \"s32\"\nsign = 0", "sign 1 -1"},
      {"type = \"s32\"", "type = \"s32\"\nscale_from = \"later\"", "later"},
      {"type = \"s32\"", "type = \"s32\"\nstorage = \"eeprom\"", "eeprom_writes_per_day"},
      {"type = \"s32\"\nmin = -1000", "type = \"s32\"\nmin = -999", "power -1000"},
      {"type = \"s32\"", "type = \"u32\"", "power -1000"},
      {"type = \"s32\"", "type = \"s32\"\noptional = true", "\"power\""},
      {"name = \"soc\"", "name = \"soc\"\noptional = true", "\"soc\""},
      {"[command]", "[simulator]\ninitial = [\"soc has capacity\"]\n[command]",
       "\"point power_max capacity\""},
      {"address = 4\n", "address = 0\n", "address 1 65535"},
      {"[command]", "[[identity]]\npoint = \"soc\"\nhint = \"x\"\ntext = \"y\"\n[command]", "min"},
      {"max = 10000\n", "", "max"},
      {"active = [\"enable = 1\"]", "active = [\"enable = -5000000001\"]", "enable"},
      {"[command]", "[exceptions]\nretry = [256]\n[command]", "retry 1 255"},
      {"[command]", "[commissioning]\nduration_s = 60\nsettle_s = 60\n[command]",
       "settle_s duration_s"},
  };
  for (const auto& mistake : mistakes) {
    std::string text = kGood;
    const std::size_t at = text.find(mistake.before);
    ASSERT_NE(at, std::string::npos) << mistake.before;
    text.replace(at, mistake.before.size(), mistake.after);
    const std::string error = error_of(text);
    EXPECT_THAT(error, Names(mistake.codes)) << mistake.after;
    EXPECT_THAT(error, StartsWith(folder_.file("map.toml") + ":")) << mistake.after;
  }
}

}  // namespace
}  // namespace bess
