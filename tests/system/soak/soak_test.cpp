// Soak test: the real bess-edge for many control cycles under BESS_SECCOMP=kill, in scaled time,
// with faults: the Modbus connection is cut in every control cycle, every price request is a TLS
// handshake, the name is looked up each time, the price server gives invalid answers now and then,
// and both servers die and return. Afterwards the process must not have grown.
//   BESS_SOAK_CYCLES   length of the long run; tools/soak sets it
//   BESS_SOAK_SCALE    simulated seconds per second; less for a slow machine
#include <gtest/gtest.h>
#include <netdb.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>

#include "tests/support/dated_certificate.h"
#include "tests/support/dropping_proxy.h"
#include "tests/support/simulated_site.h"

namespace bess {
namespace {

namespace fs = std::filesystem;

constexpr int kWarmCycles = 100;

int setting_of(const char* name, int otherwise) {
  const char* text = std::getenv(name);
  return text != nullptr ? std::atoi(text) : otherwise;
}

int long_run_cycles() { return std::max(setting_of("BESS_SOAK_CYCLES", 300), 2 * kWarmCycles); }

/// A resolvable name of this machine, so that names are really looked up.
std::string resolvable_name() {
  char name[256] = "";
  gethostname(name, sizeof name - 1);
  addrinfo hints{};
  hints.ai_family = AF_INET;
  addrinfo* found = nullptr;
  bool is_loopback = false;
  if (getaddrinfo(name, nullptr, &hints, &found) == 0) {
    const auto* address = reinterpret_cast<const sockaddr_in*>(found->ai_addr);
    is_loopback = ntohl(address->sin_addr.s_addr) >> 24 == 127;
    freeaddrinfo(found);
  }
  return is_loopback ? name : "localhost";
}

/// /proc information of a process.
struct Footprint {
  long resident_kib = 0;
  int open_files = 0;
  int threads = 0;
  int seccomp = 0;  ///< 2 = a filter is in force
};

Footprint footprint_of(pid_t pid) {
  Footprint now;
  const fs::path folder = "/proc/" + std::to_string(pid);
  std::ifstream status(folder / "status");
  for (std::string line; std::getline(status, line);) {
    if (line.starts_with("VmRSS:")) now.resident_kib = std::atol(line.c_str() + 6);
    if (line.starts_with("Seccomp:")) now.seccomp = std::atoi(line.c_str() + 8);
    if (line.starts_with("Threads:")) now.threads = std::atoi(line.c_str() + 8);
  }
  std::error_code ignored;
  now.open_files = static_cast<int>(
      std::distance(fs::directory_iterator(folder / "fd", ignored), fs::directory_iterator()));
  return now;
}

struct RunResult {
  int exit_code = -1;
  int cycles = 0;
  int connections = 0;
  Footprint warm, end;
  std::map<std::string, int> price_statuses, modes;
  std::string sealed;  ///< the line about the seal
  std::string complaints;
};

class Soak : public ::testing::Test {
 protected:
  void start_battery(int port) {
    site_.start_battery({"--fault", "drop", "--fault-every", "23"}, port);
  }
  void start_market(int port) {
    site_.start_market({"--tls-cert", ca_.certificate(), "--tls-key", ca_.key(), "--close-each",
                        "--fault", "all", "--fault-every", "5"},
                       prices_, port);
  }
  RunResult run(int cycles);
  void follow(ChildProcess& edge, DroppingProxy& proxy, int cycles, RunResult& result);
  void let_ends_die(int cycle, int cycles);

