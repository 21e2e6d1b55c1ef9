// State and health of the controller for people and programs, from its stored status, decision ring
// and lock: `bess-edge status`. Runs as a separate process.
#include <unistd.h>

#include <cstdio>
#include <optional>
#include <sstream>

#include "edge/app/commands/command.h"
#include "edge/app/storage/operator_files.h"
#include "edge/app/storage/published_status.h"
#include "edge/app/storage/storage_health.h"
#include "edge/core/control/tick.h"
#include "edge/core/site/connection_guard.h"
#include "edge/records/log/atomic_file.h"
#include "edge/records/log/health.h"
#include "edge/records/log/log_reader.h"
#include "edge/records/log/log_text.h"
#include "edge/records/why/explanation.h"
#include "edge/records/why/next_decision.h"
#include "shared/host/json.h"
#include "shared/host/text.h"
#include "shared/local_time.h"
#include "shared/training_period.h"
#include "shared/units_and_limits.h"

namespace bess {
namespace {

struct StatusOptions {
  bool json = false;
  bool prometheus = false;
  bool follow = false;
  bool no_lock = false;
};

constexpr const char* kStatusFooter =
    R"(Reads files only; does not disturb battery or controller. While the controller runs, also
prints the next decision at constant price and SoC, planned reserves and full charges, and settings
without effect. Health is ok, degraded (with reasons) or not running. A status older than two
control cycles is WARN, older than four CRITICAL. Old training days, or days of another price
regime, give a note to retrain that does not affect health.
Exit codes:
  0 ok
  1 degraded, or files unreadable
  2 command line error
  3 not running
Examples:
  bess-edge status
  bess-edge status --json | jq .health
  watch -n 60 bess-edge status --config /etc/bess/edge.toml)";

std::string local_of(std::int64_t utc_s) { return local_text(utc_s).c_str(); }
long long as_long(std::int64_t value) { return value; }

constexpr const char* kUpdateFolder = "/var/lib/bess-update";

Health health_of(const EdgeConfig& config, const PublishedStatus& published,
                 const std::string& update_trouble) {
  return assess_health({.is_running = published.holder != 0,
                        .status = published.status ? &*published.status : nullptr,
                        .is_of_this_run = published.is_of_this_run,
                        .age_ms = published.age_ms,
                        .cycles_behind = published.cycles_behind,
                        .wear = storage_wear_of(config.state.folder.c_str()),
                        .disk_is_full = takes_no_file(config.state.folder.c_str()),
                        .unknown = published.unknown,
                        .update_trouble = update_trouble});
}

void print_health(const Health& health, const EdgeConfig& config) {
  std::printf("health     %s\n", health_name(health.level).data());
  for (const HealthAlert& alert : health.alerts) std::printf("           %s\n", alert.line.c_str());
  if (!config.contact.view().empty()) std::printf("call       %s\n", config.contact.c_str());
}

/// The plan on day-ahead prices.
void print_outlook(const CycleRecord& last) {
  const OutlookReport& outlook = last.outlook;
  if (outlook.source == OutlookSource::kNone) return;
  std::printf(
      "outlook    %s, break-even %.2f EUR/MWh, class %d of %d (1 = lowest); day-ahead prices of "
      "the "
      "next %.1f h, last answer %s\n",
      outlook_source_name(outlook.source).data(), eur_of(outlook.break_even_centi),
      last.context_class, kContextClassCount, outlook.known_quarter_hours / 4.0,
      status_name(outlook.feed).data());
}

/// The trailing price level and the student's class, where that is its context.
void print_level(const RunIdentity& identity, const CycleRecord& last) {
  if (identity.context.view() != "level") return;
  const std::int64_t centi_q16 = last.price_level.centi_q16;
  if (last.context_class == 0 && centi_q16 == 0) {  // exactly: no price has set it yet
    std::printf("level      unknown\n");
    return;
  }
  std::printf("level      %.2f EUR/MWh, ", static_cast<double>(centi_q16) / PriceLevel::kQ16PerEur);
  if (last.context_class == 0) {
    std::printf("no student decision\n");
  } else {
    std::printf("class %d of %d (1 = lowest)\n", last.context_class, kContextClassCount);
  }
}

/// Operator's orders: hold with its end, reserve of this hour, full charges.
void print_operator_orders(const CycleRecord& last) {
  if (last.hold.held) {
    std::printf("hold       %d W until %s\n", last.hold.power_w,
                local_of(last.hold.until_utc_s).c_str());
  }
  if (last.reserve_soc_e4 > 0) {
    std::printf("reserve    SoC %.1f %% at this hour\n", last.reserve_soc_e4 / 100.0);
  }
  std::printf("full       %d days since the last full charge\n", last.days_since_full);
}

/// A hold that the last control cycle did not have.
void print_new_hold(const EdgeConfig& config, const CycleRecord& last) {
  const Hold hold = read_newest_hold(state_file_paths(config, kHoldFileName)).hold;
  const bool is_followed = last.hold.held && last.hold.power_w == hold.power_w &&
                           last.hold.until_utc_s == hold.until_utc_s;
  if (is_followed || hold.until_utc_s <= last.utc_s) return;
  std::printf("hold       %d W until %s, from the next control cycle\n", hold.power_w,
              local_of(hold.until_utc_s).c_str());
}

/// Limit of another program that is in force now; a lapsed or malformed one is an alert.
void print_limit(const EdgeConfig& config) {
  if (!config.site.settings.has_outside_limits) return;
  OutsideLimit limit;
  bool is_set = false;
  const Status status = LimitFile{config.site.limit_file.c_str()}.read(limit, is_set);
  const std::int64_t now_utc_s = utc_seconds(config.clock);
  if (status != Status::kOk || !is_set || limit.until_utc_s <= now_utc_s) return;
  const auto power = [](std::int32_t power_w) {
    return power_w == kAnyPowerW ? std::string(kAnyPowerText) : std::to_string(power_w) + " W";
  };
  std::printf("limit      charge %s, discharge %s until %s\n", power(limit.charge_w_max).c_str(),
              power(limit.discharge_w_max).c_str(), local_of(limit.until_utc_s).c_str());
}

/// Prints nothing without a meter.
void print_site(const CycleRecord& last) {
  if (!last.site.has_grid_power) return;
  std::printf(
      "grid       %d W (import is positive), house %lld W, %d Wh imported in this quarter-hour\n",
      last.site.grid_power_w, as_long(house_w_of(last)), last.site.quarter_hour_import_wh);
}

void print_price(const CycleRecord& last) {
  const PriceReport& price = last.price;
  const char* const answer = status_name(price.status).data();
  if (price.has_row) {
    std::printf("price      %.2f EUR/MWh, %d s old at the decision, %s\n",
                eur_of(price.price_centi_eur_per_mwh), last.price_age_s, answer);
  } else {
    std::printf("price      none, %s\n", answer);
  }
  if (price.step_held) {
    std::printf("pending    %.2f EUR/MWh, until the next row confirms it\n",
                eur_of(price.held_centi_eur_per_mwh));
  }
}

void print_last_cycle(const RunStatus& status, bool is_running) {
  const CycleRecord& last = status.totals.last;
  const char* const battery = status_name(last.battery_status).data();
  std::printf("%-10s %s at %s, control cycle %lld\n", is_running ? "state" : "was",
              mode_name(last.mode).data(), local_of(last.utc_s).c_str(), as_long(last.cycle));
  if (last.has_measurement) {
    std::printf("battery    SoC %.1f %%, %d W before this order (charging is positive), %s\n",
                last.measurement.soc_e4 / 100.0, last.measurement.power_w, battery);
  } else {
    std::printf("battery    not measured, %s\n", battery);
  }
  print_price(last);
  print_level(status.identity, last);
  print_outlook(last);
  print_site(last);
  std::printf("order      %d W, reason %s: %s\n", last.ordered_power_w,
              reason_name(last.reason).data(), info_of(last.reason).meaning);
  print_operator_orders(last);
}

void print_counters(const RunTotals& t) {
  std::printf(
      "cycles     %lld control cycles, missed ticks %d, late orders %d, orders written %lld, log "
      "records dropped %lld\n",
      as_long(t.cycles), t.last.missed_ticks, t.last.deadline_misses, as_long(t.written_orders),
      as_long(t.records_dropped));
  std::printf("failures   battery %lld, prices %lld, disk %lld\n", as_long(t.battery_failures),
              as_long(t.price_failures), as_long(t.disk_failures));
  const BatteryCounters& bus = t.last.counters;
  std::printf("modbus     %lld requests, %lld failed, %lld reconnects, %lld register writes\n",
              as_long(bus.requests), as_long(bus.failed_requests), as_long(bus.reconnects),
              as_long(bus.register_writes));
}

/// From the log: decision margins of the newest control cycle, as in `why`, and the last orders.
void print_last_orders(const EdgeConfig& config) {
  constexpr std::uint64_t kOrders = 10;
  LogReader log;
  FileMessage ignored;
  if (!log.open(config.log, ignored)) return;
  const std::uint64_t newest = log.newest_number();
  CycleRecord r;
  Margins margins;
  if (log.read(newest, r) && margins_of(r, config.control.guard.thresholds, margins)) {
    std::printf("margins    at %s: %s EUR/MWh\n", local_clock_text(r.utc_s).c_str(),
                price_margins_text(margins).c_str());
  }
  std::printf("orders     %s\n", kShortLineHead);
  for (std::uint64_t n = newest > kOrders ? newest - kOrders + 1 : 1; n <= newest; ++n) {
    if (!log.read(n, r)) continue;
    char line[kLogLineBytes];
    format_short_line(r, line);
    std::printf("           %s\n", line);
  }
}

/// Next decision, from the newest record; false with an empty log.
bool find_next(const EdgeConfig& config, NextDecision& next) {
  LogReader log;
  FileMessage ignored;
  CycleRecord newest;
  if (!log.open(config.log, ignored) || !log.read(log.newest_number(), newest)) return false;
  const std::int64_t now_utc_s = utc_seconds(config.clock);
  next = find_next_decision(newest, now_utc_s, config.control);
  return true;
}

void print_next(const EdgeConfig& config) {
  NextDecision next;
  if (find_next(config, next)) std::fputs(next_decision_text(next).c_str(), stdout);
  const char* head = "no effect";
  for (const std::string& key : keys_without_effect(config)) {
    std::printf("%-10s %s\n", head, key.c_str());
    head = "";
  }
}

/// The running controller, or the last one and the time of its last record.
void print_controller(const RunStatus& status, bool is_running) {
  const RunIdentity& id = status.identity;
  const CycleRecord& last = status.totals.last;
  const char* const part = id.control ? "in control" : "read-only";
  if (is_running) {
    std::printf("controller %s, process %d since %s", part, id.pid,
                local_of(id.start_utc_s).c_str());
  } else {
    const bool has_cycles = status.totals.cycles > 0;
    const char* ended = "ended before its first control cycle";
    if (has_cycles) ended = "ended abnormally after the control cycle at ";
    if (has_cycles && last.mode == Mode::kStopping) ended = "stopped at ";
    std::printf("controller none; the last one was %s, process %d from %s, %s%s", part, id.pid,
                local_of(id.start_utc_s).c_str(), ended,
                has_cycles ? local_of(last.utc_s).c_str() : "");
  }
  std::printf(", version %s, student %08x\n", id.version.c_str(), id.student_hash);
}

TrainingPeriod training_of(const RunIdentity& id) {
  return {id.trained_from.c_str(), id.trained_until.c_str()};
}

/// Why the student should be retrained, or empty. Does not affect health.
std::string retraining_note(const EdgeConfig& config, const RunIdentity& id) {
  const auto today = local_date_text(utc_seconds(config.clock));
  const auto age = training_age_text(training_of(id), today.view());
  return age.empty() ? "" : formatted("trained until %s: retrain on newer prices", age.c_str());
}

void print_run(const EdgeConfig& config, const RunStatus& status, bool is_running) {
  const RunIdentity& id = status.identity;
  print_controller(status, is_running);
  std::printf("trained    %s\n", training_days_text(training_of(id)).c_str());
  const std::string note = retraining_note(config, id);
  if (!note.empty()) std::printf("           note: %s\n", note.c_str());
  const char* const part = id.control ? "driving" : "reading";
  std::printf("%-10s %s, map %s%s%s\n", is_running ? part : "battery at", id.battery.c_str(),
              id.map.c_str(), id.variant.empty() ? "" : ", variant ", id.variant.c_str());
  if (status.totals.cycles > 0) print_last_cycle(status, is_running);
  if (is_running) print_new_hold(config, status.totals.last);
  if (is_running) print_limit(config);
  if (is_running) print_next(config);
  print_counters(status.totals);
}

void print_text(const EdgeConfig& config, const PublishedStatus& published, const Health& health,
                const std::string& update) {
  print_health(health, config);
  if (!published.unknown.empty()) {
    std::printf("state      unknown: %s\n", published.unknown.c_str());
  } else if (published.status) {
    print_run(config, *published.status, health.level != HealthLevel::kNotRunning);
  }
  if (!update.empty()) std::printf("update     %s\n", update.c_str());
  print_last_orders(config);
}

/// status.json without its checksum.
Json json_of(const RunStatus& status) {
  static char storage[kStatusBytes];
  TextBuffer text(storage);
  format_status_json(status, text);
  return Json::parse(std::string(without_checksum(text.view(), kJsonChecksum)) + "\n}\n");
}

void print_json(const EdgeConfig& config, const PublishedStatus& published, const Health& health,
                const std::string& update) {
  // The status of another run would contradict "unknown".
  const bool is_known = published.unknown.empty() && published.status.has_value();
  Json status = is_known ? json_of(*published.status) : Json::object();
  if (!published.unknown.empty()) status.set("unknown", published.unknown);
  const auto alert_json = [](const HealthAlert& alert) {
    return Json::object({{"code", alert.code}, {"line", alert.line}});
  };
  status.set("health", health_name(health.level));
  status.set("alerts", Json::list_from(health.alerts, alert_json));
  status.set("health_reasons", Json::list_from(health.alerts, &HealthAlert::line));
  if (!config.contact.view().empty()) status.set("contact", config.contact.view());
  if (is_known) status.set("retrain", retraining_note(config, published.status->identity));
  NextDecision next;
  if (health.level != HealthLevel::kNotRunning && find_next(config, next)) {
    status.set("next", next_decision_json(next));
  }
  status.set("no_effect", Json::list_from(keys_without_effect(config)));
  if (!update.empty()) status.set("update", update);
  std::fputs(status.text().c_str(), stdout);
}

/// Decider and mode of the newest control cycle, as labels.
std::string decision_info(const CycleRecord& last) {
  return formatted(
      "# HELP bess_decision_info Reason and mode of the last control cycle.\n"
      "# TYPE bess_decision_info gauge\n"
      "bess_decision_info{reason=\"%s\",mode=\"%s\"} 1\n",
      reason_name(last.reason).data(), mode_name(last.mode).data());
}

/// Prints metrics with the battery's name as a label, to distinguish several controllers.
void print_labelled(const EdgeConfig& config, const std::string& text) {
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    const std::size_t end = line.find_first_of("{ ");
    const bool is_sample = !line.empty() && line[0] != '#' && end != line.npos;
    if (is_sample && line.find("battery=\"") == line.npos) {
      const std::string label = formatted("{battery=\"%s\"", config.battery.name.c_str());
      const bool has_labels = line[end] == '{';
      line.replace(end, has_labels ? 1 : 0, label + (has_labels ? "," : "}"));
    }
    std::printf("%s\n", line.c_str());
  }
}

