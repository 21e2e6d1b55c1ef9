#include "edge/companions/notify/topics.h"

#include <algorithm>

#include "shared/host/text.h"
#include "shared/utc_text.h"

namespace bess {
namespace {

constexpr const char* kNotRunning = "not running";  ///< health of `bess-edge status`

bool is_true(JsonValue value) { return value.boolean().value_or(false); }

/// An unknown number is absent, not 0.
void set_number(Json& json, const char* member, JsonValue value, double divisor = 1,
                int decimals = 0) {
  const std::optional<double> number = value.number();
  if (number.has_value()) json.set(member, Decimals{*number / divisor, decimals});
}

/// Decider and end condition: "student", or "price_age, until a newer price comes".
std::string why_text(JsonValue next) {
  const std::string reason = next["reason"].text_or("");
  const std::string ends = next["ends"].text_or("");
  if (reason.empty()) return next.exists() ? "student" : "unknown";
  return ends.empty() ? reason : reason + ", " + ends;
}

/// Inputs and order of the last control cycle.
void set_newest(Json& json, JsonValue all) {
  const JsonValue last = all["last"];
  if (is_true(last["has_measurement"])) {
    set_number(json, "soc_percent", last["soc_e4"], 100, 1);
    set_number(json, "power_w", last["battery_power_w"]);
  }
  set_number(json, "setpoint_w", last["ordered_power_w"]);
  if (is_true(last["has_price"])) {
    set_number(json, "price_eur_per_mwh", last["price_centi_eur_per_mwh"], 100, 2);
  }
  set_number(json, "break_even_eur_per_mwh", last["break_even_centi"], 100, 2);
  for (const char* margin : {"charge_up_to_eur_per_mwh", "discharge_from_eur_per_mwh"}) {
    set_number(json, margin, all["next"]["margins"][margin], 1, 2);
  }
  set_number(json, "reserve_percent", last["reserve_soc_e4"], 100, 1);
  set_number(json, "days_since_full", last["days_since_full"]);
  set_number(json, "full_cycles_today", all["totals"]["soc_moved_e4_today"], 20'000, 3);
  if (!is_true(last["held"])) return;
  set_number(json, "hold_w", last["hold_power_w"]);
  json.set("hold_until_utc", last["hold_until_utc"].text_or(""));
}

}  // namespace

std::string topic(const std::string& node, const char* name) {
  return "bess/v1/" + node + "/" + name;
}

std::string state_json(const ControllerStatus& status, const std::vector<ToldAlert>& alerts,
                       JsonValue today, std::optional<std::int32_t> hold_power_w) {
  const JsonValue all = status.json.value();
  const std::string_view health =
      status.trouble.empty() ? all["health"].text_or("unknown") : "unknown";
  const bool is_running = health != kNotRunning;
  Json json =
      Json::object({{"health", health},
                    {"alarms", std::ranges::count(alerts, true, &ToldAlert::is_told)},
                    {"mode", is_running ? all["last"]["mode"].text_or("none") : kNotRunning},
                    {"reason", all["last"]["reason"].text_or("none")},
                    {"in_control", is_running && is_true(all["control"])},
                    {"utc", all["last"]["utc"].text_or("")},
                    {"why", is_running ? why_text(all["next"]) : kNotRunning},
                    {"held", is_running && is_true(all["last"]["held"])}});
  if (is_running) set_newest(json, all);  // unknown after the end of the controller
  const JsonValue day = *today["days"].begin();
  set_number(json, "charged_kwh", day["charged_kwh"], 1, 3);
  set_number(json, "discharged_kwh", day["discharged_kwh"], 1, 3);
  set_number(json, "earned_today_eur", day["earned_eur"], 1, 2);
  if (day.exists()) json.set("today_since_utc", day["start_utc"].text_or(""));
  if (hold_power_w.has_value()) json.set("hold_power_w", *hold_power_w);
  return json.line();
}

Json alert_json(const ToldAlert& alert) {
  return Json::object({{"key", alert.key},
                       {"text", alert.text},
                       {"since_utc", utc_text(alert.since_utc_s).view()}});
}

std::string alerts_json(const std::vector<ToldAlert>& alerts) {
  Json list = Json::list();
  for (const ToldAlert& alert : alerts) {
    if (alert.is_told) list.add(alert_json(alert));
  }
  return list.line();
}

std::string day_json(JsonValue earned) {
  const JsonValue day = *earned["days"].begin();
  Json json = Json::object({{"date", day["date"].text_or("")}});
  for (const JsonValue member : day) {
    const std::optional<double> number = member.number();
    if (number.has_value()) json.set(std::string(member.key()).c_str(), *number);
  }
  return json.line();
}

Json event_json(const std::string& node, const Message& message) {
  Json json = Json::object({{"node", node},
                            {"kind", message.severity},
                            {"key", message.key},
                            {"text", message.text},
                            {"utc", utc_text(message.utc_s).view()}});
  if (message.since_utc_s != 0) json.set("since_utc", utc_text(message.since_utc_s).view());
  return json;
}

std::string discovery_topic(const NotifySettings& settings) {
  return "homeassistant/device/bess_" + settings.id + "/config";
}

std::string discovery_json(const NotifySettings& settings, const std::string& version) {
  std::string text(page_file("discovery.json"));
  std::string controls(page_file("controls.json"));  // its members join those of discovery.json
  controls = controls.substr(1, controls.rfind('}') - 1) + ",";
  replace_all(text, "\"$CONTROLS\": {},", settings.mqtt.orders ? controls : "");
  replace_all(text, "$ID", "bess_" + settings.id);
  replace_all(text, "$NODE", topic(settings.name, ""));
  replace_all(text, "$NAME", settings.name);
  replace_all(text, "$VERSION", version);
  replace_all(text, "\"$EXPIRE_S\"", std::to_string(settings.every_s * 10));
  replace_all(text, "\"-$POWER_W\"", std::to_string(-settings.power_w));
  replace_all(text, "\"$POWER_W\"", std::to_string(settings.power_w));
  return Json::parse(text).line();
}

}  // namespace bess
