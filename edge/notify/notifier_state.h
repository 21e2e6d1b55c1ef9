// What must outlast a restart of the notifier: the alarms that were reported, the last day that
// was, and what the command has not taken yet. One JSON text with a checksum, replaced at once: in
// [notify] folder and, for a disk that dies, in run_folder.
#pragma once

#include <cstdint>
#include <deque>
#include <string>
#include <vector>

#include "edge/notify/alarm_book.h"
#include "edge/notify/alarm_command.h"

namespace bess {

struct NotifierState {
  std::uint64_t number = 0;  ///< grows with every time that it is kept
  std::string day{};         ///< the newest of which the log had a cycle; empty = none yet
  std::vector<Alarm> alarms{};
  std::deque<Message> pending{};  ///< oldest first
};

/// The one that was kept last; a file that is damaged or not ours is named in `losses`, one line
/// each, and is as if nothing had been reported.
NotifierState read_notifier_state(const std::vector<std::string>& paths,
                                  std::vector<std::string>& losses);

std::string notifier_state_text(const NotifierState& state);

/// What `notifier_state_text` gave, to every place; a folder that is missing is made. Empty, or one
/// line: which place could not be written, and what follows from it.
std::string write_notifier_state(const std::vector<std::string>& paths, const std::string& text);

}  // namespace bess
