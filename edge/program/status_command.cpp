#include "edge/program/status_command.h"

#include <cjson/cJSON.h>
#include <unistd.h>

#include <cstdio>
#include <fstream>
#include <memory>
#include <sstream>

#include "edge/log/health.h"
#include "edge/log/journal.h"
#include "edge/log/ring_log.h"
#include "edge/program/run_locks.h"
#include "shared/units_and_limits.h"
#include "shared/utc_text.h"

namespace bess {
namespace {

using Json = std::unique_ptr<cJSON, decltype(&cJSON_Delete)>;

bool read_text(const char* path, std::string& text) {
  const std::ifstream file(path);
  if (!file) return false;
  std::ostringstream all;
  all << file.rdbuf();
  text = all.str();
  return true;
}

/// The published status; null when there is none or it is not ours.
Json read_status(const EdgeConfig& config) {
  std::string text;
  if (!read_text(config.log.status.c_str(), text)) return {nullptr, &cJSON_Delete};
  return {cJSON_ParseWithLength(text.data(), text.size()), &cJSON_Delete};
}

const cJSON* item(const cJSON* root, const char* section, const char* name) {
  if (section != nullptr) root = cJSON_GetObjectItemCaseSensitive(root, section);
  return cJSON_GetObjectItemCaseSensitive(root, name);
}

double number(const cJSON* root, const char* section, const char* name) {
  const cJSON* const found = item(root, section, name);
  return cJSON_IsNumber(found) ? found->valuedouble : 0;
}

std::int64_t whole(const cJSON* root, const char* section, const char* name) {
  return static_cast<std::int64_t>(number(root, section, name));
}

const char* text_of(const cJSON* root, const char* section, const char* name) {
  const cJSON* const found = item(root, section, name);
  return cJSON_IsString(found) ? found->valuestring : "none";
}

bool is_true(const cJSON* root, const char* section, const char* name) {
  return cJSON_IsTrue(item(root, section, name)) != 0;
}

std::int64_t age_ms_of(const cJSON* status) {
  return clock_ns(CLOCK_MONOTONIC) / 1'000'000 - whole(status, nullptr, "written_monotonic_ms");
}

/// On a full disk the status stays as it was, while the log goes on in its file of fixed size.
std::int64_t cycles_behind(const EdgeConfig& config, const cJSON* status) {
  RingLog ring;
  FileMessage ignored;
  CycleRecord newest;
  std::int64_t published_utc_s = 0;
  const bool is_known = ring.open_to_read(config.log.ring.c_str(), ignored) &&
                        ring.read(ring.newest_number(), newest) &&
                        parse_utc_text(text_of(status, "last", "utc"), published_utc_s);
  if (!is_known || newest.utc_s < published_utc_s) return 0;
  return (newest.utc_s - published_utc_s) / kSecondsPerStep;
}

Health health_of(const EdgeConfig& config, const cJSON* status) {
  const int holder = holder_of(state_lock_path(config).c_str());
  HealthInputs in;
  in.is_running = holder != 0;
  if (status == nullptr) return assess_health(in);
  in.is_of_this_run = holder == whole(status, nullptr, "pid");
  in.age_ms = age_ms_of(status);
  in.cadence_ms = whole(status, nullptr, "cadence_ms");
  in.cycles = whole(status, "totals", "cycles");
  in.mode = text_of(status, "last", "mode");
  in.reason = text_of(status, "last", "reason");
  in.battery_status = text_of(status, "last", "battery_status");
  in.price_status = text_of(status, "last", "price_status");
  in.unanswered_orders = whole(status, "totals", "unanswered_orders");
  in.disk_is_slow = is_true(status, "totals", "disk_is_slow");
  in.disk_is_failing = is_true(status, "totals", "disk_is_failing");
  if (in.is_of_this_run && in.cycles > 0) in.cycles_behind = cycles_behind(config, status);
  return assess_health(in);
}

void print_health(const Health& health) {
  std::printf("health     %s\n", health_name(health.level).data());
  for (const std::string& reason : health.reasons) std::printf("           %s\n", reason.c_str());
}

void print_last_cycle(const cJSON* s) {
  std::printf("state      %s at %s, cycle %lld\n", text_of(s, "last", "mode"),
              text_of(s, "last", "utc"), static_cast<long long>(whole(s, "last", "cycle")));
  if (is_true(s, "last", "has_measurement")) {
    std::printf("battery    SoC %.1f %%, %.0f W (charging is positive), %s\n",
                number(s, "last", "soc_e4") / 100, number(s, "last", "battery_power_w"),
                text_of(s, "last", "battery_status"));
  } else {
    std::printf("battery    not measured, %s\n", text_of(s, "last", "battery_status"));
  }
  if (is_true(s, "last", "has_price")) {
    std::printf("price      %.2f EUR/MWh, %.0f s old at the decision, %s\n",
                number(s, "last", "price_centi_eur_per_mwh") / 100,
                number(s, "last", "price_age_s"), text_of(s, "last", "price_status"));
  } else {
    std::printf("price      none, %s\n", text_of(s, "last", "price_status"));
  }
  std::printf("order      %.0f W, reason %s\n", number(s, "last", "ordered_power_w"),
              text_of(s, "last", "reason"));
}

void print_counters(const cJSON* s) {
  const auto total = [s](const char* name) {
    return static_cast<long long>(whole(s, "totals", name));
  };
  std::printf(
      "cycles     %lld, missed ticks %lld, late orders %lld, orders written %lld, log records "
      "dropped %lld\n",
      total("cycles"), total("missed_ticks"), total("deadline_misses"), total("written_orders"),
      total("records_dropped"));
  std::printf("failures   battery %lld, prices %lld, disk %lld\n", total("battery_failures"),
              total("price_failures"), total("disk_failures"));
  std::printf("modbus     %lld requests, %lld failed, %lld reconnects, %lld register writes\n",
              total("requests"), total("failed_requests"), total("reconnects"),
              total("register_writes"));
}

void print_last_orders(const EdgeConfig& config) {
  constexpr std::uint64_t kOrders = 10;
  RingLog ring;
  FileMessage ignored;
  if (!ring.open_to_read(config.log.ring.c_str(), ignored)) return;
  std::printf("orders     utc                     ordered W  price EUR/MWh   SoC %%  reason\n");
  const std::uint64_t newest = ring.newest_number();
  CycleRecord r;
  for (std::uint64_t n = newest > kOrders ? newest - kOrders + 1 : 1; n <= newest; ++n) {
    if (!ring.read(n, r)) continue;
    std::printf("           %s  %10d  %13.2f  %6.1f  %s%s\n", utc_text(r.utc_s).c_str(),
                r.ordered_power_w, r.price.price_centi_eur_per_mwh / 100.0,
                r.measurement.soc_e4 / 100.0, reason_name(r.reason).data(),
                r.written ? "" : " (not written)");
  }
}

void print_text(const EdgeConfig& config, const cJSON* status, const Health& health) {
  print_health(health);
  if (status != nullptr) {
    std::printf("controller %s, process %lld since %s, version %s, student %s\n",
                is_true(status, nullptr, "control") ? "in control" : "read-only",
                static_cast<long long>(whole(status, nullptr, "pid")),
                text_of(status, nullptr, "start_utc"), text_of(status, nullptr, "version"),
                text_of(status, nullptr, "student"));
    const char* const variant = text_of(status, nullptr, "variant");
    std::printf("driving    %s, map %s%s%s\n", text_of(status, nullptr, "battery"),
                text_of(status, nullptr, "map"), *variant == '\0' ? "" : ", variant ", variant);
    if (whole(status, "totals", "cycles") > 0) print_last_cycle(status);
    print_counters(status);
  }
  print_last_orders(config);
}

void print_json(cJSON* status, const Health& health) {
  Json made(nullptr, &cJSON_Delete);
  if (status == nullptr) {
    made.reset(cJSON_CreateObject());
    status = made.get();
  }
  cJSON_AddStringToObject(status, "health", health_name(health.level).data());
  cJSON* const reasons = cJSON_AddArrayToObject(status, "health_reasons");
  for (const std::string& reason : health.reasons) {
    cJSON_AddItemToArray(reasons, cJSON_CreateString(reason.c_str()));
  }
  char* const text = cJSON_Print(status);
  std::puts(text);
  cJSON_free(text);
}

bool print_metrics(const EdgeConfig& config) {
  std::string text;
  if (!read_text(config.log.metrics.c_str(), text)) {
    report(JournalLevel::kError, "%s: no metrics here; has bess-edge run with this configuration?",
           config.log.metrics.c_str());
    return false;
  }
  std::fputs(text.c_str(), stdout);
  return true;
}

int print_once(const CommandLine& command_line, const EdgeConfig& config) {
  const Json status = read_status(config);
  const Health health = health_of(config, status.get());
  if (command_line.prometheus) {
    if (!print_metrics(config)) return 1;
  } else if (command_line.json) {
    print_json(status.get(), health);
  } else {
    print_text(config, status.get(), health);
  }
  std::fflush(stdout);
  return static_cast<int>(health.level);
}

}  // namespace

int run_status_command(const CommandLine& command_line, const EdgeConfig& config) {
  constexpr const char* kClearScreen = "\033[H\033[2J";
  while (true) {
    if (command_line.follow && isatty(STDOUT_FILENO) != 0) std::fputs(kClearScreen, stdout);
    const int exit_code = print_once(command_line, config);
    if (!command_line.follow) return exit_code;
    sleep(2);
  }
}

}  // namespace bess
