#include "workstation/student/rule_header.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <bit>

#include "shared/host/text.h"
#include "workstation/rules/rule_file.h"
#include "workstation/student/export.h"

namespace bess {
namespace {

/// A text of several lines as one literal for each.
std::string literal_lines(std::string_view text) {
  std::string out;
  while (!text.empty()) {
    std::string literal = c_string_literal(std::string(take_line(text)));
    literal.pop_back();
    out += fmt::format(" \\\n{}\\n\"", literal);
  }
  return out;
}

std::string row_text(const GuardRule& rule) {
  std::vector<std::int32_t> fields;
  for_each_field(rule, [&fields](std::int32_t field) { fields.push_back(field); });
  return fmt::format("{{{}}},\n", fmt::join(fields, ","));
}

int lowest_member(std::int32_t bits) { return std::countr_zero(static_cast<unsigned>(bits)) + 1; }

std::string guard_tables(const ProvedStudent& student, const std::vector<GuardRule>& rules) {
  std::string rows;
  std::string names;
  for (const GuardRule& rule : rules) rows += row_text(rule);
  for (const std::string& name : student.certificate().rules.guard_rule_names()) {
    names += c_string_literal(name) + ",\n";
  }
  std::string points;
  std::string limits;
  const std::vector<RulePoint> checks = rule_check_points(rules);
  for (const RulePoint& p : checks) {
    points += fmt::format("{{{},{},{},{},{}}},\n", p.price_eur_per_mwh, p.soc_index, p.quarter_hour,
                          p.month, p.context_class);
    const RuleLimits found = rule_limits_at(rules, p);
    limits += fmt::format("{{{},{}}},\n", found.actions, found.power_permille_max);
  }
  return fmt::format(
      "#define BESS_STUDENT_GUARD_RULE_COUNT {0}\n"
      "#define BESS_STUDENT_RULES_HASH 0x{1:08x}u\n"
      "/* price, SoC index, quarter-hour first and count, months, classes, actions, power 1/1000 "
      "*/\n"
      "BESS_STUDENT_CONST int32_t bess_student_guard_rule[{0}][{2}] = {{\n{3}}};\n"
      "BESS_STUDENT_CONST char bess_student_guard_rule_name[{0}][{4}] = {{\n{5}}};\n"
      "#define BESS_STUDENT_RULE_CHECK_COUNT {6}\n"
      "BESS_STUDENT_CONST int32_t bess_student_rule_check_point[{6}][5] = {{\n{7}}};\n"
      "BESS_STUDENT_CONST int32_t bess_student_rule_check_limits[{6}][2] = {{\n{8}}};\n",
      rules.size(), ruled_hash(student_weights_hash(student.net()), rules), kGuardRuleFields, rows,
      kNameLengthMax + 1, names, checks.size(), points, limits);
}

}  // namespace

std::string rule_lines(const Certificate& certificate) {
  std::string text;
  for (std::size_t r = 0; r < certificate.rules.rules.size(); ++r) {
    const Rule& rule = certificate.rules.rules[r];
    const bool is_proved = certificate.rule_counts()[r].binds_student;
    text += fmt::format("\n     -  {}: {}{}{}", rule.name, rule.text(), guard_alone_note(is_proved),
                        is_proved && rule.enforce ? " (the guard's too)" : "");
  }
  return text;
}

std::vector<RulePoint> rule_check_points(const std::vector<GuardRule>& rules) {
  std::vector<RulePoint> points;
  for (const GuardRule& rule : rules) {
    const RuleBox& b = rule.box;
    const int last_hour = (b.quarter_hour_first + b.quarter_hour_count - 1) % kQuarterHourCount;
    const auto at = [&](int price, int soc, int hour, int month, int context_class) {
      points.push_back({price, static_cast<std::int16_t>(soc), static_cast<std::int16_t>(hour),
                        static_cast<std::int16_t>(month),
                        static_cast<std::int16_t>(context_class)});
    };
    const int month = lowest_member(b.months);
    const int context_class = lowest_member(b.context_classes);
    const int low = b.price_min_eur_per_mwh;
    const int high = b.price_max_eur_per_mwh;
    for (const int price : {low - 1, low, high, high + 1}) {
      at(price, b.soc_index_min, b.quarter_hour_first, month, context_class);
    }
    for (const int soc : {b.soc_index_min - 1, b.soc_index_max, b.soc_index_max + 1}) {
      at(low, soc, b.quarter_hour_first, month, context_class);
    }
    for (const int hour :
         {b.quarter_hour_first + kQuarterHourCount - 1, last_hour, last_hour + 1}) {
      at(low, b.soc_index_min, hour % kQuarterHourCount, month, context_class);
    }
    for (int member = 1; member <= 12; ++member) {
      at(low, b.soc_index_min, b.quarter_hour_first, member, context_class);
      at(low, b.soc_index_min, b.quarter_hour_first, month, member);
    }
  }
  return points;
}

std::string rule_section(const ProvedStudent& student) {
  const RuleSet& rules = student.certificate().rules;
  if (rules.empty()) return {};
  std::string text =
      fmt::format("#define BESS_STUDENT_RULES{}\n", literal_lines(format_rules(rules)));
  const std::vector<GuardRule> enforced = rules.guard_rules();
  if (!enforced.empty()) text += guard_tables(student, enforced);
  return text;
}

}  // namespace bess
