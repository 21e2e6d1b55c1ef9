// Which troubles have been reported: each once, and its end once. Pure, over UTC seconds.
//   a trouble that lasts `after_s`                is reported
//   one that comes back within `after_s`          is still the same
//   a reported one that stays away for `after_s`  is over, and that is reported
// Between two looks it is a list that the caller keeps in a file: a restart repeats nothing.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace bess {

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

}  // namespace bess
