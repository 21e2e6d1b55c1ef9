#include "workstation/sweep/sweep_task.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>

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

SweepTask parse_line(std::string_view line, int number, const std::string& name) {
  SweepTask task;
  const std::string_view first = take_field(line);
  const auto [end, error] = std::from_chars(first.data(), first.data() + first.size(), task.number);
  if (error != std::errc{} || end != first.data() + first.size() || task.number != number) {
    fail("{}:{}: does not begin with its number; plan the sweep again in another folder", name,
         number);
  }
  while (!line.empty()) {
    const std::string_view field = take_field(line);
    const std::size_t equals = field.find('=');
    if (equals == field.npos) fail("{}:{}: \"{}\" has no value", name, number, one_line(field, 60));
    task.settings.emplace_back(field.substr(0, equals), field.substr(equals + 1));
  }
  return task;
}

}  // namespace

std::string SweepTask::value(std::string_view name) const {
  const auto found = std::ranges::find(settings, name, &Entries::value_type::first);
  return found == settings.end() ? std::string() : found->second;
}

std::string settings_text(const Entries& settings) {
  std::string text;
  for (const auto& [name, value] : settings) {
    text.append(text.empty() ? "" : "\t").append(name).append("=").append(value);
  }
  return text;
}

std::string settings_shown(const Entries& settings) {
  std::string text;
  for (const auto& [name, value] : settings) {
    text.append(text.empty() ? "" : ", ").append(name).append(" ").append(value);
  }
  return text.empty() ? "as configured" : text;
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
    tasks.push_back(parse_line(take_line(text), static_cast<int>(tasks.size()) + 1, name));
  }
  return tasks;
}

SweepTask parse_one_task(std::string_view text, int number, const std::string& name) {
  int at = 1;
  for (; at < number && !text.empty(); ++at) (void)take_line(text);
  if (number < 1 || text.empty()) {
    fail("there is no task {}: {} has {} of them", number, name, at - 1);
  }
  return parse_line(take_line(text), number, name);
}

}  // namespace bess
