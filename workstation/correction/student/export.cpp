#include "workstation/correction/student/export.h"

#include <fmt/core.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <bit>
#include <cmath>
#include <memory>
#include <span>
#include <vector>

#include "shared/decision_signature.h"
#include "shared/host/text.h"
#include "shared/outlook/outlook_plan.h"
#include "shared/soc_latches.h"
#include "shared/training_period.h"
#include "workstation/base/random.h"

namespace bess {

namespace {

/// One string literal per line of text.
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

std::string guard_tables(const StudentFile& student, const std::vector<GuardRule>& rules) {
  std::string rows;
  std::string names;
  for (const GuardRule& rule : rules) rows += row_text(rule);
  for (const Rule& rule : student.certificate.rules.rules) {
    if (rule.enforce) names += c_string_literal(rule.name) + ",\n";
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
      rules.size(), ruled_hash(student_weights_hash(student.net), rules), kGuardRuleFields, rows,
      kNameLengthMax + 1, names, checks.size(), points, limits);
}

/// One line per rule, after the three properties; empty without rules.
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

/// Macros and tables; empty without rules.
std::string rule_section(const StudentFile& student) {
  const RuleSet& rules = student.certificate.rules;
  if (rules.empty()) return {};
  std::string text =
      fmt::format("#define BESS_STUDENT_RULES{}\n", literal_lines(format_rules(rules)));
  const std::vector<GuardRule> enforced = rules.guard_rules();
  if (!enforced.empty()) text += guard_tables(student, enforced);
  return text;
}

constexpr int kHeaderVersion = 3;
constexpr int kRandomSelfChecks = 56;
constexpr std::uint64_t kSelfCheckSeed = 2024;

/// One writer per shape: scalar, vector, matrix.
std::string scalar(std::string_view type, std::string_view name, std::int64_t value) {
  return fmt::format("BESS_STUDENT_CONST {} bess_student_{} = {};\n", type, name, value);
}

template <typename Values>
std::string wrapped(const Values& values) {
  std::string text;
  std::size_t line_start = 0;
  for (const auto value : values) {
    const std::string item = fmt::format("{},", value);
    if (text.size() - line_start + item.size() > 98) {
      text += '\n';
      line_start = text.size();
    }
    text += item;
  }
  if (!text.empty()) text.pop_back();
  return text;
}

template <typename T, std::size_t kCount>
std::string vector(std::string_view type, std::string_view name, const T (&values)[kCount]) {
  return fmt::format("BESS_STUDENT_CONST {} bess_student_{}[{}] = {{\n{}\n}};\n", type, name,
                     kCount, wrapped(values));
}

template <typename T, std::size_t kRows, std::size_t kColumns>
std::string matrix(std::string_view type, std::string_view name,
                   const T (&values)[kRows][kColumns]) {
  std::string text = fmt::format("BESS_STUDENT_CONST {} bess_student_{}[{}][{}] = {{\n", type, name,
                                 kRows, kColumns);
  for (const auto& row : values) text += fmt::format("{{{}}},\n", wrapped(row));
  return text + "};\n";
}

std::vector<LatticeState> self_check_states() {
  std::vector<LatticeState> states;
  for (int corner = 0; corner < 8; ++corner) {
    const bool last = (corner & 1) != 0;
    states.push_back({static_cast<std::int16_t>(last ? kMinuteOfQuarterHourCount - 1 : 0),
                      static_cast<std::int16_t>(last ? kQuarterHourCount - 1 : 0),
                      static_cast<std::int16_t>(last ? kContextClassCount : 1),
                      static_cast<std::int16_t>((corner & 2) != 0 ? kSocCount - 1 : 0),
                      static_cast<std::int16_t>((corner & 4) != 0 ? kLatticePriceMaxEurPerMwh
                                                                  : kLatticePriceMinEurPerMwh)});
  }
  Random random(kSelfCheckSeed);
  for (int i = 0; i < kRandomSelfChecks; ++i) {
    states.push_back({static_cast<std::int16_t>(random.index(kMinuteOfQuarterHourCount)),
                      static_cast<std::int16_t>(random.index(kQuarterHourCount)),
                      static_cast<std::int16_t>(1 + random.index(kContextClassCount)),
                      static_cast<std::int16_t>(random.index(kSocCount)),
                      static_cast<std::int16_t>(kLatticePriceMinEurPerMwh +
                                                static_cast<int>(random.index(kPriceCount)))});
  }
  return states;
}

std::string self_checks(const StudentNet& net) {
  std::string states;
  std::string answers;
  const std::vector<LatticeState> all = self_check_states();
  for (const LatticeState& s : all) {
    std::int16_t x[kStudentInputs];
    std::int32_t logits[kActionCount];
    net.quantise(s, x);
    net.propagate(x, logits);
    states += fmt::format("{{{},{},{},{},{}}},\n", s.minute_of_quarter_hour, s.quarter_hour,
                          s.context_class, s.soc_index, s.price_eur_per_mwh);
    answers += fmt::format("{{{}}},\n", fmt::join(logits, ","));
  }
  return fmt::format(
      "#define BESS_STUDENT_SELF_CHECK_COUNT {0}\n"
      "BESS_STUDENT_CONST int16_t bess_student_self_check_state[{0}][{1}] = {{\n{3}}};\n"
      "BESS_STUDENT_CONST int32_t bess_student_self_check_logits[{0}][{2}] = {{\n{4}}};\n",
      all.size(), kStudentInputs, kActionCount, states, answers);
}

/// Comment at the head: contents and result of the proof.
std::string preamble(const Certificate& c) {
  return fmt::format(
      "/* Generated by bess-train export. Do not edit: export again.\n"
      "   The 5-64-32-3 integer student: price_map and layer arrays as in "
      "shared/nn/student_net.h.\n"
      "   Proved over all {} lattice states, {} of them evaluated one by one, with no violation "
      "of\n"
      "     1  {}{}\n"
      "     2  {}{}\n"
      "     3  never a larger action at a higher price or SoC{} */\n",
      c.states_checked, c.states_evaluated, property_text(1, c.thresholds),
      guard_alone_note(c.thresholds.low_binds_student()), property_text(2, c.thresholds),
      guard_alone_note(c.thresholds.high_binds_student()), rule_lines(c));
}

std::string certificate_macros(const Certificate& c) {
  return fmt::format(
      "#define BESS_STUDENT_LOW_PRICE_EUR_PER_MWH ({})\n"
      "#define BESS_STUDENT_HIGH_PRICE_EUR_PER_MWH ({})\n"
      "#define BESS_STUDENT_STATES_CHECKED INT64_C({})\n"
      "#define BESS_STUDENT_STATES_EVALUATED INT64_C({})\n"
      "#define BESS_STUDENT_VIOLATIONS_PROPERTY_1 {}\n"
      "#define BESS_STUDENT_VIOLATIONS_PROPERTY_2 {}\n"
      "#define BESS_STUDENT_VIOLATIONS_PROPERTY_3 {}\n",
      c.thresholds.low_eur_per_mwh, c.thresholds.high_eur_per_mwh, c.states_checked,
      c.states_evaluated, c.violations_of(1), c.violations_of(2), c.violations_of(3));
}

/// Training days and full cycles per day, for information only.
std::string training_macros(const StudentFile& student) {
  std::string text;
  if (const auto span = learnt_span(student.learnt_for)) {
    text += fmt::format(
        "#define BESS_STUDENT_TRAINED_FROM \"{}\"\n#define BESS_STUDENT_TRAINED_UNTIL \"{}\"\n",
        local_date_text(span->from_s).view(), local_date_text(span->until_s - 1).view());
  }
  if (student.cycles_per_day) {
    text += fmt::format("#define BESS_STUDENT_CYCLES_PER_DAY_E2 {}\n",
                        std::lround(*student.cycles_per_day * 100));
  }
  return text;
}

/// The plan's model as one array with named parts, and a check value of the exporter's plans.
std::string outlook_section(const OutlookModel& model) {
  std::string numbers;
  int size = 0;
  OutlookModel::visit(model, [&](const char* name, const std::int32_t* values, int count) {
    numbers += fmt::format("/* {} */\n{},\n", name,
                           wrapped(std::span(values, static_cast<std::size_t>(count))));
    size += count;
  });
  const auto plan = std::make_unique<OutlookPlan>();
  return fmt::format(
      "#define BESS_STUDENT_OUTLOOK_HASH 0x{:08x}u\n"
      "#define BESS_STUDENT_OUTLOOK_CHECK 0x{:08x}u\n"
      "/* Of the plan on day-ahead prices: shared/outlook/outlook_model.h */\n"
      "BESS_STUDENT_CONST int32_t bess_student_outlook[{}] = {{\n{}}};\n",
      model.hash(), outlook_check(model, *plan), size, numbers);
}

/// Normal operation of the edge's guard: thresholds, rules and SoC limits only.
class GuardWithoutLimits final : public ReplayedDecider {
 public:
  GuardWithoutLimits(const StudentNet& net, const std::vector<GuardRule>& rules)
      : net_(net), rules_(rules) {}