bool print_metrics(const EdgeConfig& config, const std::optional<RunStatus>& status,
                   bool is_running) {
  if (!status) {
    failed(std::string(config.state.folder.view()) +
           ": no status: start bess-edge with this configuration first");
    return false;
  }
  static char storage[kMetricsBytes];
  TextBuffer text(storage);
  format_prometheus(*status, text);
  std::fwrite(text.view().data(), 1, text.view().size(), stdout);
  if (is_running) print_labelled(config, decision_info(status->totals.last));
  NextDecision next;
  if (is_running && find_next(config, next)) {
    print_labelled(config, next_decision_metrics(next));
  }
  // Installed as a package: metrics of bess-probation and of the fleet's inventory.
  for (const char* file : {"/update.prom", "/expected.prom"}) {
    print_labelled(config, contents_of(std::string(kUpdateFolder) + file));
  }
  return true;
}

/// One line of bess-probation; empty without one.
std::string update_note() {
  const std::string note = contents_of(std::string(kUpdateFolder) + "/note");
  return note.substr(0, note.find('\n'));
}

int print_once(const StatusOptions& options, const EdgeConfig& config) {
  const PublishedStatus published = read_published_status(config, options.no_lock);
  const std::string update = update_note();
  const bool is_trouble = update.starts_with("WARN: ");
  const Health health = health_of(config, published, is_trouble ? update.substr(6) : "");
  if (options.prometheus) {
    const bool is_running = health.level != HealthLevel::kNotRunning;
    if (!print_metrics(config, published.status, is_running)) return 1;
  } else if (options.json) {
    print_json(config, published, health, update);
  } else {
    print_text(config, published, health, update);
  }
  std::fflush(stdout);
  return static_cast<int>(health.level);
}

int run_status(const StatusOptions& options, SettingsFile& settings) {
  set_market_time_zone();
  const EdgeConfig& config = settings.config;
  constexpr const char* kClearScreen = "\033[H\033[2J";
  while (true) {
    if (options.follow && isatty(STDOUT_FILENO) != 0) std::fputs(kClearScreen, stdout);
    const int exit_code = print_once(options, config);
    if (!options.follow) return exit_code;
    sleep(2);
  }
}

}  // namespace

void add_status(EdgeCommand root) {
  EdgeCommand command = root.subcommand("status", "state and health of the running controller");
  const auto options = std::make_shared<StatusOptions>();
  command.flag("--json", options->json, "one JSON object, with \"health\"");
  command
      .flag("--prometheus", options->prometheus,
            "metrics for the textfile collector of the Prometheus node exporter")
      .excludes("--json");
  command.flag("--follow", options->follow, "repeat every two seconds until Ctrl-C");
  command.flag("--no-lock", options->no_lock, "check the process id instead of the lock");
  command.footer(kStatusFooter);
  command.set_action([options](SettingsFile& settings) { return run_status(*options, settings); });
}

}  // namespace bess
