#include "workstation/sweep/sweep_task.h"

#include <fmt/format.h>

#include <algorithm>

#include "shared/host/text.h"
#include "shared/host/user_error.h"

namespace bess {
namespace {

std::string_view take_field(std::string_view& rest) {
  const std::size_t end = rest.find('\t');
  const std::string_view field = rest.substr(0, end);
  rest.remove_prefix(end == rest.npos ? rest.size() : end + 1);
  return field;
}

std::string joined(const Entries& settings, const char* between, const char* equals) {
  std::string text;
  for (const auto& [name, value] : settings) {
    text.append(text.empty() ? "" : between).append(name).append(equals).append(value);
  }
  return text;
}

}  // namespace

std::string SweepTask::value(std::string_view name) const {
  const auto found = std::ranges::find(settings, name, &Entries::value_type::first);
  return found == settings.end() ? std::string() : found->second;
}

Entries SweepTask::without_seed_and_fold() const {
  Entries kept = settings;
  std::erase_if(kept, [](const auto& entry) {
    return entry.first == setting::kSeed || entry.first == setting::kFold;
  });
  return kept;
}

std::string settings_text(const Entries& settings) { return joined(settings, "\t", "="); }

std::string settings_shown(const Entries& settings) {
  return settings.empty() ? "as configured" : joined(settings, ", ", " ");
}

std::string format_tasks(const std::vector<SweepTask>& tasks) {
  std::string text;
  for (const SweepTask& task : tasks) {
    fmt::format_to(std::back_inserter(text), "{}\t{}\n", task.number, settings_text(task.settings));
  }
  return text;
}

std::vector<SweepTask> parse_tasks(std::string_view text, const std::string& name) {
  std::vector<SweepTask> tasks;
  while (!text.empty()) {
    std::string_view line = take_line(text);
    SweepTask task{static_cast<int>(tasks.size()) + 1, {}};
    if (take_field(line) != std::to_string(task.number)) {
      fail("{}:{}: does not begin with its number; plan the sweep again in another folder", name,
           task.number);
    }
    while (!line.empty()) {
      const std::string_view field = take_field(line);
      const std::size_t equals = field.find('=');
      if (equals == field.npos) fail("{}:{}: \"{}\" has no value", name, task.number, field);
      task.settings.emplace_back(field.substr(0, equals), field.substr(equals + 1));
    }
    tasks.push_back(std::move(task));
  }
  return tasks;
}

}  // namespace bess
