#include "edge/notify/topics.h"

#include <optional>

#include "shared/price_level.h"
#include "shared/utc_text.h"

namespace bess {
namespace {

constexpr const char* kNotRunning = "not running";  ///< as `bess-edge status` says it

/// Absent, not 0, where it was not measured.
void set_scaled(Json& json, const char* key, JsonValue last, const char* name, double divisor,
                int decimals) {
  const std::optional<double> number = last[name].number();
  if (number.has_value()) json.set(key, Decimals{*number / divisor, decimals});
}

bool is_true(JsonValue value) { return value.boolean().value_or(false); }

/// One entity of Home Assistant; empty texts are left out.
struct Entity {
  const char* platform;
  const char* key;
  const char* name;
  const char* value;  ///< template over the state
  const char* device_class = "";
  const char* unit = "";
  const char* state_class = "";
  const char* last_reset = "";  ///< template, of what begins again at 0
};

constexpr Entity kEntities[] = {
    {"sensor", "soc", "State of charge", "{{ value_json.soc_percent | default('None') }}",
     "battery", "%", "measurement"},
    {"sensor", "power", "Battery power", "{{ value_json.power_w | default('None') }}", "power", "W",
     "measurement"},
    {"sensor", "setpoint", "Ordered power", "{{ value_json.setpoint_w | default('None') }}",
     "power", "W", "measurement"},
    {"sensor", "price", "Imbalance price", "{{ value_json.price_eur_per_mwh | default('None') }}",
     "", "EUR/MWh", "measurement"},
    {"sensor", "break_even", "Break-even price",
     "{{ value_json.break_even_eur_per_mwh | default('None') }}", "", "EUR/MWh", "measurement"},
    {"sensor", "charge_up_to", "Charges up to",
     "{{ value_json.charge_up_to_eur_per_mwh | default('None') }}", "", "EUR/MWh", "measurement"},
    {"sensor", "discharge_from", "Discharges from",
     "{{ value_json.discharge_from_eur_per_mwh | default('None') }}", "", "EUR/MWh", "measurement"},
    {"sensor", "why", "Why", "{{ value_json.why }}"},
    {"sensor", "reserve", "Reserve", "{{ value_json.reserve_percent | default('None') }}", "", "%",
     "measurement"},
    {"sensor", "full_cycles", "Full cycles today",
     "{{ value_json.full_cycles_today | default('None') }}", "", "", "measurement"},
    {"sensor", "days_since_full", "Days since full",
     "{{ value_json.days_since_full | default('None') }}", "duration", "d", "measurement"},
    {"sensor", "mode", "Mode", "{{ value_json.mode }}"},
    {"sensor", "reason", "Reason", "{{ value_json.reason }}"},
    {"sensor", "hold_until", "Held until", "{{ value_json.hold_until_utc | default('None') }}",
     "timestamp"},
    {"binary_sensor", "held", "Held", "{{ 'ON' if value_json.held else 'OFF' }}"},
    {"binary_sensor", "problem", "Problem", "{{ 'OFF' if value_json.health == 'ok' else 'ON' }}",
     "problem"},
    {"sensor", "energy_charged", "Energy charged", "{{ value_json.charged_kwh | default('None') }}",
     "energy", "kWh", "total_increasing"},
    {"sensor", "energy_discharged", "Energy discharged",
     "{{ value_json.discharged_kwh | default('None') }}", "energy", "kWh", "total_increasing"},
    {"sensor", "earned_today", "Earned today (estimate)",
     "{{ value_json.earned_today_eur | default('None') }}", "monetary", "EUR", "total",
     "{{ value_json.today_since_utc }}"},
};

Json entity_json(const NotifySettings& settings, const std::string& id, const Entity& entity) {
  Json json = Json::object({{"platform", entity.platform},
                            {"unique_id", id + "_" + entity.key},
                            {"name", entity.name},
                            {"state_topic", topic(settings.name, "state")},
                            {"value_template", entity.value},
                            {"availability_topic", topic(settings.name, "status")},
                            {"expire_after", settings.every_s * 10}});
  const std::pair<const char*, const char*> others[] = {
      {"device_class", entity.device_class},
      {"unit_of_measurement", entity.unit},
      {"state_class", entity.state_class},
      {"last_reset_value_template", entity.last_reset}};
  for (const auto& [key, value] : others) {
    if (*value != '\0') json.set(key, value);
  }
  return json;
}

/// The power of a hold and the hold itself, where both may be ordered.
void add_controls(const NotifySettings& settings, const std::string& id, Json& components) {
  const auto control = [&](const char* platform, const char* key, const char* name,
                           const char* command, const char* value) {
    return Json::object({{"platform", platform},
                         {"unique_id", id + "_" + key},
                         {"name", name},
                         {"command_topic", topic(settings.name, command)},
                         {"state_topic", topic(settings.name, "state")},
                         {"value_template", value},
                         {"availability_topic", topic(settings.name, "status")}});
  };
  Json power = control("number", "hold_power", "Power to hold", kHoldPowerTopic,
                       "{{ value_json.hold_power_w | default(0) }}");
  power.set("command_template", "{{ value | int }}");
  power.set("min", -settings.power_w);
  power.set("max", settings.power_w);
  power.set("step", 1);
  power.set("mode", "box");
  power.set("unit_of_measurement", "W");
  power.set("device_class", "power");
  components.set((id + "_hold_power").c_str(), std::move(power));
  components.set((id + "_hold").c_str(), control("switch", "hold", "Hold", kHoldTopic,
                                                 "{{ 'ON' if value_json.held else 'OFF' }}"));
}

void add_yesterday(const NotifySettings& settings, const std::string& id, Json& components) {
  const std::string unique = id + "_earned_yesterday";
  components.set(unique.c_str(),
                 Json::object({{"platform", "sensor"},
                               {"unique_id", unique},
                               {"name", "Earned yesterday (estimate)"},
                               {"state_topic", topic(settings.name, "day")},
                               {"value_template", "{{ value_json.earned_eur | default('None') }}"},
                               {"availability_topic", topic(settings.name, "status")},
                               {"device_class", "monetary"},
                               {"unit_of_measurement", "EUR"}}));
}

/// Who decides, and what ends it: "student", or "price_age, until a newer price comes".
std::string why_text(JsonValue next) {
  const std::string reason = next["reason"].text_or("");
  const std::string ends = next["ends"].text_or("");
  if (reason.empty()) return next.exists() ? "student" : "unknown";
  return ends.empty() ? reason : reason + ", " + ends;
}

/// What the last cycle saw and did: of a controller that has ended, nothing is known any more.
void set_newest(Json& json, JsonValue all) {
  const JsonValue last = all["last"];
  if (is_true(last["has_measurement"])) {
    set_scaled(json, "soc_percent", last, "soc_e4", 100, 1);
    set_scaled(json, "power_w", last, "battery_power_w", 1, 0);
  }
  set_scaled(json, "setpoint_w", last, "ordered_power_w", 1, 0);
  if (is_true(last["has_price"])) {
    set_scaled(json, "price_eur_per_mwh", last, "price_centi_eur_per_mwh", 100, 2);
  }
  set_scaled(json, "break_even_eur_per_mwh", last, "break_even_centi", 100, 2);
  for (const char* margin : {"charge_up_to_eur_per_mwh", "discharge_from_eur_per_mwh"}) {
    set_scaled(json, margin, all["next"]["margins"], margin, 1, 2);
  }
  set_scaled(json, "reserve_percent", last, "reserve_soc_e4", 100, 1);
  set_scaled(json, "days_since_full", last, "days_since_full", 1, 0);
  set_scaled(json, "full_cycles_today", all["totals"], "soc_moved_e4_today", 20'000, 3);
  const bool held = is_true(last["held"]);
  json.set("held", held);
  if (held) {
    set_scaled(json, "hold_w", last, "hold_power_w", 1, 0);
    json.set("hold_until_utc", last["hold_until_utc"].text_or(""));
  }
}

void set_ledger(Json& json, const Ledger& ledger) {
  if (ledger.energy.has_begun()) {
    json.set("charged_kwh", Decimals{ledger.energy.charged_kwh(), 3});
    json.set("discharged_kwh", Decimals{ledger.energy.discharged_kwh(), 3});
  }
  if (!ledger.today.is_empty()) {
    json.set("earned_today_eur", Decimals{ledger.today.earned_eur(), 2});
    json.set("today_since_utc", utc_text(ledger.today.start_utc_s()).view());
  }
}

std::string id_of(const NotifySettings& settings) { return "bess_" + settings.id; }

}  // namespace

std::string topic(const std::string& node, const char* name) {
  return "bess/v1/" + node + "/" + name;
}

std::string state_json(const ControllerStatus& status, std::size_t open_alarms,
                       const Ledger& ledger) {
  const JsonValue all = status.json.value();
  const std::string_view health =
      status.trouble.empty() ? all["health"].text_or("unknown") : "unknown";
  const bool is_running = health != kNotRunning;
  Json json =
      Json::object({{"health", health},
                    {"alarms", open_alarms},
                    {"mode", is_running ? all["last"]["mode"].text_or("none") : kNotRunning},
                    {"reason", all["last"]["reason"].text_or("none")},
                    {"in_control", is_running && is_true(all["control"])},
                    {"utc", all["last"]["utc"].text_or("")}});
  json.set("why", is_running ? why_text(all["next"]) : kNotRunning);
  if (is_running) {
    set_newest(json, all);
  } else {
    json.set("held", false);
  }
  set_ledger(json, ledger);
  if (ledger.desk != nullptr) json.set("hold_power_w", ledger.desk->power_w());
  return json.line();
}

std::string alarms_json(const std::vector<Alarm>& alarms) {
  Json list = Json::list();
  for (const Alarm& alarm : alarms) {
    if (!alarm.is_told) continue;
    list.add(Json::object({{"key", alarm.key},
                           {"text", alarm.text},
                           {"since_utc", utc_text(alarm.since_utc_s).view()}}));
  }
  return list.line();
}

std::string day_json(const DayAccount& day) {
  return Json::object({{"date", day.date()},
                       {"earned_eur", Decimals{day.earned_eur(), 2}},
                       {"charged_kwh", Decimals{day.charged_kwh(), 3}},
                       {"discharged_kwh", Decimals{day.discharged_kwh(), 3}},
                       {"full_cycles", Decimals{day.full_cycles(), 3}},
                       {"cycles", day.cycles()},
                       {"interventions", day.interventions()},
                       {"estimated_eur", Decimals{day.money().estimated_eur, 2}}})
      .line();
}

std::string discovery_topic(const NotifySettings& settings) {
  return settings.mqtt.discovery_prefix + "/device/" + id_of(settings) + "/config";
}

std::string discovery_json(const NotifySettings& settings, const std::string& version) {
  const std::string id = id_of(settings);
  Json components = Json::object();
  for (const Entity& entity : kEntities) {
    components.set((id + "_" + entity.key).c_str(), entity_json(settings, id, entity));
  }
  add_yesterday(settings, id, components);
  if (settings.mqtt.orders) add_controls(settings, id, components);
  Json ids = Json::list();
  ids.add(id);
  Json device = Json::object({{"identifiers", std::move(ids)},
                              {"name", "bess " + settings.name},
                              {"manufacturer", "bess"},
                              {"model", "battery controller"},
                              {"sw_version", version}});
  Json origin = Json::object({{"name", "bess-notify"}, {"sw_version", version}});
  return Json::object({{"device", std::move(device)},
                       {"origin", std::move(origin)},
                       {"components", std::move(components)}})
      .line();
}

}  // namespace bess
