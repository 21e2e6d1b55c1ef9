// Self-test of machine and site for the controller: `bess-edge --self-test`.
#include "edge/app/commands/command.h"

#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <fstream>
#include <string>

#include "edge/app/program/edge_clock.h"
#include "edge/app/program/startup.h"
#include "edge/app/storage/instance_lock.h"
#include "edge/app/storage/storage_health.h"
#include "edge/core/control/policy.h"
#include "edge/core/memory/heap_seal.h"
#include "edge/device/battery/modbus_battery.h"
#include "shared/host/text.h"
#include "shared/utc_text.h"

namespace bess {
namespace {

enum class Verdict { kOk, kNote, kFail };

/// Prints each finding immediately, so that a hanging part is visible.
class Table {
 public:
  void add(const char* part, Verdict verdict, const std::string& finding) {
    constexpr const char* kVerdicts[] = {"ok", "note", "FAIL"};
    std::printf("%-10s %-5s %s\n", part, kVerdicts[static_cast<int>(verdict)], finding.c_str());
    std::fflush(stdout);
    failures_ += verdict == Verdict::kFail ? 1 : 0;
  }
  void add(const char* part, bool is_ok, const std::string& finding) {
    add(part, is_ok ? Verdict::kOk : Verdict::kFail, finding);
  }
  [[nodiscard]] int failures() const { return failures_; }

