#include "workstation/sweep/task_states.h"

#include <fmt/format.h>

#include <charconv>

#include "shared/host/text.h"
#include "shared/host/user_error.h"
#include "workstation/sweep/attempt.h"
#include "workstation/sweep/learn_task.h"

namespace bess {
namespace {

namespace fs = std::filesystem;

/// Of a folder's name; 0 when it is none.
int number_of(const fs::path& path) {
  const std::string name = path.filename().string();
  int number = 0;
  const auto [end, error] = std::from_chars(name.data(), name.data() + name.size(), number);
  return error == std::errc{} && end == name.data() + name.size() ? number : 0;
}

template <typename Take>
void for_each_number(const fs::path& folder, int count, const Take& take) {
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    const int number = number_of(entry.path());
    if (number >= 1 && number <= count) take(number, entry.path());
  }
}

int entry_count(const fs::path& folder) {
  std::error_code error;
  int count = 0;
  for ([[maybe_unused]] const auto& entry : fs::directory_iterator(folder, error)) ++count;
  return count;
}

}  // namespace

std::vector<TaskState> task_states(const SweepFolder& folder, int count) {
  std::vector<TaskState> states(static_cast<std::size_t>(count), TaskState::kMissing);
  const auto state = [&](int task) -> TaskState& {
    return states[static_cast<std::size_t>(task - 1)];
  };
  std::error_code error;
  for (const auto& thousand : fs::directory_iterator(folder.results(), error)) {
    for_each_number(thousand.path(), count, [&](int task, const fs::path& result) {
      if (!is_published(folder, task)) return;
      state(task) = is_proved(result) ? TaskState::kProved : TaskState::kUnproved;
    });
  }
  for_each_number(folder.path / "attempts", count, [&](int task, const fs::path&) {
    if (state(task) == TaskState::kMissing) count_dead_attempts(folder, task);
  });
  for_each_number(folder.path / "failures", count, [&](int task, const fs::path&) {
    const bool is_given_up = failures_of(folder, task).size() >= std::size_t{kFailuresMax};
    if (state(task) == TaskState::kMissing && is_given_up) state(task) = TaskState::kFailed;
  });
  return states;
}

SweepCounts counts_of(const SweepFolder& folder, const std::vector<TaskState>& states) {
  SweepCounts counts;
  counts.planned = static_cast<int>(states.size());
  for (const TaskState state : states) {
    counts.proved += state == TaskState::kProved ? 1 : 0;
    counts.unproved += state == TaskState::kUnproved ? 1 : 0;
    counts.failed += state == TaskState::kFailed ? 1 : 0;
    counts.missing += state == TaskState::kMissing ? 1 : 0;
  }
  for_each_number(folder.path / "attempts", counts.planned,
                  [&](int, const fs::path& at) { counts.attempts += entry_count(at); });
  counts.different = entry_count(folder.different());
  return counts;
}

std::vector<int> missing_tasks(const std::vector<TaskState>& states) {
  std::vector<int> missing;
  for (std::size_t t = 0; t < states.size(); ++t) {
    if (states[t] == TaskState::kMissing) missing.push_back(static_cast<int>(t) + 1);
  }
  return missing;
}

std::string ranges_text(const std::vector<int>& numbers) {
  std::string text;
  for (std::size_t i = 0; i < numbers.size();) {
    std::size_t end = i + 1;
    while (end < numbers.size() && numbers[end] == numbers[end - 1] + 1) ++end;
    text += fmt::format("{}{}", text.empty() ? "" : ",", numbers[i]);
    if (end - i > 1) text += fmt::format("-{}", numbers[end - 1]);
    i = end;
  }
  return text;
}

std::vector<int> parse_ranges(const std::string& text, const std::string& where) {
  std::vector<int> numbers;
  const char* at = text.data();
  const char* const end = at + text.size();
  const auto number = [&] {
    int value = 0;
    const auto [stop, error] = std::from_chars(at, end, value);
    if (error != std::errc{} || value < 1) {
      fail("{}: \"{}\" is no list of tasks: write 1-4,9", where, one_line(text, 60));
    }
    at = stop;
    return value;
  };
  while (at < end) {
    const int first = number();
    int last = first;
    if (at < end && *at == '-') {
      ++at;
      last = number();
    }
    if (last < first || last - first > 1'000'000 || (at < end && *at != ',')) {
      fail("{}: \"{}\" is no list of tasks: write 1-4,9", where, one_line(text, 60));
    }
    for (int n = first; n <= last; ++n) numbers.push_back(n);
    if (at < end) ++at;
  }
  return numbers;
}

}  // namespace bess
