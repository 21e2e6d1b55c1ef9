// Wire to a silent device, while signals arrive, and its end.
#include "edge/device/battery/modbus_wire.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <signal.h>
#include <stdlib.h>
#include <sys/ioctl.h>
#include <sys/time.h>
#include <unistd.h>

#include "edge/device/battery/modbus_frame.h"
#include "shared/file_descriptor.h"
#include "shared/scaled_clock.h"
#include "tests/support/loopback_socket.h"

namespace bess {
namespace {

int alarms = 0;

/// A signal every millisecond, which interrupts waiting calls.
class Alarms {
 public:
  Alarms() {
    struct sigaction action {};
    action.sa_handler = [](int) { ++alarms; };
    sigaction(SIGALRM, &action, &before_);
    const itimerval each{{0, 1'000}, {0, 1'000}};
    setitimer(ITIMER_REAL, &each, nullptr);
  }
  ~Alarms() {
    const itimerval none{};
    setitimer(ITIMER_REAL, &none, nullptr);
    sigaction(SIGALRM, &before_, nullptr);
  }

 private:
  struct sigaction before_ {};
};

TEST(ModbusWire, ASignalIsNoLostConnection) {
  sockaddr_in address = loopback_address();
  const FileDescriptor listener(bind_socket(address));
  ASSERT_EQ(listen(listener.get(), 1), 0);
  BatteryLinkSettings settings;
  settings.port = ntohs(address.sin_port);
  ModbusWire wire(settings, 1'000);
  ASSERT_EQ(wire.open(), Status::kOk);
  const Alarms each_millisecond;
  ModbusFrame frame;
  alarms = 0;
  EXPECT_EQ(wire.receive(8, clock_ns(CLOCK_MONOTONIC) + 60'000'000, frame), Status::kTimeout);
  EXPECT_GT(alarms, 3);
  EXPECT_EQ(frame.size, 0);
}

/// Else closing the line of an unplugged adapter waits for bytes that it never takes.
TEST(ModbusWire, ClosingASerialLineDiscardsWhatWasNotSent) {
  const FileDescriptor master(posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC));
  ASSERT_TRUE(grantpt(master.get()) == 0 && unlockpt(master.get()) == 0);
  char name[128] = {};
  ASSERT_EQ(ptsname_r(master.get(), name, sizeof name), 0);
  const FileDescriptor kept_open(open(name, O_RDWR | O_NOCTTY | O_CLOEXEC));
  BatteryLinkSettings settings;
  settings.rtu = true;
  settings.device = std::string_view(name);
  ModbusWire wire(settings, 1'000);
  ASSERT_EQ(wire.open(), Status::kOk);
  const int shows_flushes = 1;
  ASSERT_EQ(ioctl(master.get(), TIOCPKT, &shows_flushes), 0);
  wire.close();
  std::uint8_t event = 0;
  pollfd ready{.fd = master.get(), .events = POLLIN | POLLPRI, .revents = 0};
  ASSERT_EQ(poll(&ready, 1, 1'000), 1);
  ASSERT_EQ(read(master.get(), &event, 1), 1);
  EXPECT_NE(event & TIOCPKT_FLUSHWRITE, 0);
}

TEST(ModbusWire, OnlyTheSpeedsOfSerialLines) {
  for (const std::int32_t baud :
       {1'200, 2'400, 4'800, 9'600, 19'200, 38'400, 57'600, 115'200, 230'400}) {
    EXPECT_TRUE(is_serial_speed(baud)) << baud;
    EXPECT_FALSE(is_serial_speed(baud - 1) || is_serial_speed(baud + 1)) << baud;
  }
}

}  // namespace
}  // namespace bess