  std::int32_t power_w(const ReplayedMoment& m) override {
    soc_.update(m.soc_e4);
    const LocalMinute now = local_minute_of(m.now_utc_s);
    const std::int16_t context_class = net_.context.class_of(now.month, m.context_centi);
    const LatticeState state =
        make_lattice_state(now, context_class, m.soc_e4, m.price_centi_eur_per_mwh);
    Action requested = PriceThresholds{}.action_beyond(m.price_centi_eur_per_mwh);
    if (requested == Action::kIdle) requested = net_.decide(state);
    const RuleLimits limits =
        rule_limits_at(rules_, rule_point(now, state, m.price_centi_eur_per_mwh));
    const std::int32_t power_w =
        ruled_power_w(limits, power_sign(requested) * kReplayedPowerW, kReplayedPowerW);
    const bool is_closed = power_w > 0 ? soc_.is_full : soc_.is_empty;
    return is_closed ? 0 : power_w;
  }

 private:
  const StudentNet& net_;
  const std::vector<GuardRule>& rules_;
  SocLatches soc_{kReplayedSocMinE4, kReplayedSocMaxE4, kReplayedSocHysteresisE4};
};

}  // namespace

std::string format_weight_header(const ProvedStudent& proved) {
  const StudentFile& student = proved.file();
  const StudentNet& net = student.net;
  std::string text = preamble(student.certificate);
  text += fmt::format(
      "#pragma once\n"
      "/* clang-format off */\n"
      "#include <stdint.h>\n"
      "#ifdef __cplusplus\n#define BESS_STUDENT_CONST inline constexpr\n"
      "#else\n#define BESS_STUDENT_CONST static const\n#endif\n"
      "#define BESS_STUDENT_VERSION {}\n"
      "#define BESS_STUDENT_ARCHITECTURE_HASH 0x{:08x}u\n"
      "#define BESS_STUDENT_WEIGHTS_HASH 0x{:08x}u\n",
      kHeaderVersion, student_architecture_hash(), student_weights_hash(net));
  text += certificate_macros(student.certificate);
  text += fmt::format("#define BESS_STUDENT_PROVENANCE {}\n", c_string_literal(student.provenance));
  text += training_macros(student);
  text += fmt::format("#define BESS_STUDENT_CONTEXT_IS_LEVEL {}\n",
                      net.context.kind == ContextKind::kLevel ? 1 : 0);
  text += vector("int16_t", "level_edge_eur_per_mwh", net.context.level_edge_eur_per_mwh);
  text += vector("int16_t", "price_map", net.price_map);
  text += matrix("int16_t", "layer1_weight", net.layer1.weight);
  text += vector("int32_t", "layer1_bias", net.layer1.bias);
  text += scalar("int32_t", "relu1_shift", net.relu1.shift);
  text += matrix("int16_t", "layer2_weight", net.layer2.weight);
  text += vector("int32_t", "layer2_bias", net.layer2.bias);
  text += scalar("int32_t", "relu2_shift", net.relu2.shift);
  text += matrix("int16_t", "layer3_weight", net.layer3.weight);
  text += vector("int32_t", "layer3_bias", net.layer3.bias);
  text += self_checks(net);
  text += rule_section(student);
  if (student.outlook) text += outlook_section(student.outlook->model());
  return text + "/* clang-format on */\n";
}

std::string decision_signature_line(const StudentFile& student) {
  const std::vector<GuardRule> rules = student.certificate.rules.guard_rules();
  const OutlookModel* const outlook = student.outlook ? &student.outlook->model() : nullptr;
  GuardWithoutLimits guard(student.net, rules);
  const std::uint32_t hash = hash_by_outlook(ruled_hash(student_weights_hash(student.net), rules),
                                             outlook != nullptr ? outlook->hash() : 0);
  return signature_line(hash, replay_recorded_days(guard, outlook)).c_str();
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

std::string c_string_literal(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    const char shown = c >= ' ' && c <= '~' ? c : '?';
    if (shown == '"' || shown == '\\' || shown == '?') out += '\\';
    out += shown;
  }
  return out + '"';
}

}  // namespace bess
