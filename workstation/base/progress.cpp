#include "workstation/base/progress.h"

#include <fmt/core.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>

#include "shared/host/text.h"

namespace bess {
namespace {
constexpr std::chrono::milliseconds kQuietStart{2000};
constexpr std::chrono::milliseconds kTerminalInterval{250};
constexpr std::chrono::milliseconds kLogInterval{60'000};
constexpr std::size_t kColumns = 80;  // when the width is unknown
constexpr std::size_t kNoteMin = 8;   // shorter notes are omitted

/// One less than the terminal's width: some terminals wrap after a full row.
std::size_t terminal_columns() {
  winsize size{};
  const bool is_known = ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0;
  return (is_known ? size.ws_col : kColumns) - 1;
}

std::string duration_text(double seconds) {
  if (!(seconds < 100 * 3600)) return "days";
  const auto s = static_cast<std::int64_t>(seconds + 0.5);
  if (s < 600) return fmt::format("{} s", s);
  if (s < 6000) return fmt::format("{} min", (s + 30) / 60);
  return fmt::format("{} h {:02} min", s / 3600, s % 3600 / 60);
}

}  // namespace

std::string progress_line(std::string_view title, std::string_view unit, const ProgressState& state,
                          std::string_view note, std::size_t columns) {
  const double left_s = (state.total - state.done) / state.rate_per_s;
  const std::string time = state.is_over          ? duration_text(state.elapsed_s)
                           : state.rate_per_s > 0 ? "ETA " + duration_text(left_s)
                                                  : "ETA unknown";
  const std::string rate =
      fmt::format(fmt::runtime(state.rate_per_s < 999.5 ? "{:.3g}" : "{:.0f}"), state.rate_per_s);
  std::string line = fmt::format("{}: {:.0f}/{:.0f} {} ({}/s, {})", title, state.done, state.total,
                                 unit, rate, time);
  if (!note.empty() && line.size() + 2 + std::min(note.size(), kNoteMin) <= columns) {
    line.append("  ").append(one_line(note, columns - line.size() - 2));
  }
  line.resize(std::min(line.size(), columns));
  return line;
}

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

void Progress::advance(std::string_view note) {
  const std::lock_guard lock(mutex_);
  update(done_ + 1, note);
}

void Progress::print(double done, std::string_view note, bool last) {
  const double elapsed_s = std::chrono::duration<double>(Clock::now() - start_).count();
  const double rate_per_s = elapsed_s > 0 ? (done - done_before_) / elapsed_s : 0;
  const ProgressState state{done, total_, rate_per_s, elapsed_s, last};
  const std::size_t columns = terminal_ ? terminal_columns() : kColumns;
  fmt::print(stderr, "{}{}{}", terminal_ ? "\r\033[K" : "",
             progress_line(title_, unit_, state, note, columns), terminal_ && !last ? "" : "\n");
  std::fflush(stderr);
  printed_ = true;
}

}  // namespace bess
