#include "workstation/base/progress.h"

#include <fmt/core.h>
#include <unistd.h>

#include <cstdio>

namespace bess {
namespace {
constexpr std::chrono::milliseconds kQuietStart{2000};
constexpr std::chrono::milliseconds kTerminalInterval{250};
constexpr std::chrono::milliseconds kLogInterval{10'000};
}  // namespace

Progress::Progress(std::string title, std::string unit, double total, double done_before)
    : title_(std::move(title)),
      unit_(std::move(unit)),
      total_(total),
      done_before_(done_before),
      terminal_(isatty(STDERR_FILENO) == 1),
      next_(start_ + kQuietStart) {}

Progress::~Progress() {
  if (printed_) print(done_, note_, true);
}

void Progress::update(double done, std::string_view note) {
  done_ = done;
  note_ = note;
  if (Clock::now() < next_) return;
  print(done, note, false);
  next_ = Clock::now() + (terminal_ ? kTerminalInterval : kLogInterval);
}

void Progress::print(double done, std::string_view note, bool last) {
  const double elapsed_s = std::chrono::duration<double>(Clock::now() - start_).count();
  const double rate = elapsed_s > 0 ? (done - done_before_) / elapsed_s : 0;
  const double eta_s = rate > 0 ? (total_ - done) / rate : 0;
  const std::string time =
      last ? fmt::format("{:.0f} s", elapsed_s) : fmt::format("ETA {:.0f} s", eta_s);
  fmt::print(stderr, "{}{}: {:.0f}/{:.0f} {} ({:.3g}/s, {}){}{}{}", terminal_ ? "\r\033[K" : "",
             title_, done, total_, unit_, rate, time, note.empty() ? "" : "  ", note,
             terminal_ && !last ? "" : "\n");
  std::fflush(stderr);
  printed_ = true;
}

}  // namespace bess
