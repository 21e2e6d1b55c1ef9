// `bess-edge status`: another process that reads what the controller publishes (status.json, the
// decision ring, the lock) and says how it is, to a person or to a program.
#include <unistd.h>

#include <cstdio>
#include <sstream>

#include "edge/commands/command.h"
#include "edge/log/health.h"
#include "edge/log/journal.h"
#include "edge/log/log_reader.h"
#include "edge/settings/idle_keys.h"
#include "edge/storage/published_status.h"
#include "edge/storage/storage_health.h"
#include "edge/why/explanation.h"
#include "edge/why/next_decision.h"
#include "shared/host/json.h"
#include "shared/host/text.h"
#include "shared/local_text.h"
#include "shared/training_period.h"
#include "shared/units_and_limits.h"
#include "shared/utc_text.h"

namespace bess {
namespace {

struct StatusGiven {
  bool json = false;
  bool prometheus = false;
  bool follow = false;
  bool no_lock = false;
};

constexpr const char* kFooter =
    R"(Touches neither battery nor controller. While it runs also: the next decision if price and
SoC stay, reserves and full charges of the plan, and settings that have no effect. Health is ok,
degraded (with the reasons) or not running. A status older than two cycles is a WARN, older than
four CRITICAL. Training days that are old or of another price regime are a WARN to retrain, and do
not affect health.
Exit codes:
  0 ok
  1 degraded, or the files cannot be read
  2 the command line is wrong
  3 not running
Examples:
  bess-edge status
  bess-edge status --json | jq .health
  watch -n 60 bess-edge status --config /etc/bess/edge.toml)";

using R = CycleRecord;
using B = BatteryMeasurement;
using P = PriceReport;
using C = BatteryCounters;
using L = PriceLevel;
using S = SiteReport;
using F = ResponseFindings;
using K = OutlookReport;
using M = MeterTrust;
using T = RunTotals;
using H = HoldReport;

const char* text_of(JsonValue found) { return found.text_or("none"); }

/// Of a moment in UTC, the wall clock of the market's zone.
std::string local_of(JsonValue found) {
  std::int64_t utc_s = 0;
  return parse_utc(text_of(found), utc_s) ? local_text(utc_s).c_str() : "none";
}

bool has_outlook(JsonValue s) {
  return std::string_view(text_of(field<&R::outlook, &K::source>(s))) != "none";
}

bool is_true(JsonValue found) { return found.boolean().value_or(false); }

constexpr const char* kUpdateFolder = "/var/lib/bess-update";

/// Of a number as records have it: 1 + index, 0 = none.
std::string_view point_name(const EdgeConfig& config, long long number) {
  const auto& points = config.battery.map.points;
  if (number <= 0 || number > points.size()) return {};
  return points[static_cast<int>(number) - 1].name.view();
}

Health health_of(const EdgeConfig& config, const PublishedStatus& published,
                 const std::string& update_trouble) {
  const JsonValue status = published.status.value();
  HealthInputs in;
  in.is_running = published.holder != 0;
  in.disk_is_full = takes_no_file(config.state.folder.c_str());
  const CardWear wear = card_wear_of(config.state.folder.c_str());
  if (wear.used_life_percent > kUsedLifePercentMax) {
    in.disk_used_life_percent = wear.used_life_percent;
  }
  in.disk_spare_level = wear.spare_level;
  in.file_system_errors = wear.file_system_errors;
  in.update_trouble = update_trouble;
  in.unknown = published.unknown;
  if (!status.exists()) return assess_health(in);
  in.is_of_this_run = published.is_of_this_run;
  in.age_ms = published.age_ms;
  in.cadence_ms = whole(status["cadence_ms"]);
  in.cycles = whole(field<&T::cycles>(status));
  in.mode = text_of(field<&R::mode>(status));
  in.reason = text_of(field<&R::reason>(status));
  in.battery_status = text_of(field<&R::battery_status>(status));
  in.price_status = text_of(field<&R::price, &P::status>(status));
  in.meter_status = text_of(field<&R::site, &S::meter_status>(status));
  in.meter_is_mismatch = is_true(field<&R::site, &S::trust, &M::is_mismatch>(status));
  in.house_is_implausible = is_true(field<&R::site, &S::house_is_implausible>(status));
  in.house_w = whole(field<&R::site, &S::grid_power_w>(status)) -
               whole(field<&R::measurement, &B::power_w>(status));
  in.limit_status = text_of(field<&R::site, &S::limit_status>(status));
  in.lost_reading = point_name(config, whole(field<&R::measurement, &B::lost_point>(status)));
  in.cut_reading = point_name(config, whole(field<&R::measurement, &B::cut_point>(status)));
  in.unanswered_orders = whole(field<&R::unanswered_orders>(status));
  in.weak_answers = whole(field<&R::weak_answers>(status));
  in.lost_orders = whole(field<&R::lost_orders, &LostOrderHistory::lost>(status));
  in.orders_are_lost = is_true(field<&R::lost_orders, &LostOrderHistory::is_found>(status));
  in.judged_orders = whole(field<&R::lost_orders, &LostOrderHistory::judged>(status));
  in.energy_share_percent = whole(field<&R::findings, &F::energy_share_percent>(status));
  in.rest_loss_w = whole(field<&R::findings, &F::rest_loss_w>(status));
  in.ramp_w_per_s = whole(field<&R::findings, &F::ramp_w_per_s>(status));
  in.locked_readings = whole(field<&R::findings, &F::locked_readings>(status));
  in.wrong_energy_e6 = whole(field<&R::findings, &F::wrong_energy_e6>(status));
  in.trip = text_of(field<&R::trip, &Trip::reason>(status));
  in.battery_warns = is_true(field<&R::measurement, &B::warning>(status));
  in.disk_is_slow = is_true(field<&T::disk_is_slow>(status));
  in.disk_is_failing = is_true(field<&T::disk_is_failing>(status));
  in.run_folder_is_failing = is_true(field<&T::run_folder_is_failing>(status));
  in.price_step_held = is_true(field<&R::price, &P::step_held>(status));
  in.held_eur_per_mwh = number(field<&R::price, &P::held_centi_eur_per_mwh>(status)) / kCentiPerEur;
  in.has_price = is_true(field<&R::price, &P::has_row>(status));
  in.price_eur_per_mwh =
      number(field<&R::price, &P::price_centi_eur_per_mwh>(status)) / kCentiPerEur;
  in.price_frozen = is_true(field<&R::price_frozen>(status));
  in.price_unchanged_s = whole(field<&R::standing_price, &StandingPrice::unchanged_s>(status));
  if (has_outlook(status)) {
    std::int64_t cycle_utc_s = 0;
    std::int64_t planned_utc_s = 0;
    if (parse_utc(text_of(field<&R::utc_s>(status)), cycle_utc_s) &&
        parse_utc(text_of(field<&R::outlook, &K::planned_utc_s>(status)), planned_utc_s)) {
      in.unplanned_s = cycle_utc_s - planned_utc_s;
    }
    in.day_ahead_status = text_of(field<&R::outlook, &K::feed>(status));
  }
  in.hold_is_unreadable = is_true(field<&R::hold, &H::unreadable>(status));
  in.cycles_behind = published.cycles_behind;
  return assess_health(in);
}

void print_health(const Health& health, const EdgeConfig& config) {
  std::printf("health     %s\n", health_name(health.level).data());
  for (const std::string& reason : health.reasons) std::printf("           %s\n", reason.c_str());
  if (!config.contact.view().empty()) std::printf("call       %s\n", config.contact.c_str());
}

/// The same of a plan on day-ahead prices.
void print_outlook(JsonValue s) {
  if (!has_outlook(s)) return;
  std::printf(
      "outlook    %s, break-even %.2f EUR/MWh, class %lld of %d; day-ahead prices of the "
      "next %.1f h, last answer %s\n",
      text_of(field<&R::outlook, &K::source>(s)),
      number(field<&R::outlook, &K::break_even_centi>(s)) / kCentiPerEur,
      whole(field<&R::context_class>(s)), kContextClassCount,
      number(field<&R::outlook, &K::known_quarter_hours>(s)) / 4,
      text_of(field<&R::outlook, &K::feed>(s)));
}

/// What the student is given besides clock, SoC and price, where that is the trailing level.
void print_level(JsonValue s) {
  if (std::string_view(text_of(s["context"])) != "level") return;
  const double level = number(field<&R::price_level, &L::centi_q16>(s)) / L::kQ16PerEur;
  const long long context_class = whole(field<&R::context_class>(s));
  if (context_class == 0 && level == 0) {  // exactly: no price has set it yet
    std::printf("level      not known\n");
    return;
  }
  std::printf("level      %.2f EUR/MWh, ", level);
  if (context_class == 0) {
    std::printf("the student was not asked\n");
  } else {
    std::printf("class %lld of %d\n", context_class, kContextClassCount);
  }
}

/// What people asked for: a hold with its end, the reserve of this hour, full charges.
void print_operator_orders(JsonValue s) {
  if (is_true(field<&R::hold, &H::held>(s))) {
    std::printf("hold       %lld W until %s\n", whole(field<&R::hold, &H::power_w>(s)),
                local_of(field<&R::hold, &H::until_utc_s>(s)).c_str());
  }
  const double reserve_e4 = number(field<&R::reserve_soc_e4>(s));
  if (reserve_e4 > 0) std::printf("reserve    SoC %.1f %% at this hour\n", reserve_e4 / 100);
  std::printf("full       %lld days since the last full charge\n",
              whole(field<&R::days_since_full>(s)));
}

/// Nothing where there is no meter.
void print_site(JsonValue s) {
  if (!is_true(field<&R::site, &S::has_grid_power>(s))) return;
  const double grid_w = number(field<&R::site, &S::grid_power_w>(s));
  std::printf(
      "grid       %.0f W (import is positive), house %.0f W, %lld Wh imported in this "
      "quarter-hour\n",
      grid_w, grid_w - number(field<&R::measurement, &B::power_w>(s)),
      whole(field<&R::site, &S::quarter_hour_import_wh>(s)));
}

void print_last_cycle(JsonValue s, bool is_running) {
  std::printf("%-10s %s at %s, cycle %lld\n", is_running ? "state" : "was",
              text_of(field<&R::mode>(s)), local_of(field<&R::utc_s>(s)).c_str(),
              whole(field<&R::cycle>(s)));
  if (is_true(field<&R::has_measurement>(s))) {
    std::printf("battery    SoC %.1f %%, %.0f W before this order (charging is positive), %s\n",
                number(field<&R::measurement, &B::soc_e4>(s)) / 100,
                number(field<&R::measurement, &B::power_w>(s)),
                text_of(field<&R::battery_status>(s)));
  } else {
    std::printf("battery    not measured, %s\n", text_of(field<&R::battery_status>(s)));
  }
  if (is_true(field<&R::price, &P::has_row>(s))) {
    std::printf("price      %.2f EUR/MWh, %.0f s old at the decision, %s\n",
                number(field<&R::price, &P::price_centi_eur_per_mwh>(s)) / 100,
                number(field<&R::price_age_s>(s)), text_of(field<&R::price, &P::status>(s)));
  } else {
    std::printf("price      none, %s\n", text_of(field<&R::price, &P::status>(s)));
  }
  if (is_true(field<&R::price, &P::step_held>(s))) {
    std::printf("held       %.2f EUR/MWh, until the next row confirms it\n",
                number(field<&R::price, &P::held_centi_eur_per_mwh>(s)) / kCentiPerEur);
  }
  print_level(s);
  print_outlook(s);
  print_site(s);
  std::printf("order      %.0f W, reason %s\n", number(field<&R::ordered_power_w>(s)),
              text_of(field<&R::reason>(s)));
  print_operator_orders(s);
}

void print_counters(JsonValue s) {
  std::printf(
      "cycles     %lld, missed ticks %lld, late orders %lld, orders written %lld, log records "
      "dropped %lld\n",
      whole(field<&T::cycles>(s)), whole(field<&R::missed_ticks>(s)),
      whole(field<&R::deadline_misses>(s)), whole(field<&T::written_orders>(s)),
      whole(field<&T::records_dropped>(s)));
  std::printf("failures   battery %lld, prices %lld, disk %lld\n",
              whole(field<&T::battery_failures>(s)), whole(field<&T::price_failures>(s)),
              whole(field<&T::disk_failures>(s)));
  std::printf("modbus     %lld requests, %lld failed, %lld reconnects, %lld register writes\n",
              whole(field<&R::counters, &C::requests>(s)),
              whole(field<&R::counters, &C::failed_requests>(s)),
              whole(field<&R::counters, &C::reconnects>(s)),
              whole(field<&R::counters, &C::register_writes>(s)));
}

/// Of the log: where the newest decision would have been another, as `why` has it, and orders.
void print_last_orders(const EdgeConfig& config) {
  constexpr std::uint64_t kOrders = 10;
  LogReader log;
  FileMessage ignored;
  if (!log.open(config.log, ignored)) return;
  const std::uint64_t newest = log.newest_number();
  CycleRecord r;
  Margins margins;
  if (log.read(newest, r) && margins_of(r, config.control.guard.thresholds, margins)) {
    std::printf("margins    at %s it %s EUR/MWh\n", local_clock_text(r.utc_s).c_str(),
                price_margins_text(margins).c_str());
  }
  std::printf("orders     local time        ordered W  price EUR/MWh   SoC %%  reason\n");
  for (std::uint64_t n = newest > kOrders ? newest - kOrders + 1 : 1; n <= newest; ++n) {
    if (!log.read(n, r)) continue;
    std::printf("           %s  %10d  %13.2f  %6.1f  %s%s\n", local_text(r.utc_s).c_str(),
                r.ordered_power_w, r.price.price_centi_eur_per_mwh / 100.0,
                r.measurement.soc_e4 / 100.0, reason_name(r.reason).data(),
                r.written ? "" : " (not written)");
  }
}

/// What comes next, from the newest record; false where the log has none.
bool find_next(const EdgeConfig& config, NextDecision& next) {
  LogReader log;
  FileMessage ignored;
  CycleRecord newest;
  if (!log.open(config.log, ignored) || !log.read(log.newest_number(), newest)) return false;
  const std::int64_t now_utc_s = config.clock.now_utc_ns() / kNanosecondsPerSecond;
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

/// Who decides; of one that has ended, what it was and when its last record was made.
void print_controller(JsonValue s, bool is_running) {
  const char* const part = is_true(s["control"]) ? "in control" : "read-only";
  if (is_running) {
    std::printf("controller %s, process %lld since %s", part, whole(s["pid"]),
                local_of(s["start_utc"]).c_str());
  } else {
    const bool has_stopped = std::string_view(text_of(field<&R::mode>(s))) == "stopping";
    const bool has_cycles = whole(field<&T::cycles>(s)) > 0;
    std::printf("controller none; the last one was %s, process %lld from %s, %s %s", part,
                whole(s["pid"]), local_of(s["start_utc"]).c_str(),
                !has_cycles   ? "ended before a cycle had"
                : has_stopped ? "stopped at"
                              : "ended without a stop after the cycle of",
                has_cycles ? local_of(field<&R::utc_s>(s)).c_str() : "ended");
  }
  std::printf(", version %s, student %s\n", text_of(s["version"]), text_of(s["student"]));
}

TrainingPeriod training_of(JsonValue s) {
  return {s["trained_from"].text_or(""), s["trained_until"].text_or("")};
}

/// Why the student should be retrained, or empty: no matter of health, for it decides as it did.
std::string retraining_note(const EdgeConfig& config, JsonValue s) {
  const auto today = local_date_text(config.clock.now_utc_ns() / kNanosecondsPerSecond);
  const auto age = training_age_text(training_of(s), today.view());
  return age.empty() ? "" : formatted("trained until %s: retrain on newer prices", age.c_str());
}

void print_text(const EdgeConfig& config, const PublishedStatus& published, const Health& health,
                const std::string& update) {
  const JsonValue status = published.status.value();
  print_health(health, config);
  if (!published.unknown.empty()) {
    std::printf("state      unknown: %s\n", published.unknown.c_str());
  } else if (status.exists()) {
    const bool is_running = health.level != HealthLevel::kNotRunning;
    print_controller(status, is_running);
    std::printf("trained    %s\n", training_days_text(training_of(status)).c_str());
    const std::string note = retraining_note(config, status);
    if (!note.empty()) std::printf("           WARN: %s\n", note.c_str());
    const char* const variant = text_of(status["variant"]);
    const char* const part = is_true(status["control"]) ? "driving" : "reading";
    std::printf("%-10s %s, map %s%s%s\n", is_running ? part : "battery at",
                text_of(status["battery"]), text_of(status["map"]),
                *variant == '\0' ? "" : ", variant ", variant);
    if (whole(field<&T::cycles>(status)) > 0) print_last_cycle(status, is_running);
    if (is_running) print_next(config);
    print_counters(status);
  }
  if (!update.empty()) std::printf("update     %s\n", update.c_str());
  print_last_orders(config);
}

void print_json(const EdgeConfig& config, PublishedStatus published, const Health& health,
                const std::string& update) {
  // What is of another run would say the opposite of "unknown".
  const bool is_known = published.unknown.empty() && published.status.value().is_object();
  Json status = is_known ? std::move(published.status) : Json::object();
  if (!published.unknown.empty()) status.set("unknown", published.unknown);
  Json reasons = Json::list();
  for (const std::string& reason : health.reasons) reasons.add(reason);
  status.set("health", health_name(health.level));
  status.set("health_reasons", std::move(reasons));
  if (!config.contact.view().empty()) status.set("contact", config.contact.view());
  if (is_known) status.set("retrain", retraining_note(config, status.value()));
  NextDecision next;
  if (health.level != HealthLevel::kNotRunning && find_next(config, next)) {
    status.set("next", next_decision_json(next));
  }
  Json no_effect = Json::list();
  for (const std::string& key : keys_without_effect(config)) no_effect.add(key);
  status.set("no_effect", std::move(no_effect));
  if (!update.empty()) status.set("update", update);
  std::fputs(status.text().c_str(), stdout);
}

/// Why the newest cycle was decided as it was, as labels.
std::string decision_info(JsonValue status) {
  return formatted(
      "# HELP bess_decision_info Who decided the last cycle, and in which mode.\n"
      "# TYPE bess_decision_info gauge\n"
      "bess_decision_info{reason=\"%s\",mode=\"%s\"} 1\n",
      text_of(field<&R::reason>(status)), text_of(field<&R::mode>(status)));
}

/// Prints metrics, each with the battery's name: several controllers may be scraped at one place.
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

bool print_metrics(const EdgeConfig& config, JsonValue status, bool is_running) {
  std::string text;
  if (!read_published_metrics(config, text)) {
    report(JournalLevel::kError,
           "%s: no metrics here that can be believed; has bess-edge run with this configuration?",
           config.log.metrics.c_str());
    return false;
  }
  std::fputs(text.c_str(), stdout);
  NextDecision next;
  if (is_running && status.exists()) print_labelled(config, decision_info(status));
  if (is_running && find_next(config, next)) {
    print_labelled(config, next_decision_metrics(next));
  }
  // Where this is a package: what bess-probation says, and what a fleet's inventory expects here.
  for (const char* file : {"/update.prom", "/expected.prom"}) {
    std::string more;
    if (read_text((std::string(kUpdateFolder) + file).c_str(), more)) {
      print_labelled(config, more);
    }
  }
  return true;
}

/// What bess-probation has to tell, one line; empty: nothing, or this is no package.
std::string update_note() {
  std::string note;
  read_text((std::string(kUpdateFolder) + "/note").c_str(), note);
  return note.substr(0, note.find('\n'));
}

int print_once(const StatusGiven& given, const EdgeConfig& config) {
  PublishedStatus published = read_published_status(config, given.no_lock);
  const std::string update = update_note();
  const bool is_trouble = update.starts_with("WARN: ");
  const Health health = health_of(config, published, is_trouble ? update.substr(6) : "");
  if (given.prometheus) {
    const bool is_running = health.level != HealthLevel::kNotRunning;
    if (!print_metrics(config, published.status.value(), is_running)) return 1;
  } else if (given.json) {
    print_json(config, std::move(published), health, update);
  } else {
    print_text(config, published, health, update);
  }
  std::fflush(stdout);
  return static_cast<int>(health.level);
}

int run_status(const StatusGiven& given, SettingsFile& settings) {
  set_market_time_zone();
  const EdgeConfig& config = settings.config;
  constexpr const char* kClearScreen = "\033[H\033[2J";
  while (true) {
    if (given.follow && isatty(STDOUT_FILENO) != 0) std::fputs(kClearScreen, stdout);
    const int exit_code = print_once(given, config);
    if (!given.follow) return exit_code;
    sleep(2);
  }
}

}  // namespace

void add_status(EdgeCommand root) {
  EdgeCommand command = root.subcommand("status", "state and health of the running controller");
  const auto given = std::make_shared<StatusGiven>();
  command.flag("--json", given->json, "one JSON object with \"health\"");
  command
      .flag("--prometheus", given->prometheus,
            "metrics in the format of the node exporter's textfile collector")
      .excludes("--json");
  command.flag("--follow", given->follow, "again every two seconds, until Ctrl-C");
  command.flag("--no-lock", given->no_lock,
               "judge by the process number whether it runs: the lock is not even tried");
  command.footer(kFooter);
  command.does([given](SettingsFile& settings) { return run_status(*given, settings); });
}

}  // namespace bess
