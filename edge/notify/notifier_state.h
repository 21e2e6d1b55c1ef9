// What must outlast a restart of the notifier: the alarms that were told, the last day that was,
// what each way has not taken yet, and the counters of energy. One JSON text with a checksum, in
// several files, each replaced at once: twice in [notify] folder, for a card that forgets, and in
// run_folder, for one that dies.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "edge/notify/alarm_book.h"
#include "edge/notify/energy_totals.h"
#include "edge/notify/outbox.h"

namespace bess {

struct NotifierState {
  std::uint64_t number = 0;  ///< grows with every time that it is kept
  std::vector<Alarm> alarms{};
  std::int32_t local_day = 0;          ///< the last that was told; 0 = none yet
  std::map<std::string, Owed> owed{};  ///< by way: "command", "mqtt"
  EnergyTotals energy{};
};

struct NotifierStateReading {
  NotifierState told{};
  std::vector<std::string> losses{};  ///< one line each
};
/// Of all files the one that was kept last; one that is missing, damaged or not ours is as if
/// nothing had been told.
NotifierStateReading read_newest_notifier_state(const std::vector<std::string>& paths);

std::string notifier_state_text(const NotifierState& told);

/// What `notifier_state_text` gave, to every place; a folder that is missing is made. Empty, or one
/// line: which place could not be written first, and what follows from it.
std::string write_notifier_state(const std::vector<std::string>& paths, const std::string& text);

}  // namespace bess
