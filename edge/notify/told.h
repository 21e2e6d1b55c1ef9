// What must outlast a restart of the notifier: the alarms that were told, the last day that was, what each way
// has not taken yet, and the counters of energy. One JSON file, replaced at once.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "edge/notify/alarm_book.h"
#include "edge/notify/energy_totals.h"
#include "edge/notify/lane.h"

namespace bess {

struct Told {
  std::vector<Alarm> alarms{};
  std::int32_t local_day = 0;          ///< the last that was told; 0 = none yet
  std::map<std::string, Owed> owed{};  ///< by way: "mail", "webhook", "mqtt"
  EnergyTotals energy{};
};

/// A file that is missing or not ours is as if nothing had been told.
Told read_told(const std::string& path);

std::string told_text(const Told& told);

/// What `told_text` gave. Makes the folder if it is missing. False with one line.
bool write_told(const std::string& path, const std::string& text, std::string& error);

}  // namespace bess
