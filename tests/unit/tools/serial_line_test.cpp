// Simulated battery on a serial line with several units: each unit of its map answers, others are
// absent, and a torn or corrupt request affects only itself. mbpoll, an independent program, is one
// of the masters.
#include <gtest/gtest.h>
#include <sys/socket.h>

#include <string_view>

#include "edge/device/battery/modbus_battery.h"
#include "tests/support/peer_programs.h"
#include "tests/unit/tools/loopback_battery.h"
#include "tools/simulators/battery_sim/battery_server.h"

namespace bess {
namespace {

constexpr std::int32_t kTimeScale = 20;
const MapVariant kSeveralUnits{"victron_ess3",
                               "three_phase"};  // 100 is the system, 228 the inverter
constexpr int kSocAddress = 843, kSetpointAddress = 37;

TEST(SerialLine, TheDriverReachesEveryUnitOfTheMap) {
  LoopbackBattery loopback(load_shipped_map(kSeveralUnits), {}, Transport::kRtu,
                           LoopbackBattery::kHouse, kTimeScale);
  ModbusBattery battery(loopback.link(2'000), loopback.map, loopback.clock);
  BatteryMeasurement m;
  for (const std::int32_t power_w : {3'000, -3'000}) {
    ASSERT_EQ(battery.order({.power_w = power_w, .duration_s = loopback.map.watchdog.duration_s}),
              Status::kOk);
    ASSERT_EQ(battery.read(m), Status::kOk);
    EXPECT_NEAR(m.power_w, power_w, 2);
  }
  ASSERT_EQ(battery.release(), Status::kOk);
  EXPECT_EQ(battery.counters().failed_requests, 0);
}

class SerialRequests : public ::testing::Test {
 protected:
  SerialRequests() { EXPECT_EQ(socketpair(AF_UNIX, SOCK_STREAM, 0, line_), 0); }
  ~SerialRequests() override {
    close(line_[0]);
    hang_up();
  }
  void hang_up() {
    if (line_[1] >= 0) close(line_[1]);
    line_[1] = -1;
  }
  SerialRead take(std::string_view bytes) {
    EXPECT_EQ(write(line_[1], bytes.data(), bytes.size()), static_cast<ssize_t>(bytes.size()));
    return read_serial_request(line_[0], 20, request_);
  }
  int line_[2];
  BusRequest request_;
};

using namespace std::string_view_literals;
constexpr auto kReadTwo = "\x11\x03\x00\x6B\x00\x02\xB7\x47"sv;  // unit 17, 107 and 108
constexpr auto kWriteTwo =
    "\x11\x10\x00\x01\x00\x02\x04\x00\x0A\x01\x02\xC6\xF0"sv;  // the protocol's own example

TEST_F(SerialRequests, AreTakenOneByOneWhateverTheirLength) {
  ASSERT_EQ(take(std::string(kReadTwo) + std::string(kWriteTwo)), SerialRead::kRequest);
  EXPECT_EQ(request_.size, 8);
  EXPECT_EQ(request_.unit(), 17);
  EXPECT_EQ(request_.address(), 107);
  ASSERT_EQ(take(""), SerialRead::kRequest);
  EXPECT_EQ(request_.size, 13);
  EXPECT_EQ(request_.write_count(), 2);
  ASSERT_EQ(take("\x11\x07\x4C\x22"sv),
            SerialRead::kRequest);  // of unknown length: silence ends it
  EXPECT_EQ(request_.size, 4);
}

TEST_F(SerialRequests, TornOrSpoiltOnesAreNoise) {
  std::string spoilt(kReadTwo);
  spoilt[5] ^= 1;
  EXPECT_EQ(take(spoilt), SerialRead::kNoise);
  EXPECT_EQ(take(kReadTwo.substr(0, 5)), SerialRead::kNoise);
  EXPECT_EQ(take(kReadTwo), SerialRead::kRequest);
}

TEST_F(SerialRequests, EndWithTheLine) {
  hang_up();
  EXPECT_EQ(read_serial_request(line_[0], 20, request_), SerialRead::kGone);
}

}  // namespace
}  // namespace bess
