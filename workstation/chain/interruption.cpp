#include "workstation/chain/interruption.h"

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <string_view>
#include <thread>

#include "shared/host/unfinished_files.h"

namespace bess {
namespace {

constexpr int kExitInterrupted = 3;
constexpr int kExitInterruptedTwice = 130;  // what a shell gives a program that Ctrl-C killed

char note_text[512] = "";  // a handler may not allocate
std::atomic<std::size_t> note_size{0};

void say(std::string_view text) {
  [[maybe_unused]] const auto written = write(STDERR_FILENO, text.data(), text.size());
}

[[noreturn]] void end_now(int exit_code) {
  remove_unfinished_files();
  say("\n");
  say({note_text, note_size.load()});
  say("bess-train: interrupted\n");
  _exit(exit_code);
}

void handle_with(void (*handler)(int)) {
  std::signal(SIGINT, handler);
  std::signal(SIGTERM, handler);
}

}  // namespace

void end_when_interrupted(const std::string& note) {
  const std::string line = note.empty() ? "" : note + "\n";
  note_size = 0;
  const std::size_t size = std::min(line.size(), sizeof note_text);
  std::copy_n(line.data(), size, note_text);
  note_size = size;
  handle_with([](int) { end_now(kExitInterrupted); });
}

std::atomic<bool>& interruption() {
  static std::atomic<bool> interrupted{false};
  static_assert(std::atomic<bool>::is_always_lock_free);
  return interrupted;
}

void watch_interruption() {
  interruption();  // constructed before a signal can come
  handle_with([](int) {
    if (interruption().exchange(true)) end_now(kExitInterruptedTwice);
  });
}

std::function<bool()> watched_from_the_first_look() {
  return [watching = false]() mutable {
    if (!watching) watch_interruption();
    watching = true;
    return interruption().load();
  };
}

void sleep_unless(double seconds, const std::atomic<bool>& interrupted) {
  using Clock = std::chrono::steady_clock;
  const auto end = Clock::now() + std::chrono::duration<double>(seconds);
  while (!interrupted && Clock::now() < end) {
    const std::chrono::duration<double> left = end - Clock::now();
    std::this_thread::sleep_for(std::min(left, std::chrono::duration<double>(0.1)));
  }
}

}  // namespace bess
