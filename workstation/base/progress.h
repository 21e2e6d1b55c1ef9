// One progress line on stderr for anything that takes more than two seconds: done, rate, ETA.
// On a terminal it redraws in place; elsewhere it prints a line every ten seconds, so logs stay
// short.
#pragma once

#include <chrono>
#include <string>
#include <string_view>

namespace bess {

class Progress {
 public:
  /// `unit` is the plural noun that the rate counts, e.g. "steps"; `done_before` were done by an
  /// earlier run and do not count in it.
  Progress(std::string title, std::string unit, double total, double done_before = 0);
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;
  ~Progress();

  /// Shows `done` of the total; cheap to call often. `note` is appended as it is.
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
