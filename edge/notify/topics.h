// What stands where in the broker: a versioned tree, so that no later version moves what users have
// built upon.
//   bess/v1/NAME/status   online | offline (the last will), retained
//   bess/v1/NAME/state    the newest values, one JSON object, retained
//   bess/v1/NAME/alarms   the alarms that are told and not over, JSON list, retained
//   bess/v1/NAME/day      yesterday, JSON, retained
//   bess/v1/NAME/event    each alarm and its end as it is told, JSON, not retained
//   bess/v1/NAME/hold/set, hold_power/set   orders, where they are allowed (mqtt_orders.h)
// A member may be added to an object; none is renamed or removed within v1.
#pragma once

#include <string>
#include <vector>

#include "edge/account/day_account.h"
#include "edge/notify/alarm_book.h"
#include "edge/notify/controller_status.h"
#include "edge/notify/energy_totals.h"
#include "edge/notify/mqtt_orders.h"
#include "edge/notify/notify_settings.h"

namespace bess {

/// "bess/v1/NAME/TOPIC".
std::string topic(const std::string& node, const char* name);

/// What the decision log adds up to.
struct Ledger {
  const EnergyTotals& energy;
  const DayAccount& today;         ///< empty: no cycle has ended yet
  const HoldDesk* desk = nullptr;  ///< null: nothing may be ordered
};

std::string state_json(const ControllerStatus& status, std::size_t open_alarms,
                       const Ledger& ledger);
std::string alarms_json(const std::vector<Alarm>& alarms);
std::string day_json(const DayAccount& day);

/// Home Assistant's discovery: one message for the device and all its entities (since 2024.11).
std::string discovery_topic(const NotifySettings& settings);
std::string discovery_json(const NotifySettings& settings, const std::string& version);

}  // namespace bess
