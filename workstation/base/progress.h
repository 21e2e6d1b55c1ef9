// One progress line on stderr for anything that takes more than two seconds: done, rate, ETA.
// On a terminal it redraws in place, in one row; elsewhere it prints a line a minute, so logs stay
// short.
#pragma once

#include <chrono>
#include <string>
#include <string_view>

namespace bess {

/// How far something is, at one instant.
struct ProgressState {
  double done = 0, total = 0;
  double rate_per_s = 0;
  double elapsed_s = 0;
  bool is_over = false;
};

/// "TITLE: 12/40 UNIT (3.1/s, ETA 9 s)  NOTE" in at most `columns`: the note gives way first.
std::string progress_line(std::string_view title, std::string_view unit, const ProgressState& state,
                          std::string_view note, std::size_t columns);

class Progress {
 public:
  /// `unit` is the plural noun that the rate counts, e.g. "steps"; `done_before` were done by an
  /// earlier run and do not count in it.
  Progress(std::string title, std::string unit, double total, double done_before = 0);
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;
  ~Progress();

  /// Shows `done` of the total; cheap to call often. `note` is appended, as far as there is room.
  void update(double done, std::string_view note = {});

 private:
  using Clock = std::chrono::steady_clock;
  void print(double done, std::string_view note, bool last);

  std::string title_;
  std::string unit_;
  double total_;
  double done_before_;
  double done_ = 0;
  std::string note_;
  bool terminal_;
  bool printed_ = false;
  Clock::time_point start_ = Clock::now();
  Clock::time_point next_;
};

}  // namespace bess
