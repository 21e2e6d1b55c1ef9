// bess-train rules map: what rules change of the policy, seen: maps of the teacher and of students
// before and after, over price and charge, with the boxes where the rules hold.
#include <fmt/core.h>

#include <algorithm>
#include <charconv>
#include <cstddef>
#include <filesystem>
#include <memory>

#include "shared/host/text.h"
#include "shared/host/user_error.h"
#include "workstation/chain/common_options.h"
#include "workstation/chain/rule_files.h"
#include "workstation/cli/commands.h"
#include "workstation/report/figures/figures.h"
#include "workstation/student/student_file.h"

namespace bess {
namespace {

constexpr std::size_t kMapsMax = 3;  // side by side

struct MapArguments {
  CommonOptions common;
  RuleFiles rule_files;
  std::string teacher;
  std::vector<std::string> students;
  std::string out;
  std::vector<std::string> at = {"11@10:00", "1@20:00"};
};

/// "11@10:00": class, local hour and minute.
PolicyContext parse_context_at(const std::string& word) {
  int context_class = 0, hour = 0, minute = 0;
  const char* next = word.c_str();
  const char* const end = next + word.size();
  const auto take = [&](int& number,
                        char behind) {  // one or two characters, and what is behind them
    const auto [rest, error] =
        std::from_chars(next, next + std::min<std::ptrdiff_t>(2, end - next), number);
    if (error != std::errc() || *rest != behind) return false;
    next = rest + 1;
    return true;
  };
  if (!take(context_class, '@') || !take(hour, ':') || !take(minute, '\0') || context_class < 1 ||
      context_class > kContextClassCount || hour < 0 || hour > 23 || minute < 0 || minute > 59) {
    fail("--at {}: use month or context class, and the local time, as in 11@10:00", word);
  }
  return {.context_class = context_class,
          .quarter_hour = hour * 4 + minute / kMinutesPerQuarterHour,
          .minute_of_quarter_hour = minute % kMinutesPerQuarterHour};
}

std::string name_of(const StudentFile& student) {
  const std::vector<Rule>& rules = student.certificate.rules.rules;
  if (rules.empty()) return "student without rules";
  if (rules.size() > 1) return "student with " + counted(rules.size(), "rule");
  return fmt::format("with '{}'", rules.front().name);
}

void run_rules_map(const MapArguments& options) {
  const RunConfig config = options.common.resolve();
  std::optional<Teacher> teacher;
  if (!options.teacher.empty()) teacher = load_teacher(options.teacher);
  std::vector<StudentFile> students;
  for (const std::string& path : options.students) students.push_back(load_student(path));
  if (students.size() + (teacher ? 1 : 0) > kMapsMax) {
    fail("--student: {} maps at most are drawn side by side, the teacher's included", kMapsMax);
  }
  const ContextClasses classes = students.front().net.context;
  const auto differs = [&](const ContextClasses& other) { return other.kind != classes.kind; };
  if ((teacher && differs(teacher->context)) ||
      std::ranges::any_of(students, differs, [](const StudentFile& s) { return s.net.context; })) {
    fail("--student, --teacher: some are by month and some by price level");
  }
  const RuleSet rules =
      options.rule_files.given() ? options.rule_files.read() : students.back().certificate.rules;
  for (const std::string& word : options.at) {
    const PolicyContext context = parse_context_at(word);
    std::vector<NamedPolicyMap> maps;
    if (teacher) maps.push_back({"teacher", teacher_grid(*teacher, context)});
    for (const StudentFile& student : students) {
      maps.push_back({name_of(student), student_grid(student.net, context)});
    }
    const Figure figure = policy_map_figure(context, classes, maps, rules, config.battery, "");
    draw_figure(figure, options.out);
    fmt::print("{}\n{}\n", (std::filesystem::path(options.out) / (figure.name + ".svg")).string(),
               figure.caption);
  }
}

}  // namespace

void add_rules_map(ProgramCommand& rules) {
  auto options = std::make_shared<MapArguments>();
  ProgramCommand command = rules.subcommand(
      "map", "What rules change, as maps over price and charge: SVG, light and dark");
  command.option("--student", options->students, "Student files, from before to after").required();
  command.option("--teacher", options->teacher, "Teacher file: its map comes first");
  options->rule_files.add(
      command, "Rule files whose boxes are outlined (default: the rules of the last student)");
  command.option("--out", options->out, "Folder for policy_map_CLASS_TIME.svg").required();
  command
      .option("--at", options->at,
              "Month or context class and local time of each map, as in 11@10:00")
      .with_default();
  options->common.add_config(command);
  command.footer(
      "Example:\n"
      "  bess-train rules map --teacher teacher.bin --student student_before.json student.json "
      "--out maps");
  command.runs([options] { run_rules_map(*options); });
}

}  // namespace bess
