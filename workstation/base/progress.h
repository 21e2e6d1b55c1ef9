// Progress line on stderr for work that takes more than two seconds: done, rate, ETA. A terminal
// redraws one row; other outputs get one line per minute, which keeps logs short.
#pragma once

#include <chrono>
#include <mutex>
#include <string>
#include <string_view>

namespace bess {

/// Progress at one instant.
struct ProgressState {
  double done = 0, total = 0;
  double rate_per_s = 0;
  double elapsed_s = 0;
  bool is_over = false;
};

/// "TITLE: 12/40 UNIT (3.1/s, ETA 9 s)  NOTE" in at most `columns`; the note is shortened first.
std::string progress_line(std::string_view title, std::string_view unit, const ProgressState& state,
                          std::string_view note, std::size_t columns);

class Progress {
 public:
  /// `unit` is the plural noun that the rate counts, e.g. "steps"; `done_before` were done by an
  /// earlier run and do not count in the rate.
  Progress(std::string title, std::string unit, double total, double done_before = 0);
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;
  ~Progress();

  /// Shows `done` of the total; cheap to call often. `note` is appended where it fits.
  void update(double done, std::string_view note = {});
  /// One more is done; for jobs on several threads.
  void advance(std::string_view note = {});

 private:
  using Clock = std::chrono::steady_clock;
  void print(double done, std::string_view note, bool last);

  std::string title_;
  std::string unit_;
  double total_;
  double done_before_;
  double done_ = done_before_;
  std::mutex mutex_;
  std::string note_;
  bool terminal_;
  bool printed_ = false;
  Clock::time_point start_ = Clock::now();
  Clock::time_point next_;
};

}  // namespace bess
