// MQTT topics: a versioned tree, stable for users.
//   bess/v1/NAME/status   online | offline (the last will), retained
//   bess/v1/NAME/state    the newest values, one JSON object, retained
//   bess/v1/NAME/alarms   active alerts, JSON list, retained
//   bess/v1/NAME/day      yesterday, JSON, retained
//   bess/v1/NAME/event    each alert, its end and each day, when reported, JSON, not retained
//   bess/v1/NAME/hold/set, hold_power/set   orders, if [notify] mqtt_orders allows them
// Members may be added to an object; none is renamed or removed within v1.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "edge/companions/notify/controller_status.h"
#include "edge/companions/notify/notifier_state.h"
#include "edge/companions/notify/notify_settings.h"

namespace bess {

inline constexpr const char* kHoldTopic = "hold/set";             ///< ON or OFF
inline constexpr const char* kHoldPowerTopic = "hold_power/set";  ///< whole W, positive charges

/// "bess/v1/NAME/TOPIC".
std::string topic(const std::string& node, const char* name);

/// `today`: from ask_earned. `hold_power_w`: of the next hold, if orders are allowed.
std::string state_json(const ControllerStatus& status, const std::vector<ToldAlert>& alerts,
                       JsonValue today, std::optional<std::int32_t> hold_power_w);
Json alert_json(const ToldAlert& alert);
/// Reported alerts only.
std::string alerts_json(const std::vector<ToldAlert>& alerts);
/// All numbers of `earned`, from ask_earned.
std::string day_json(JsonValue earned);
Json event_json(const std::string& node, const Message& message);

/// Embedded discovery.json or controls.json: the discovery message with $NAMES to replace.
std::string_view page_file(std::string_view name);

/// Discovery of Home Assistant (2024.11 or later): one message for the device and its entities.
std::string discovery_topic(const NotifySettings& settings);
std::string discovery_json(const NotifySettings& settings, const std::string& version);

}  // namespace bess
