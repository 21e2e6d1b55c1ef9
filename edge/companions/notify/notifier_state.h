// What must outlast a restart of the notifier: the alarms that were reported, the last day that
// was, and what the command has not taken yet. One JSON text with a checksum, replaced at once: in
// [notify] folder and, for a disk that dies, in run_folder.
#pragma once

#include <cstdint>
#include <deque>
#include <string>
#include <vector>

#include "edge/companions/notify/alarm_command.h"

namespace bess {

// Which troubles have been reported: each once, and its end once. Pure, over UTC seconds.
//   a trouble that lasts `after_s`                is reported
//   one that comes back within `after_s`          is still the same
//   a reported one that stays away for `after_s`  is over, and that is reported
// Between two looks it is a list that the caller keeps in a file: a restart repeats nothing.

/// Something that is wrong now. Two looks see the same trouble when the key is the same; the text
/// may differ, by a number that grows.
struct Trouble {
  std::string key{};
  std::string text{};
};

struct Alarm {
  std::string key{};
  std::string text{};  ///< as it was last seen
  std::int64_t since_utc_s = 0;
  std::int64_t seen_utc_s = 0;  ///< last time
  bool is_told = false;
};

struct AlarmEvent {
  bool is_over = false;
  Alarm alarm{};
};

/// Takes into `alarms`, oldest first, that these troubles and no others are there now. Returns what
/// is to be reported.
std::vector<AlarmEvent> observe(std::vector<Alarm>& alarms, const std::vector<Trouble>& troubles,
                                std::int64_t after_s, std::int64_t now_utc_s);

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
