// What stands where in the broker: a versioned tree, so that no later version moves what users have
// built upon.
//   bess/v1/NAME/status   online | offline (the last will), retained
//   bess/v1/NAME/state    the newest values, one JSON object, retained
//   bess/v1/NAME/alarms   the alarms that are reported and not over, JSON list, retained
//   bess/v1/NAME/day      yesterday, JSON, retained
//   bess/v1/NAME/event    each alarm, its end and each day as it is reported, JSON, not retained
//   bess/v1/NAME/hold/set, hold_power/set   orders, where [notify] mqtt_orders allows them
// A member may be added to an object; none is renamed or removed within v1.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "edge/companions/notify/alarm_command.h"
#include "edge/companions/notify/controller_status.h"
#include "edge/companions/notify/notifier_state.h"
#include "edge/companions/notify/notify_settings.h"

namespace bess {

inline constexpr const char* kHoldTopic = "hold/set";             ///< ON or OFF
inline constexpr const char* kHoldPowerTopic = "hold_power/set";  ///< whole W, positive charges

/// "bess/v1/NAME/TOPIC".
std::string topic(const std::string& node, const char* name);

/// `today` is what ask_earned gave; `hold_power_w` is of the next hold, where one may be ordered.
std::string state_json(const ControllerStatus& status, const std::vector<Alarm>& alarms,
                       JsonValue today, std::optional<std::int32_t> hold_power_w);
Json alarm_json(const Alarm& alarm);
/// Of those that are reported.
std::string alarms_json(const std::vector<Alarm>& alarms);
/// `earned` is what ask_earned gave of that day: all of its numbers.
std::string day_json(JsonValue earned);
Json event_json(const std::string& node, const Message& message);

/// discovery.json or controls.json, embedded when it is built: the discovery message, with
/// $NAMES of what is ours.
std::string_view page_file(std::string_view name);

/// Home Assistant's discovery: one message for the device and all its entities (since 2024.11).
std::string discovery_topic(const NotifySettings& settings);
std::string discovery_json(const NotifySettings& settings, const std::string& version);

}  // namespace bess
