#include "edge/app/commands/command.h"

#include <cstdio>
#include <filesystem>
#include <string_view>
#include <system_error>

#include "edge/app/program/find_battery.h"
#include "edge/app/program/startup.h"
#include "edge/app/storage/commission_file.h"
#include "edge/app/storage/instance_lock.h"
#include "edge/app/storage/operator_files.h"
#include "edge/core/control/policy.h"
#include "edge/core/site/meter_check.h"
#include "edge/device/battery/modbus_battery.h"
#include "edge/records/log/journal.h"
#include "shared/host/run_program.h"

namespace bess {

PriceCheck check_prices(const std::string& config_path) {
  constexpr std::int64_t kPatienceS = 180;  // two requests, at most 60 s each
  std::error_code ignored;
  const std::filesystem::path self = std::filesystem::read_symlink("/proc/self/exe", ignored);
  // bess-edge-outlook uses bess-prices-outlook of the same build.
  constexpr std::string_view kEdge = "bess-edge";
  std::string name = self.filename().string();
  const bool is_usual = name.starts_with(kEdge);
  name = "bess-prices" + (is_usual ? name.substr(kEdge.size()) : "");
  const std::string program = (self.parent_path() / name).string();
  const ProgramResult result =
      run_and_capture({program, "--check", "--config", config_path}, kPatienceS);
  // The cause of a failure comes first: the self-test prints one line.
  PriceCheck check{
      .is_well = result.is_well(),
      .lines = result.is_well() ? result.output + result.errors : result.errors + result.output};
  if (!result.trouble.empty()) check.lines += program + ": " + result.trouble + "\n";
  return check;
}

namespace {

/// Registers that a command would write, with the battery's scale factors and limits if read.
void print_registers(const EdgeConfig& config, const ModbusBattery& battery, const char* name,
                     const PowerOrder& order, Command command) {
  std::printf("%-10s", name);
  for (const BlockWrite& write : config.battery.map.sequence(command).writes) {
    RegisterBlock block;
    std::uint16_t address = 0;
    const Status status = battery.preview(write, order, address, block);
    if (status != Status::kOk) {
      std::printf(" (%s)", status == Status::kNotConnected ? "unknown: battery not read"
                                                           : status_name(status).data());
      break;
    }
    std::printf(" 0x%04X:[", address);
    for (int i = 0; i < block.size(); ++i) std::printf(i == 0 ? "%u" : " %u", block[i]);
    std::printf("]");
  }
  std::printf("\n");
}

void print_orders(const EdgeConfig& config, const ModbusBattery& battery) {
  const GuardSettings& guard = config.control.guard;
  PowerOrder order{.soc_min_e4 = guard.soc_min_e4,
                   .soc_max_e4 = guard.soc_max_e4,
                   .duration_s = config.control.order_duration_s};
  if (config.battery.map.sequence(Command::kEnable).writes.size() > 0) {
    print_registers(config, battery, "enable", order, Command::kEnable);
  }
  order.power_w = guard.power_w;
  print_registers(config, battery, "charge", order, Command::kCharge);
  order.power_w = 0;
  print_registers(config, battery, "idle", order, Command::kIdle);
  order.power_w = -guard.power_w;
  print_registers(config, battery, "discharge", order, Command::kDischarge);
  print_registers(config, battery, "release", order, Command::kRelease);
}

/// Training days and expected full cycles: information only, never a failure.
void print_training(const EdgeConfig& config) {
  const TrainingPeriod trained = student_training();
  std::printf("trained    %s\n", training_days_text(trained).c_str());
  const auto age = training_age_text(trained, local_date_text(utc_seconds(config.clock)).view());
  if (!age.empty()) {
    report(JournalLevel::kWarning, "note: trained until %s: retrain on newer prices", age.c_str());
  }
  const int cycles_e2 = student_cycles_per_day_e2();
  if (cycles_e2 < 0)
    return static_cast<void>(std::printf("cycles     full cycles a day unknown\n"));
  std::printf(
      "cycles     expect about %.1f full cycles a day; to limit them, set [battery] "
      "wear_eur_per_mwh or cycles_per_day_max of bess-train and retrain\n",
      cycles_e2 / 100.0);
}

void print_note(const char* head, const SettingsNote& note) {
  if (note.is_warning) return report(JournalLevel::kWarning, "note: %s", note.text.c_str());
  std::printf("%-10s %s\n", head, note.text.c_str());
}

/// A missing sign check prevents control, but not read-only operation.
bool report_sign(const EdgeConfig& config) {
  std::string refusal;
  if (is_commissioned(config, refusal)) {
    std::printf("sign       tested by bess-edge commission\n");
    std::fflush(stdout);
    for (const std::string& line : commission_file_losses(config)) {
      report(JournalLevel::kWarning, "note: %s", line.c_str());
    }
    return true;
  }
  const bool is_needed = config.control.control;
  report(is_needed ? JournalLevel::kError : JournalLevel::kWarning, "%s%s",
         is_needed ? "" : "note: required for control = true: ", refusal.c_str());
  return !is_needed;
}

/// An unsynchronised clock stops control in every cycle.
bool report_clock(const EdgeConfig& config, const EdgeClock& clock) {
  if (clock.is_synchronised()) {
    std::printf("clock      %s\n", !config.clock.is_real_time() ? "simulated" : "set by NTP");
    return true;
  }
  report(config.control.control ? JournalLevel::kError : JournalLevel::kWarning,
         "the clock is not set by NTP, which prevents control: check timedatectl");
  return !config.control.control;
}

bool complain_of_meter(const SiteConfig& site, const char* what) {
  report(JournalLevel::kError, "meter at %s, map %s: %s", link_place(site.link).c_str(),
         site.map.name.c_str(), what);
  return false;
}

bool read_own_map(const SiteConfig& site, ModbusMeter& meter, std::int32_t& grid_power_w) {
  IdentityFailure failure;
  Status status = meter.check_identity(failure);
  if (status == Status::kImplausible) {
    return complain_of_meter(site, identity_text(site.map, failure).c_str());
  }
  if (status == Status::kOk) status = meter.read(grid_power_w);
  return status == Status::kOk || complain_of_meter(site, status_text(status).data());
}

/// Reads the meter once and prints grid and house power. True without a meter, or when it is read.
bool report_site(const EdgeConfig& config, ModbusBattery& battery, ModbusMeter& meter) {
  const SiteConfig& site = config.site;
  if (site.settings.meter == MeterSource::kNone) return true;
  BatteryMeasurement m;
  const bool has_battery = battery.read(m) == Status::kOk;
  std::int32_t grid_power_w = m.grid_power_w;
  if (site.settings.meter == MeterSource::kMap) {
    if (!read_own_map(site, meter, grid_power_w)) return false;
  } else if (!m.has_grid_power) {
    report(JournalLevel::kError,
           "meter: the battery's grid power point cannot be read: check [meter] and the map");
    return false;
  }
  std::printf("meter      grid %d W (import is positive)", grid_power_w);
  if (has_battery) std::printf(", house %d W", grid_power_w - m.power_w);
  std::printf("\n");
  if (!has_battery || is_plausible_house(grid_power_w, m.power_w, site.settings.pv_w_max)) {
    return true;
  }
  report(JournalLevel::kError,
         "meter: house %d W is negative: check the sign of meter and battery, the phase and the "
         "position of the meter; with solar panels, set [meter] pv_w_max",
         grid_power_w - m.power_w);
  return false;
}

/// Optional points that this device lacks: they can report no alarm.
void print_absent(const EdgeConfig& config, const ModbusBattery& battery) {
  std::string names;
  for (const std::int8_t point : config.battery.map.measure) {
    if (!battery.live().absent[point]) continue;
    names.append(names.empty() ? "" : ", ").append(config.battery.map.points[point].name.view());
  }
  if (!names.empty()) std::printf("absent     %s\n", names.c_str());
}

/// Prints settings, encoded orders, battery reading and newest price; true without an error.
bool report_check(const EdgeConfig& config, ModbusBattery& battery, const std::string& path,
                  const EdgeClock& clock) {
  std::printf("student    %s (%d self-checks passed)\n", student_provenance(),
              student_self_check_count());
  print_training(config);
  std::printf("context    %s\n", context_note(student_context()).c_str());
  std::printf("map        %s%s%s; control = %s\n", config.battery.map.name.c_str(),
              config.battery.map.variant.empty() ? "" : ", variant ",
              config.battery.map.variant.c_str(),
              config.control.control ? "true" : "false (read-only)");
  std::fflush(stdout);
  for (const RetiredKey& old : config.retired) {
    report(JournalLevel::kWarning, "note: %s", retired_key_text(old).c_str());
  }
  print_note("guard", compare_thresholds(config.control.guard.thresholds, student_thresholds()));
  print_note("transport", transport_note(config.price));
  const std::int64_t now_utc_s = utc_seconds(config.clock);
  const Hold hold = read_newest_hold(state_file_paths(config, kHoldFileName)).hold;
  std::fputs(operator_note(config.control, hold, now_utc_s).c_str(), stdout);
  std::fflush(stdout);
  const BatterySearch found = identify_battery(config, battery);
  const bool battery_ok = found.status == Status::kOk;
  if (!battery_ok) report(JournalLevel::kError, "battery at %s", found.trouble.c_str());
  print_orders(config, battery);
  BatteryMeasurement m;
  if (battery_ok && battery.read(m) == Status::kOk) {
    char capacity[32] = "capacity not reported";
    if (m.capacity_wh > 0) std::snprintf(capacity, sizeof capacity, "%d Wh", m.capacity_wh);
    std::printf("battery    %s: SoC %.1f %%, %d W, %s, dispatch %s\n",
                battery_place(config.battery).c_str(), m.soc_e4 / 100.0, m.power_w, capacity,
                m.dispatch_active ? "active" : "off");
  }
  print_absent(config, battery);
  const int twin = lock_owner_pid(name_lock_path(config).c_str());
  if (twin > 0) {
    report(JournalLevel::kError,
           "another controller (process %d) uses [battery] name %s: change one of the names", twin,
           config.battery.name.c_str());
  }
  const bool sign_ok = report_sign(config);
  const bool clock_ok = report_clock(config, clock);
  const PriceCheck prices = check_prices(path);
  std::fputs(prices.lines.c_str(), prices.is_well ? stdout : stderr);
  return prices.is_well && battery_ok && sign_ok && clock_ok && twin <= 0;
}

}  // namespace

int run_check(const EdgeConfig& config, const std::string& path) {
  DeviceSession session;
  if (!session.begin(config)) return 1;
  ModbusBattery battery(config.battery.link, config.battery.map, config.clock);
  ModbusMeter meter(config.site.link, config.site.map, config.clock);
  const bool is_well = report_check(config, battery, path, *session.clock);
  const bool is_accepted = report_site(config, battery, meter) && is_well;
  std::printf("result     %s\n", is_accepted
                                     ? "accepted: no error found"
                                     : "refused: correct the errors above, then check again");
  return is_accepted ? 0 : 1;
}

}  // namespace bess