  SimulatedSite site_{setting_of("BESS_SOAK_SCALE", 2'000)};  // a control cycle is 60 ms
  std::string name_ = resolvable_name();
  DatedCertificate ca_{"DNS:" + name_};
  /// The test's certificate authority among those of a real system.
  std::string bundle_ = site_.folder.write(
      "bundle.pem", text_of_file("/etc/ssl/certs/ca-certificates.crt") + text_of_file(ca_.ca()));
  std::string prices_;
  int battery_port_ = 0;  ///< behind the proxy
};

/// The price server dies for a while in the second quarter, the battery in the third.
void Soak::let_ends_die(int cycle, int cycles) {
  if (cycles < kWarmCycles) return;
  const int quarter = cycles / 4;
  if (cycle == quarter) site_.market.reset();
  if (cycle == quarter + 20) start_market(site_.market_port);
  if (cycle == 2 * quarter) site_.battery.reset();
  if (cycle == 2 * quarter + 20) start_battery(battery_port_);
}

void Soak::follow(ChildProcess& edge, DroppingProxy& proxy, int cycles, RunResult& result) {
  for (std::string line = edge.read_line(); !line.empty(); line = edge.read_line()) {
    if (line.find(" ran sealed") != std::string::npos) result.sealed = line;
    if (line.starts_with("CHECK")) result.complaints += line + "\n";
    if (!line.starts_with("utc=") || line.find("mode=stopping") != std::string::npos) continue;
    ++result.cycles;
    const auto field = [&](const std::string& name) {
      const std::size_t at = line.find(" " + name + "=") + name.size() + 2;
      return line.substr(at, line.find(' ', at) - at);
    };
    ++result.price_statuses[field("prices")];
    ++result.modes[field("mode")];
    proxy.drop();
    let_ends_die(result.cycles, cycles);
    if (result.cycles == kWarmCycles) result.warm = footprint_of(edge.pid());
    if (result.cycles == cycles - 1) result.end = footprint_of(edge.pid());
  }
}

RunResult Soak::run(int cycles) {
  RunResult result;
  // Prices for three times the control cycles: a busy machine skips ticks.
  prices_ = SimulatedSite::minute_prices(6 * cycles, {.amplitude_eur_per_mwh = 600});
  site_.start_clock();
  start_battery(0);
  start_market(0);
  battery_port_ = site_.battery_port;
  DroppingProxy proxy(static_cast<std::uint16_t>(battery_port_));
  site_.battery_port = proxy.port();  // where the edge looks for it
  const std::string config =
      site_.commission({.battery_keys = SimulatedSite::alphaess_keys(200),
                        .price_server = "https://" + name_,
                        .price_keys = "ca_file = \"" + bundle_ +
                                      "\"\ntimeout_ms = 500\nwait_s = 40\nresolve_every_s = 1\n"});
  ChildProcess edge({edge_program(), "--config", config, "--cycles", std::to_string(cycles)});
  follow(edge, proxy, cycles, result);
  result.exit_code = edge.wait();
  result.connections = proxy.connections();
  site_.battery.reset();
  site_.market.reset();
  return result;
}

void expect_clean(const RunResult& result, int cycles) {
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_EQ(result.complaints, "");
  EXPECT_EQ(result.cycles, cycles);
  EXPECT_GE(result.connections, cycles * 9 / 10);     // cut in every control cycle that had one
  EXPECT_GT(result.modes.at("running"), cycles / 3);  // 246 of 300 on a quiet machine
  EXPECT_GE(result.price_statuses.at("not_connected"), 5);  // while the price server was dead
  EXPECT_GE(result.modes.at("safe"), 5);                    // while the battery was
  EXPECT_GT(result.end.resident_kib, 0);
  EXPECT_LT(result.end.resident_kib, 16 * 1'024);
  EXPECT_LE(result.end.resident_kib, result.warm.resident_kib + 1'024);
  EXPECT_EQ(result.end.threads, 3);  // control, log, holds
  EXPECT_EQ(result.end.seccomp, 2);
  EXPECT_NE(result.sealed, "");  // to its end, without an allocator call
}

TEST_F(Soak, NothingGrowsAndNothingIsAskedOfTheKernel) {
  setenv("BESS_SECCOMP", "kill", 1);
  const RunResult warm = run(kWarmCycles);
  const int cycles = long_run_cycles();
  const RunResult soak = run(cycles);
  expect_clean(soak, cycles);
  EXPECT_LE(soak.end.open_files, soak.warm.open_files + 2);  // current sockets
}

}  // namespace
}  // namespace bess
