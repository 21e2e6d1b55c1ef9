// SunSpec maps through the real driver: models found by walking, points at their offsets, scale
// factors, and the registers of every order. The other shipped maps: shipped_maps_test.
#include <gmock/gmock.h>

#include "tests/support/register_device.h"

namespace bess {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

/// "SunS" at `base`, the common model, then the two models with these lengths.
void fill_models(RegisterDevice& device, int base, int first, int length, int second) {
  device.set(base, {0x5375, 0x6E53, 1, 66});
  device.set(base + 70, {first, length});
  device.set(base + 72 + length, {second, 62});
  device.set(base + 136 + length, {0xFFFF, 0});
}

TEST(SunSpec704, SetPointTimerAndEnableAtTheirModelsOffsets) {
  MapUnderTest t(shipped_map("sunspec_704"));
  const int der = 50'070;
  const int bank = 50'070 + 67;
  fill_models(t.device, 50'000, 704, 65, 802);
  t.device.set(bank + 3, {800, 40, 35});  // 8000 Wh, 4000 W, 3500 W
  t.device.set(bank + 11, {475});
  t.device.set(bank + 22, {3});
  t.device.set(bank + 47, {1'500});            // discharging
  t.device.set(bank + 53, {1, 2, 0, 0xFFFF});  // Wh, W max, -, SoC scales
  EXPECT_EQ(t.reading().power_w, -1'500);
  EXPECT_EQ(t.measured.soc_e4, 4'750);
  EXPECT_EQ(t.measured.capacity_wh, 8'000);
  EXPECT_EQ(t.measured.charge_w_max, 4'000);
  // -4000 = 0xFFFFF060
  EXPECT_THAT(t.writes_of(4'000),
              ElementsAre(fc16(der + 23, {1, 0xFFFF, 0xF060}), fc16(der + 30, {0, 0, 300}),
                          fc16(bank + 19, {1}), fc16(der + 22, {1})));
  EXPECT_THAT(t.writes_of(-3'000),
              ElementsAre(fc16(der + 23, {1, 0, 3'000}), fc16(der + 30, {0, 0, 300}),
                          fc16(bank + 19, {2}), fc16(der + 22, {1})));
  EXPECT_THAT(t.release_writes(), ElementsAre(fc16(der + 22, {0}), fc16(der + 24, {0, 0})));
}

TEST(SunSpec704, LocalControlAndFrozenHeartbeatAreSeen) {
  MapUnderTest t(shipped_map("sunspec_704"));
  const int bank = 40'070 + 67;
  fill_models(t.device, 40'000, 704, 65, 802);
  t.device.set(bank + 3, {8'000});
  t.device.set(bank + 17, {1});  // local
  EXPECT_EQ(t.order(1'000), Status::kNotPermitted);
  EXPECT_THAT(t.device.writes, IsEmpty());
  ASSERT_EQ(t.read(), Status::kOk);
  t.device.pass_s(61);
  EXPECT_EQ(t.read(), Status::kImplausible);  // the counter has not moved
  t.device.set(bank + 18, {9});
  EXPECT_EQ(t.read(), Status::kOk);
}

TEST(SunSpec704, APreviewKnowsPlacesAndScalesOnceTheDeviceWasRead) {
  MapUnderTest t(shipped_map("sunspec_704"));
  const PowerOrder order{.power_w = 4'000, .duration_s = 300};
  const BlockWrite& write = t.map.sequence(Command::kCharge).writes[0];
  std::uint16_t address = 0;
  RegisterBlock block;
  EXPECT_EQ(t.driver->preview(write, order, address, block), Status::kNotConnected);
  fill_models(t.device, 40'000, 704, 65, 802);
  t.device.set(40'070 + 67 + 3, {8'000});
  t.device.set(40'070 + 55, {1});  // set point in 10 W
  ASSERT_EQ(t.read(), Status::kOk);
  ASSERT_EQ(t.driver->preview(write, order, address, block), Status::kOk);
  EXPECT_EQ(address, 40'093);
  EXPECT_THAT(std::vector<int>(block.begin(), block.end()), ElementsAre(1, 0xFFFF, 65'136));
  EXPECT_THAT(t.device.writes, IsEmpty());
}

TEST(SunSpec704, WithoutItsModelsItIsAnotherDevice) {
  MapUnderTest t(shipped_map("sunspec_704"));
  EXPECT_EQ(t.read(), Status::kImplausible);
  fill_models(t.device, 40'000, 704, 65, 803);
  EXPECT_EQ(t.read(), Status::kImplausible);
}

TEST(SunSpec124, RatesInPerCentOfTheMaximum) {
  MapUnderTest t(shipped_map("sunspec_124"));
  const int inverter = 40'070;
  const int storage = 40'070 + 52;
  fill_models(t.device, 40'000, 103, 50, 124);
  t.device.set(inverter + 14, {150, 1});  // 1500 W to the grid
  t.device.set(storage + 2, {5'000});
  t.device.set(storage + 8, {62});
  t.device.set(storage + 25, {0xFFFF});  // rates in 0.1 %
  EXPECT_EQ(t.reading().power_w, -1'500);
  EXPECT_EQ(t.measured.soc_e4, 6'200);
  ASSERT_EQ(t.order(2'000), Status::kOk);  // -40.0 %
  EXPECT_THAT(
      t.device.take_writes(),
      ElementsAre(fc16(storage + 17, {1}), fc16(storage + 15, {300}), fc16(storage + 12, {0xFE70}),
                  fc16(storage + 13, {1'000}), fc16(storage + 5, {2})));
  ASSERT_EQ(t.driver->release(), Status::kOk);
  EXPECT_THAT(
      t.device.take_writes(),
      ElementsAre(fc16(storage + 5, {0}), fc16(storage + 12, {1'000}), fc16(storage + 13, {1'000}),
                  fc16(storage + 15, {0}), fc16(storage + 17, {0})));
}

}  // namespace
}  // namespace bess
