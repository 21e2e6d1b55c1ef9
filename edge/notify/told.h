// What must outlast a restart of the notifier: the alarms that were told, the last day that was, and what no
// way has taken yet. One JSON file, replaced at once.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "edge/notify/alarm_book.h"
#include "edge/notify/message.h"

namespace bess {

/// A message that one way still owes.
struct Pending {
  std::string way{};  ///< "mail", "webhook", "mqtt"
  Message message{};
};

struct Told {
  std::vector<Alarm> alarms{};
  std::int32_t local_day = 0;  ///< the last that was told; 0 = none yet
  std::vector<Pending> pending{};
};

/// A file that is missing or not ours is as if nothing had been told.
Told read_told(const std::string& path);

/// Makes the folder if it is missing. False with one line.
bool write_told(const std::string& path, const Told& told, std::string& error);

}  // namespace bess