 private:
  int failures_ = 0;
};

void test_student(Table& table) {
  set_market_time_zone();  // one check plans local days
  const int wrong = count_student_self_check_failures();
  table.add("student", wrong == 0,
            formatted("%d of %d self-check vectors match; %s", student_self_check_count() - wrong,
                      student_self_check_count(), student_provenance()));
}

void test_signature(Table& table) {
  const std::string found = decision_signature_line();
  const std::string expected = expected_signature();
  if (expected.empty()) {
    return table.add("signature", Verdict::kNote, found + "; this build has no expected signature");
  }
  table.add("signature", found == expected,
            found == expected ? found : found + "; expected " + expected);
}

#ifndef BESS_SANITIZED
/// In a child process, because a seal is permanent.
enum class SealExit : int { kHeld, kNoSeccomp, kMemoryGiven, kProcessGiven };

[[noreturn]] void try_seal_and_exit() {
  if (install_seccomp_filter(ForbiddenCall::kFails) != 0)
    _exit(static_cast<int>(SealExit::kNoSeccomp));
  void* const memory = mmap(nullptr, 4'096, PROT_READ, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (memory != MAP_FAILED) _exit(static_cast<int>(SealExit::kMemoryGiven));
  const pid_t child = fork();
  if (child == 0) _exit(0);
  _exit(static_cast<int>(child > 0 ? SealExit::kProcessGiven : SealExit::kHeld));
}
#endif

void test_seal(Table& table) {
#ifdef BESS_SANITIZED
  table.add("seal", Verdict::kNote, "sanitizer build, not sealed");
#else
  const pid_t child = fork();
  if (child == 0) try_seal_and_exit();
  int status = 0;
  if (child < 0 || waitpid(child, &status, 0) != child || !WIFEXITED(status)) {
    return table.add("seal", false, "the process of the seal test did not start, or crashed");
  }
  switch (static_cast<SealExit>(WEXITSTATUS(status))) {
    case SealExit::kHeld:
      return table.add("seal", true, "the sealed process gets no memory and no child process");
    case SealExit::kNoSeccomp:
      return table.add("seal", Verdict::kNote,
                       "this kernel has no seccomp: the controller runs without its filter");
    case SealExit::kMemoryGiven:
      return table.add("seal", false, "heap seal failed: memory was still granted");
    case SealExit::kProcessGiven:
      break;
  }
  table.add("seal", false, "heap seal failed: a process was still created");
#endif
}

void test_clock(const EdgeConfig& config, const EdgeClock& clock, Table& table) {
  const std::string now = utc_text(utc_seconds(config.clock)).c_str();
  if (!config.clock.is_real_time()) return table.add("clock", Verdict::kNote, now + ", simulated");
  const bool is_set = clock.is_synchronised();
  table.add("clock", is_set,
            now + (is_set ? ", set by NTP" : ", not set by NTP: check timedatectl"));
}

void test_network(const std::string& config_path, Table& table) {
  const PriceCheck prices = check_prices(config_path);
  std::string line = prices.lines.substr(0, prices.lines.find('\n'));
  table.add("network", prices.is_well, line);
}

void test_ca_file(const EdgeConfig& config, Table& table) {
  const std::string path = config.price.feed.http.ca_file.c_str();
  if (!config.price.feed.http.url.view().starts_with("https")) {
    return table.add("ca_file", Verdict::kNote, "not needed: prices come over plain HTTP");
  }
  std::ifstream file(path);
  int certificates = 0;
  for (std::string line; std::getline(file, line);) {
    certificates += line.starts_with("-----BEGIN CERTIFICATE-----") ? 1 : 0;
  }
  table.add("ca_file", certificates > 0,
            path + ": " +
                (certificates > 0 ? std::to_string(certificates) + " certificates"
                                  : "no certificate: install ca-certificates, or correct "
                                    "[price] ca_file"));
}

void test_storage(const EdgeConfig& config, Table& table) {
  constexpr double kFreeMbMin = 20;  // log of 35 days, current and previous package
  const StorageHealth disk = check_storage(config.state.folder.c_str());
  const std::string folder = config.state.folder.c_str();
  if (!disk.is_writable) return table.add("storage", false, folder + ": " + disk.error);
  const int used_life_percent = disk.wear.used_life_percent;
  const std::string wear =
      used_life_percent > 0 ? "up to " + std::to_string(used_life_percent) + " % of its life used"
                            : "wear not reported";
  const bool is_worn = used_life_percent > kUsedLifePercentMax || disk.wear.spare_level >= 2;
  table.add("storage", disk.free_mb >= kFreeMbMin && !is_worn,
            formatted("%s: %.0f MB free, 4 KiB written in %.1f ms, %s", folder.c_str(),
                      disk.free_mb, disk.synced_write_ms, wear.c_str()));
}

/// Reads identity and measurements; writes nothing.
void test_battery(const EdgeConfig& config, EdgeClock& clock, Table& table) {
  const std::string place = battery_place(config.battery).c_str();
  RunLocks locks;
  FileMessage in_use;
  if (!lock_battery(config, locks, in_use))
    return table.add("battery", Verdict::kNote, in_use.c_str());
  ModbusBattery battery(config.battery.link, config.battery.map, config.clock);
  BatteryMeasurement m;
  const BatterySearch found = find_battery(config, battery, clock);
  if (found.status != Status::kOk) return table.add("battery", false, found.trouble);
  if (const Status status = battery.read(m); status != Status::kOk) {
    return table.add("battery", false, place + ": " + std::string(status_text(status)));
  }
  table.add("battery", true,
            formatted("%s, map %s: SoC %.1f %%, %d W", place.c_str(),
                      config.battery.map.name.c_str(), m.soc_e4 / 100.0, m.power_w));
}

}  // namespace

int run_self_test(const EdgeConfig& config, const std::string& config_path) {
  Table table;
  test_student(table);
  test_signature(table);
  test_seal(table);  // forks, so before any thread
  prepare_process();
  EdgeClock clock(config.clock);
  test_clock(config, clock, table);
  test_ca_file(config, table);
  test_network(config_path, table);
  test_storage(config, table);
  test_battery(config, clock, table);
  std::printf("self-test  %s\n", table.failures() == 0
                                     ? "passed"
                                     : formatted("%d part(s) failed", table.failures()).c_str());
  return table.failures() == 0 ? 0 : 1;
}

}  // namespace bess
