#include "edge/program/startup.h"

#include <signal.h>
#include <sys/prctl.h>

#include <cstdio>

#include "edge/control/policy.h"
#include "edge/log/journal.h"
#include "edge/prices/http_secrets.h"
#include "edge/program/level_note.h"
#include "edge/program/threshold_note.h"
#include "edge/program/wishes_note.h"
#include "edge/registers/codec.h"
#include "edge/settings/price_transport.h"
#include "edge/storage/commission_file.h"
#include "edge/storage/hold_file.h"
#include "shared/utc_text.h"

namespace bess {
namespace {

void complain(const std::string& trouble) {
  report(JournalLevel::kError, "battery at %s", trouble.c_str());
}

/// What a command would write, by the battery's own scale factors and limits if it was reached.
void print_registers(const EdgeConfig& config, const ModbusBattery& battery, const char* name,
                     const PowerOrder& order, Command command) {
  std::printf("%-10s", name);
  for (const BlockWrite& write : config.map.sequence(command).writes) {
    RegisterBlock block;
    std::uint16_t address = 0;
    const Status status = battery.preview(write, order, address, block);
    if (status != Status::kOk) {
      std::printf(" (%s)", status == Status::kNotConnected ? "known once the battery is read"
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
  order.power_w = guard.power_w;
  print_registers(config, battery, "charge", order, Command::kCharge);
  order.power_w = 0;
  print_registers(config, battery, "idle", order, Command::kIdle);
  order.power_w = -guard.power_w;
  print_registers(config, battery, "discharge", order, Command::kDischarge);
  print_registers(config, battery, "release", order, Command::kRelease);
}

bool report_price(const EdgeConfig& config, PriceFeed& prices) {
  PriceRow row;
  const Status status = prices.fetch_once(row);
  if (status != Status::kOk) {
    report(JournalLevel::kError, "price from %s: %s",
           loggable_url(config.price.http.url.view()).c_str(), price_status_text(status).data());
    return false;
  }
  std::printf("price      %.2f EUR/MWh of minute %s\n", row.price_centi_eur_per_mwh / 100.0,
              utc_text(row.minute_utc_s).c_str());
  return true;
}

ThresholdNote note_on_thresholds(const EdgeConfig& config) {
  return compare_thresholds(config.control.guard.thresholds, student_thresholds());
}

void warn_of_thresholds(const ThresholdNote& note) {
  report(JournalLevel::kWarning, "note: %s", note.text.c_str());
}

void print_thresholds(const EdgeConfig& config) {
  const ThresholdNote note = note_on_thresholds(config);
  if (!note.agree) return warn_of_thresholds(note);
  std::printf("guard      %s\n", note.text.c_str());
}

void print_transport(const EdgeConfig& config) {
  const TransportNote note = transport_note(config);
  if (!note.is_open) return static_cast<void>(std::printf("transport  %s\n", note.text.c_str()));
  report(JournalLevel::kWarning, "note: %s", note.text.c_str());
}

/// Without the sign check a controller would refuse to start; one that only reads does not need it.
bool report_sign(const EdgeConfig& config) {
  std::string refusal;
  if (is_commissioned(config, refusal)) {
    std::printf("sign       checked by bess-edge commission\n");
    return true;
  }
  const bool is_needed = config.control.control;
  report(is_needed ? JournalLevel::kError : JournalLevel::kWarning, "%s%s",
         is_needed ? "" : "note, before control = true: ", refusal.c_str());
  return !is_needed;
}

/// A clock that nobody sets is a stop reason in every cycle: it should show before the first.
bool report_clock(const EdgeConfig& config, const EdgeClock& clock) {
  if (clock.is_synchronised()) {
    std::printf("clock      %s\n", !config.clock.is_real_time()        ? "simulated"
                                   : config.require_synchronised_clock ? "set by NTP"
                                                                       : "not asked for");
    return true;
  }
  report(config.control.control ? JournalLevel::kError : JournalLevel::kWarning,
         "the clock is not set by NTP: no order will be given before it is; see timedatectl");
  return !config.control.control;
}

}  // namespace

bool check_student() {
  const int failures = count_student_self_check_failures();
  if (failures == 0) return true;
  report(JournalLevel::kError,
         "the built-in student fails %d of its %d self-checks on this machine; build bess-edge for "
         "it again",
         failures, student_self_check_count());
  return false;
}

bool reach_battery(const EdgeConfig& config, ModbusBattery& battery, EdgeClock& clock) {
  std::string trouble;
  const Status status = find_battery(config, battery, clock, trouble);
  if (status == Status::kOk) return true;
  complain(trouble);
  return may_start_without(config, status);
}

void report_commission_losses(const EdgeConfig& config) {
  for (const std::string& line : mend_commission_file(config)) {
    report(JournalLevel::kError, "%s", line.c_str());
  }
}

Recall recall_at_start(const EdgeConfig& config, const EventLog& log,
                       std::uint64_t published_number) {
  const ClearancePaths paths = clearance_paths(config);
  for (const FixedText<639>* path : {&paths.state, &paths.run}) {
    if (!read_cleared(path->c_str()).unreadable) continue;
    report(JournalLevel::kError,
           "%s cannot be understood: a trip that was cleared there counts again", path->c_str());
  }
  Recall recalled = recall(log.ring(), log.run_ring(), published_number, paths);
  if (recalled.unknown.empty()) return recalled;
  const char* const what = recalled.unknown.c_str();
  if (config.state.drive_without_state || recalled.trip.is_set()) {
    report(JournalLevel::kError,
           "state: %s: trip, cycle budget and price level of earlier runs are not known%s", what,
           recalled.trip.is_set() ? "" : "; driving all the same: drive_without_state = true");
    return recalled;
  }
  report(JournalLevel::kError,
         "state: %s: the battery may have tripped and is not driven until bess-edge clear --yes "
         "([state] drive_without_state = true drives it all the same)",
         what);
  recalled.trip = {.reason = Reason::kStateLost,
                   .utc_s = config.clock.now_utc_ns() / kNanosecondsPerSecond};
  return recalled;
}

void journal_thresholds(const EdgeConfig& config) {
  const ThresholdNote note = note_on_thresholds(config);
  if (!note.agree) return warn_of_thresholds(note);
  write_journal_line(JournalLevel::kInfo, "guard: " + note.text);
}

void journal_transport(const EdgeConfig& config) {
  const TransportNote note = transport_note(config);
  if (note.is_open) report(JournalLevel::kWarning, "note: %s", note.text.c_str());
}

bool report_check(const EdgeConfig& config, ModbusBattery& battery, PriceFeed& prices,
                  const EdgeClock& clock) {
  std::printf("student    %s (%d self-checks passed)\n", student_provenance(),
              student_self_check_count());
  std::printf("context    %s\n", context_note(student_context()).c_str());
  std::printf("map        %s%s%s; control = %s\n", config.map.name.c_str(),
              config.map.variant.empty() ? "" : ", variant ", config.map.variant.c_str(),
              config.control.control ? "true" : "false (read-only)");
  std::fflush(stdout);
  print_thresholds(config);
  print_transport(config);
  const std::int64_t now_utc_s = config.clock.now_utc_ns() / kNanosecondsPerSecond;
  const Hold hold = read_newest_hold(hold_paths(config)).hold;
  std::fputs(wishes_note(config.control, hold, now_utc_s).c_str(), stdout);
  std::fflush(stdout);
  std::string trouble;
  const bool battery_ok = identify_battery(config, battery, trouble) == Status::kOk;
  if (!battery_ok) complain(trouble);
  print_orders(config, battery);
  BatteryMeasurement m;
  if (battery_ok && battery.read(m) == Status::kOk) {
    char capacity[32] = "capacity not reported";
    if (m.capacity_wh > 0) std::snprintf(capacity, sizeof capacity, "%d Wh", m.capacity_wh);
    std::printf("battery    %s: SoC %.1f %%, %d W, %s, dispatch %s\n",
                battery_place(config).c_str(), m.soc_e4 / 100.0, m.power_w, capacity,
                m.dispatch_active ? "active" : "off");
  }
  const bool sign_ok = report_sign(config);
  const bool clock_ok = report_clock(config, clock);
  return report_price(config, prices) && battery_ok && sign_ok && clock_ok;
}

void prepare_process() {
  set_market_time_zone();
  signal(SIGPIPE, SIG_IGN);           // whoever reads the log may go away, the battery must not
  prctl(PR_SET_TIMERSLACK, 1'000UL);  // ns; the default 50 us would be seen at high time scales
}

}  // namespace bess
