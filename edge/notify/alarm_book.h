// Which troubles have been told, so that each is told once, and its end once: pure, over UTC
// seconds.
//   a trouble that lasts `after_s`            is told
//   one that comes back within `after_s`      is still the same
//   a told one that stays away `after_s`      is over, and that is told
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

class AlarmBook {
 public:
  AlarmBook(std::int64_t after_s, std::vector<Alarm> before)
      : after_s_(after_s), alarms_(std::move(before)) {}

  /// What is to be told now that these troubles, and no others, are there.
  std::vector<AlarmEvent> observe(const std::vector<Trouble>& troubles, std::int64_t now_utc_s);
  /// Told and untold ones, oldest first.
  [[nodiscard]] const std::vector<Alarm>& alarms() const { return alarms_; }

 private:
  Alarm& alarm_of(const Trouble& trouble, std::int64_t now_utc_s);

  std::int64_t after_s_;
  std::vector<Alarm> alarms_;
};

}  // namespace bess
