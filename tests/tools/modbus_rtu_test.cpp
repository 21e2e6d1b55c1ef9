// The edge's Modbus driver over RTU: a pseudo terminal with a libmodbus slave at its other end. The
// fault that matters is the late reply: RTU has no transaction id, and libmodbus alone would take
// it for the answer to the next question.
#include <gtest/gtest.h>
#include <modbus/modbus.h>
#include <poll.h>
#include <pty.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <thread>

#include "edge/battery/modbus_battery.h"
#include "edge/registers/codec.h"
#include "edge/registers/map_file.h"

namespace bess {
namespace {

class RtuSlave {
 public:
  RtuSlave() {
    char name[128];
    EXPECT_EQ(openpty(&master_, &terminal_, name, nullptr, nullptr), 0);
    device_ = name;
    context_ = modbus_new_rtu(name, 9'600, 'N', 8, 1);
    modbus_set_slave(context_, 85);
    modbus_set_socket(context_, master_);
    mapping_ = modbus_mapping_new(0, 0, 0x1000, 0);
    set(0x0102, 435);
    set(0x0119, 80);
    set(0x0126, 0xFA24);  // -1500 at the device: charging
    set(0x012C, 4'000);
    set(0x012D, 4'000);
    set(0x0440, 1);
    thread_ = std::thread([this] { run(); });
  }
  ~RtuSlave() {
    stopping_ = true;
    thread_.join();
    modbus_mapping_free(mapping_);
    modbus_free(context_);
    ::close(terminal_);
    ::close(master_);
  }
  void set(int address, int value) {
    mapping_->tab_registers[address] = static_cast<std::uint16_t>(value);
  }
  [[nodiscard]] int get(int address) const { return mapping_->tab_registers[address]; }
  [[nodiscard]] const std::string& device() const { return device_; }

  std::atomic<int> late_replies = 0;  ///< so many of the next replies come after the time-out

 private:
  void run() {
    while (!stopping_) {
      pollfd event{.fd = master_, .events = POLLIN, .revents = 0};
      if (poll(&event, 1, 20) <= 0) continue;
      std::uint8_t request[MODBUS_RTU_MAX_ADU_LENGTH];
      const int size = modbus_receive(context_, request);
      if (size <= 0) continue;
      if (late_replies > 0) {
        --late_replies;
        std::this_thread::sleep_for(std::chrono::milliseconds(250));
      }
      modbus_reply(context_, request, size, mapping_);
    }
  }

  int master_ = -1;
  int terminal_ = -1;  ///< kept open, so that the master never sees a hang-up
  std::string device_;
  modbus_t* context_ = nullptr;
  modbus_mapping_t* mapping_ = nullptr;
  std::atomic<bool> stopping_ = false;
  std::thread thread_;
};

class ModbusRtu : public ::testing::Test {
 protected:
  ModbusRtu() {
    std::string error;
    EXPECT_TRUE(load_register_map(BESS_SOURCE_DIR "/edge/maps/alphaess.toml", "", map_, error));
    link_.rtu = true;
    EXPECT_TRUE(link_.device.assign(slave_.device()));
    link_.response_timeout_ms = 150;
  }
  RtuSlave slave_;
  RegisterMap map_;
  BatteryLinkSettings link_;
  ScaledClock clock_{.scale = 1'000};
};

TEST_F(ModbusRtu, ReadsOrdersAndReleases) {
  ModbusBattery battery(link_, map_, clock_);
  BatteryMeasurement m;
  ASSERT_EQ(battery.read(m), Status::kOk);
  EXPECT_EQ(m.soc_e4, 4'350);
  EXPECT_EQ(m.power_w, 1'500);
  PowerOrder order{.power_w = -4'000, .soc_min_e4 = 1'000, .duration_s = 300};
  ASSERT_EQ(battery.order(order), Status::kOk);
  EXPECT_EQ(slave_.get(0x0880), 1);
  EXPECT_EQ(slave_.get(0x0882), 36'000);
  ASSERT_EQ(battery.release(), Status::kOk);
  EXPECT_EQ(slave_.get(0x0880), 0);
}

TEST_F(ModbusRtu, ALateReplyIsNeverTakenForTheNextAnswer) {
  ModbusBattery battery(link_, map_, clock_);
  BatteryMeasurement m;
  ASSERT_EQ(battery.read(m), Status::kOk);
  for (int i = 0; i < 2; ++i) {
    slave_.late_replies = 1;
    ASSERT_EQ(battery.read(m), Status::kOk);  // the second attempt, after waiting and flushing
    EXPECT_EQ(m.soc_e4, 4'350);
    EXPECT_EQ(m.capacity_wh, 8'000);
    EXPECT_FALSE(m.dispatch_active);
    EXPECT_FALSE(m.off_grid);
  }
}

TEST_F(ModbusRtu, SilenceIsATimeout) {
  link_.unit = 7;
  ModbusBattery battery(link_, map_, clock_);
  BatteryMeasurement m;
  EXPECT_EQ(battery.read(m), Status::kTimeout);
}

}  // namespace
}  // namespace bess
