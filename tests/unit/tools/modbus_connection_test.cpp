// Life of a connection: no server, a full queue, a server that closes when idle, a serial adapter
// that is unplugged and returns, too many open files.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <sys/resource.h>
#include <sys/select.h>
#include <termios.h>

#include <filesystem>
#include <thread>
#include <vector>

#include "edge/device/battery/modbus_link.h"
#include "tests/support/loopback_socket.h"
#include "tests/support/temporary_folder.h"
#include "tests/unit/tools/loopback_battery.h"

namespace bess {
namespace {

constexpr RegisterSpan kSoc{.unit = 85, .address = 0x0102, .count = 1};

/// A bare listening socket on a free port of loopback.
class Listener {
 public:
  explicit Listener(int backlog) : fd_(bind_socket(address_)) {
    EXPECT_GE(fd_, 0);
    if (backlog >= 0) start(backlog);
  }
  ~Listener() { ::close(fd_); }
  void start(int backlog) const { EXPECT_EQ(listen(fd_, backlog), 0); }
  [[nodiscard]] int port() const { return ntohs(address_.sin_port); }
  [[nodiscard]] int accept_within(int ms) const {
    pollfd event{.fd = fd_, .events = POLLIN, .revents = 0};
    return poll(&event, 1, ms) == 1 ? accept(fd_, nullptr, nullptr) : -1;
  }
  /// Fills the queue, so that the next connect gets no answer.
  [[nodiscard]] int connect_once() const {
    const int fd = socket(AF_INET, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
    static_cast<void>(connect(fd, reinterpret_cast<const sockaddr*>(&address_), sizeof address_));
    return fd;
  }
  [[nodiscard]] BatteryLinkSettings link(std::int32_t response_timeout_ms) const {
    BatteryLinkSettings settings;
    settings.port = port();
    settings.response_timeout_ms = response_timeout_ms;
    return settings;
  }

 private:
  sockaddr_in address_ = loopback_address();
  int fd_;
};

TEST(ModbusConnection, ADeadBatteryIsRetriedSlowly) {
  const Listener battery(-1);  // the port is in use, without a listener
  ModbusLink link(battery.link(100), {}, ScaledClock{});
  std::uint16_t soc = 0;
  EXPECT_EQ(link.read(kSoc, &soc), Status::kNotConnected);
  battery.start(1);
  EXPECT_EQ(link.read(kSoc, &soc), Status::kNotConnected);  // backing off for a second
  EXPECT_EQ(battery.accept_within(0), -1);
  sleep_until_monotonic(clock_ns(CLOCK_MONOTONIC) + 11 * kNanosecondsPerSecond / 10);
  EXPECT_EQ(link.read(kSoc, &soc), Status::kTimeout);  // tried, connected, and no answer
  const int accepted = battery.accept_within(1'000);
  EXPECT_GE(accepted, 0);
  ::close(accepted);
  EXPECT_EQ(link.counters().requests, 3);
  EXPECT_EQ(link.counters().failed_requests, 3);
}

TEST(ModbusConnection, AFullQueueEndsByTheTimeOutAndIsATimeOut) {
  const Listener battery(0);
  std::vector<int> queued;
  for (int i = 0; i < 4; ++i) queued.push_back(battery.connect_once());
  ModbusLink link(battery.link(200), {}, ScaledClock{});
  std::uint16_t soc = 0;
  const std::int64_t start_ns = clock_ns(CLOCK_MONOTONIC);
  EXPECT_EQ(link.read(kSoc, &soc), Status::kTimeout);
  EXPECT_LT(clock_ns(CLOCK_MONOTONIC) - start_ns, 3 * kNanosecondsPerSecond);
  for (const int fd : queued) ::close(fd);
}

/// Answers one read of one register with 435, then closes.
void answer_once(int fd) {
  std::uint8_t request[12] = {};
  ASSERT_EQ(recv(fd, request, sizeof request, MSG_WAITALL), 12);
  const std::uint8_t reply[] = {request[0], request[1], 0, 0, 0, 5, 85, 3, 2, 435 >> 8, 435 & 0xFF};
  ASSERT_EQ(send(fd, reply, sizeof reply, MSG_NOSIGNAL), ssize_t{sizeof reply});
  ::close(fd);
}

TEST(ModbusConnection, AServerThatClosesWhenIdleCostsNoRequest) {
  const Listener battery(4);
  std::thread server([&] {
    for (int i = 0; i < 3; ++i) answer_once(battery.accept_within(5'000));
  });
  ModbusLink link(battery.link(2'000), {}, ScaledClock{});
  for (int i = 0; i < 3; ++i) {
    std::uint16_t soc = 0;
    EXPECT_EQ(link.read(kSoc, &soc), Status::kOk);
    EXPECT_EQ(soc, 435);
    sleep_until_monotonic(clock_ns(CLOCK_MONOTONIC) + kNanosecondsPerSecond / 10);
  }
  server.join();
  EXPECT_EQ(link.counters().failed_requests, 0);
  EXPECT_EQ(link.counters().reconnects, 2);
}

TEST(ModbusConnection, TheFirstRequestWaitsForTheDevicesConnectDelay) {
  LoopbackBattery loopback("block");
  ModbusLink link(loopback.link(2'000), {.connect_delay_ms = 300}, ScaledClock{});
  std::uint16_t soc = 0;
  const std::int64_t start_ns = clock_ns(CLOCK_MONOTONIC);
  EXPECT_EQ(link.read(kSoc, &soc), Status::kOk);
  EXPECT_GE(clock_ns(CLOCK_MONOTONIC) - start_ns, 300'000'000);
}

TEST(ModbusConnection, ASerialAdapterThatIsPulledAndComesBack) {
  const TemporaryFolder folder;
  const std::string device = folder.file("ttyBattery");
  const auto plug_in = [&](const LoopbackBattery& battery) {
    std::filesystem::remove(device);
    std::filesystem::create_symlink(battery.link().device.c_str(), device);
  };
  std::optional<LoopbackBattery> battery;
  battery.emplace("block", BatteryServerSettings{}, Transport::kRtu);
  plug_in(*battery);
  BatteryLinkSettings settings = battery->link(500);
  ASSERT_TRUE(settings.device.assign(device));
  ModbusLink link(settings, {}, battery->clock);
  std::uint16_t soc = 0;
  ASSERT_EQ(link.read(kSoc, &soc), Status::kOk);
  battery.reset();
  EXPECT_EQ(link.read(kSoc, &soc), Status::kNotConnected);
  EXPECT_EQ(link.read(kSoc, &soc), Status::kNotConnected);  // the name does not resolve
  battery.emplace("block", BatteryServerSettings{}, Transport::kRtu);
  plug_in(*battery);
  sleep_until_monotonic(clock_ns(CLOCK_MONOTONIC) + kNanosecondsPerSecond / 10);  // 100 s
  EXPECT_EQ(link.read(kSoc, &soc), Status::kOk);
  EXPECT_EQ(soc, 500);
  EXPECT_EQ(link.counters().reconnects, 1);
}

/// A pseudo terminal cannot set a parity bit, but stores the parity setting.
TEST(ModbusConnection, TheSerialLineIsSetAsConfigured) {
  LoopbackBattery battery("block", {}, Transport::kRtu);
  BatteryLinkSettings settings = battery.link(2'000);
  settings.baud = 19'200;
  settings.parity = Parity::kOdd;
  settings.stop_bits = 2;
  ModbusLink link(settings, {}, battery.clock);
  std::uint16_t soc = 0;
  EXPECT_EQ(link.read(kSoc, &soc), Status::kOk);
  const int line = open(settings.device.c_str(), O_RDWR | O_NOCTTY | O_CLOEXEC);
  termios state{};
  ASSERT_EQ(tcgetattr(line, &state), 0);
  ::close(line);
  EXPECT_EQ(cfgetospeed(&state), speed_t{B19200});
  EXPECT_NE(state.c_cflag & PARODD, 0U);
  EXPECT_NE(state.c_cflag & CSTOPB, 0U);
}

/// libmodbus' select() would write beyond its set and destroy the stack.
TEST(ModbusConnection, ADescriptorBeyondSelectIsRefused) {
  LoopbackBattery loopback("block");
  rlimit limit{};
  getrlimit(RLIMIT_NOFILE, &limit);
  if (limit.rlim_max < 2 * FD_SETSIZE) GTEST_SKIP() << "no right to open that many files";
  rlimit raised = limit;
  raised.rlim_cur = 2 * FD_SETSIZE;
  ASSERT_EQ(setrlimit(RLIMIT_NOFILE, &raised), 0);
  std::vector<int> open_files;
  while (open_files.empty() || open_files.back() < FD_SETSIZE) {
    open_files.push_back(open("/dev/null", O_RDONLY | O_CLOEXEC));
    ASSERT_GE(open_files.back(), 0);
  }
  ModbusLink link(loopback.link(1'000), {}, loopback.clock);
  std::uint16_t soc = 0;
  EXPECT_EQ(link.read(kSoc, &soc), Status::kNotConnected);
  for (const int fd : open_files) ::close(fd);
  setrlimit(RLIMIT_NOFILE, &limit);
  sleep_until_monotonic(clock_ns(CLOCK_MONOTONIC) + kNanosecondsPerSecond / 100);  // 10 s
  EXPECT_EQ(link.read(kSoc, &soc), Status::kOk);
}

TEST(ModbusConnection, AnExceptionIsAnAnswerAndKeepsTheConnection) {
  LoopbackBattery loopback("block");
  ModbusLink link(loopback.link(1'000), {}, loopback.clock);
  std::uint16_t value = 0;
  EXPECT_EQ(link.read({.unit = 85, .address = 0xF000, .count = 1}, &value), Status::kBusException);
  EXPECT_EQ(link.last_exception(), 2);  // illegal data address
  EXPECT_EQ(link.read(kSoc, &value), Status::kOk);
  EXPECT_EQ(link.last_exception(), 0);
  EXPECT_EQ(link.write(85, 6, 0x0300, &value, 1), Status::kOk);
  EXPECT_EQ(link.counters().requests, 3);
  EXPECT_EQ(link.counters().failed_requests, 1);
  EXPECT_EQ(link.counters().register_writes, 1);
  EXPECT_EQ(link.counters().reconnects, 0);
}

}  // namespace
}  // namespace bess
