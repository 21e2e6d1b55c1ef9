// Every map with unexpected devices: foreign, starting, empty or erratic. Nothing aborts, nothing
// is written before the identity check, and each message names a register or model.
#include <gmock/gmock.h>

#include <random>

#include "edge/app/program/find_battery.h"
#include "edge/device/battery/commission.h"
#include "tests/support/image_device.h"

namespace bess {
namespace {

/// The clock of the sign check in the device's time.
struct CheckClock {
  explicit CheckClock(RegisterDevice& d) : device(d) {}
  [[nodiscard]] std::int64_t now_utc_ns() const { return device.now_ns; }
  bool sleep_until_utc_ns(std::int64_t utc_ns) const {
    if (utc_ns > device.now_ns) device.now_ns = utc_ns;
    return true;
  }
  void pause_ns(std::int64_t ns) const { device.now_ns += ns; }
  RegisterDevice& device;
};

/// All steps of a program with a new device.
void meet(MapUnderTest& t, bool is_stranger) {
  IdentityFailure failure;
  if (t.driver->check_identity(failure) == Status::kImplausible) {
    EXPECT_FALSE(identity_text(t.map, failure).empty());
  }
  static_cast<void>(t.read());
  static_cast<void>(measured_text(t.map, t.driver->live()));
  static_cast<void>(t.order(1'000));
  static_cast<void>(t.driver->release());
  if (is_stranger) {
    EXPECT_THAT(t.device.writes, ::testing::IsEmpty());
  }
  CheckClock clock(t.device);
  SignCheck<DeviceDriver, CheckClock>(CommissionSettings{}, *t.driver, clock).run();
  t.driver->permit_release();
  static_cast<void>(t.driver->release());
}

class StrangeDevices : public ::testing::TestWithParam<MapVariant> {};

TEST_P(StrangeDevices, CauseNoCrash) {
  for (const MapVariant& other : kShippedMapVariants) {
    SimulatedDevice theirs(other.map, other.variant);
    ASSERT_EQ(theirs.test.read(), Status::kOk);
    MapUnderTest t(shipped_map(GetParam().map), GetParam().variant);
    t.device.holding = theirs.test.device.holding;
    t.device.input = theirs.test.device.input;
    meet(t, false);  // some maps of one manufacturer accept each other's devices
  }
}

TEST_P(StrangeDevices, ThatAreStartingOrEmptyAreLeftAlone) {
  for (const int word : {0, 0xFFFF}) {
    for (const int exception : {0, 1, 2, 3, 4, 6, 10, 11, -1}) {
      MapUnderTest t(shipped_map(GetParam().map), GetParam().variant);
      std::ranges::fill(t.device.holding, word);
      std::ranges::fill(t.device.input, word);
      t.device.exception = exception;
      meet(t, exception != 0);
    }
  }
}

TEST_P(StrangeDevices, ThatAreErraticCauseNoCrash) {
  std::mt19937 random(520'011);
  for (int trial = 0; trial < 20; ++trial) {
    SimulatedDevice mad(GetParam().map, GetParam().variant);
    RegisterDevice& device = mad.test.device;
    device.before_request = [&, refresh = device.before_request] {
      refresh();
      for (int i = 0; i < 40; ++i) {
        auto& registers = random() % 2 == 0 ? device.holding : device.input;
        const RegisterPoint& p = mad.test.map.points[static_cast<int>(
            random() % static_cast<unsigned>(mad.test.map.points.size()))];
        registers[p.address] = static_cast<std::uint16_t>(random());
      }
      constexpr int kAnswers[] = {0, 0, 0, 0, 0, 0, -1, 1, 2, 3, 4, 5, 6, 10, 11, 255};
      device.exception = kAnswers[random() % std::size(kAnswers)];
    };
    meet(mad.test, false);
  }
}

INSTANTIATE_TEST_SUITE_P(Shipped, StrangeDevices, ::testing::ValuesIn(kShippedMapVariants));

}  // namespace
}  // namespace bess
