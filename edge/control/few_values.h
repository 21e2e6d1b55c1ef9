// A price that goes to and fro between a few values under new stamps: a source that hangs, and
// shows now one and now another of its last rows. Pure integers.
//
// How long honest prices stay within four values, to the cent, measured on 23 November 2026 on
// Elia's data, of every second minute, as a controller asks:
//   the 1,631 real minutes of 6 September 2024 and 8 April 2025   66 minutes at most
//   the 204,420 rebuilt minutes of January to May 2023            50 minutes
//   52,530 real settled quarter-hours of January 2023 to June     405 minutes, in December 2024
//   2025, had every minute of them shown it
// Five values and more pass for a price that moves.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

namespace bess {

class FewValues {
 public:
  static constexpr std::size_t kValues = 4;

  /// `counted_s` since the row before.
  constexpr void observe(std::int32_t value, std::int64_t counted_s) {
    now_s_ += counted_s;
    Seen* seen = std::find_if(begin(), end(), [&](const Seen& s) { return s.value == value; });
    if (seen == end() && count_ < kValues) {
      ++count_;
      if (count_ == 1) since_s_ = moved_s_ = now_s_;
    } else if (seen == end()) {  // the others are all that was seen since the oldest
      seen = std::min_element(begin(), end(),
                              [](const Seen& a, const Seen& b) { return a.last_s < b.last_s; });
      since_s_ = seen->last_s;
    }
    if (value != newest_) moved_s_ = now_s_;
    *seen = {value, now_s_};
    newest_ = value;
  }
  [[nodiscard]] constexpr std::int32_t newest() const { return newest_; }
  /// The newest, in a row.
  [[nodiscard]] constexpr std::int64_t stood_s() const { return now_s_ - moved_s_; }
  /// For so long there were no more than four.
  [[nodiscard]] constexpr std::int64_t lasted_s() const { return now_s_ - since_s_; }

 private:
  struct Seen {
    std::int32_t value = 0;
    std::int64_t last_s = 0;
  };

  constexpr Seen* begin() { return seen_.data(); }
  constexpr Seen* end() { return seen_.data() + count_; }

  std::array<Seen, kValues> seen_{};
  std::size_t count_ = 0;
  std::int64_t now_s_ = 0;
  std::int64_t since_s_ = 0;
  std::int64_t moved_s_ = 0;
  std::int32_t newest_ = 0;
};

}  // namespace bess
