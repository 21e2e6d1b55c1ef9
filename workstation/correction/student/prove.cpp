#include "workstation/correction/student/prove.h"

#include <fmt/core.h>

#include <algorithm>
#include <numeric>

#include "shared/host/csv.h"
#include "workstation/correction/rules/rule_conflicts.h"

namespace bess {

namespace {

constexpr double kPercentPerSocIndex = 100.0 / (kSocCount - 1);
constexpr const char* kMoreEffort = "raise [distil] epochs or repair_rounds";
/// Largest price distance at which an opposite demand explains why a rule is not learned.
constexpr int kNearEurPerMwh = 200;

bool holds_at(const Rule& rule, ContextKind kind, const LatticeState& s) {
  return holds_in_context(rule.box, kind, s.quarter_hour, s.context_class) &&
         lattice_box_of(rule.box, kind)
             .contains(s.soc_index, s.price_eur_per_mwh - kLatticePriceMinEurPerMwh);
}

struct Example {
  LatticeState state;
  std::string text;
};

std::optional<Example> example_of(const StudentFile& student, const Rule& rule) {
  const StudentNet& net = student.net;
  const ContextKind kind = net.context.kind;
  RuleCount known;
  std::ranges::copy_if(student.certificate.counterexamples,
                       std::back_inserter(known.counterexamples),
                       [&](const LatticeState& s) { return holds_at(rule, kind, s); });
  const std::optional<RuleInput> along = rule.demand->pairs_along();
  if (!along) {
    const auto worst = worst_state(net, rule, known);
    if (!worst) return {};
    return Example{worst->state, fmt::format("{} at {}", action_name(worst->action),
                                             state_text(worst->state, kind))};
  }
  for (const LatticeState& state : known.counterexamples) {
    const auto next = next_state(state, *along);
    if (!next) continue;
    const Action here = net.decide(state);
    const Action there = net.decide(*next);
    if (!rule.demand->is_broken(here, there)) continue;
    return Example{state,
                   fmt::format("{} at {}, and {} at {}", action_name(here), state_text(state, kind),
                               action_name(there), state_text(*next, kind))};
  }
  return {};
}

std::string room_text(const Opposite& opposite) {
  std::string room;
  if (opposite.price_gap_eur_per_mwh > 0) {
    room = fmt::format("{} EUR/MWh", opposite.price_gap_eur_per_mwh);
  }
  if (opposite.soc_gap > 0) {
    room += fmt::format("{}{:g} % SoC", room.empty() ? "" : " and ",
                        opposite.soc_gap * kPercentPerSocIndex);
  }
  return room;
}

std::string advice_of(const Certificate& certificate, ContextKind kind, const Rule& rule,
                      CorrectionMethod method) {
  const bool by_layer = method == CorrectionMethod::kLayer;
  if (by_layer && rule.property != 0) {
    return "raise [correction] price_slope and soc_slope or [distil] repair_rounds";
  }
  if (by_layer && !rule.has_rows()) {
    return "the layer has no rows for it: use [distil] method = \"construction\"";
  }
  const auto opposite = nearest_opposite(certificate.rules, certificate.thresholds, kind, rule);
  if (!opposite || opposite->price_gap_eur_per_mwh > kNearEurPerMwh) return kMoreEffort;
  return fmt::format("keep more than {} from \"{}\", which requires the opposite, or {}",
                     room_text(*opposite), opposite->name, kMoreEffort);
}

}  // namespace

std::string state_text(const LatticeState& s, ContextKind kind) {
  return fmt::format("{} {}, {}, minute {}, SoC {:g} %, {} EUR/MWh",
                     kind == ContextKind::kMonth ? "month" : "context class", s.context_class,
                     hour_text(s.quarter_hour), s.minute_of_quarter_hour,
                     s.soc_index * kPercentPerSocIndex, s.price_eur_per_mwh);
}

std::vector<BrokenDemand> broken_demands(const StudentFile& student, CorrectionMethod method) {
  std::vector<BrokenDemand> broken;
  for (const DemandCount& count : demand_counts(student.certificate)) {
    if (count.violations == 0) continue;
    std::optional<Example> example;
    for (const Rule& rule : count.rules) {
      if (!example) example = example_of(student, rule);
    }
    BrokenDemand demand{
        count, "",
        advice_of(student.certificate, student.net.context.kind, count.rules.front(), method)};
    if (example) {
      demand.example = example->text;
      demand.state = example->state;
    }
    broken.push_back(std::move(demand));
  }
  return broken;
}

std::string describe_failed_proof(const StudentFile& student, const std::vector<ProofRound>& rounds,
                                  CorrectionMethod method, const std::string& where,
                                  const std::string& note) {
  constexpr std::size_t kShown = 20;  // rounds
  const std::size_t first = rounds.size() > kShown ? rounds.size() - kShown : 0;
  std::string by_round = first > 0 ? "..., " : "";
  bool any_is_a_look = false;
  for (std::size_t i = first; i < rounds.size(); ++i) {
    by_round += fmt::format("{}{}", rounds[i].violations(), i + 1 < rounds.size() ? ", " : "");
    any_is_a_look = any_is_a_look || !rounds[i].is_whole;
  }
  std::string text = fmt::format(
      "{}{} violations are left after {} round{} (by round {}{}){}", where,
      student.certificate.violations(), rounds.size(), rounds.size() == 1 ? "" : "s", by_round,
      any_is_a_look ? "; rounds without a proof count deciding states only" : "", note);
  for (const BrokenDemand& demand : broken_demands(student, method)) {
    text +=
        fmt::format("\n  {} ({}): {} violations{}{}; {}", demand.count.label(), demand.count.text,
                    demand.count.violations, demand.example.empty() ? "" : ", its action is ",
                    demand.example, demand.advice);
  }
  return text;
}

namespace {

constexpr std::string_view kHeader =
    "minute_of_quarter_hour,quarter_hour,context_class,soc_index,price_eur_per_mwh";

}  // namespace

std::string counterexamples_csv(const std::vector<LatticeState>& states) {
  std::string text = fmt::format("{}\n", kHeader);
  for (const LatticeState& s : states) {
    text += fmt::format("{},{},{},{},{}\n", s.minute_of_quarter_hour, s.quarter_hour,
                        s.context_class, s.soc_index, s.price_eur_per_mwh);
  }
  return text;
}

std::vector<LatticeState> parse_counterexamples_csv(std::string_view text,
                                                    const std::string& name) {
  std::vector<LatticeState> states;
  if (text == fmt::format("{}\n", kHeader)) return states;
  const CsvTable table(text, name, kHeader);
  for (std::size_t row = 0; row < table.row_count(); ++row) {
    const auto whole = [&](std::size_t column, std::int64_t low, std::int64_t high) {
      return static_cast<std::int16_t>(table.whole(row, column, low, high));
    };
    states.push_back({whole(0, 0, kMinuteOfQuarterHourCount - 1),
                      whole(1, 0, kQuarterHourCount - 1), whole(2, 1, kContextClassCount),
                      whole(3, 0, kSocCount - 1),
                      whole(4, kLatticePriceMinEurPerMwh, kLatticePriceMaxEurPerMwh)});
  }
  return states;
}

static_assert(std::gcd(kSampleStride, kContextCount) == 1);

namespace {

/// With the certificate of a check by these options, for the student's thresholds and rules.
StudentFile checked(StudentFile student, VerifyOptions options) {
  check_net(student.net, "the student");
  Certificate& certificate = student.certificate;
  // A student by outlook owes the demand on its classes, whatever rules its file or a user names.
  if (student.net.context.is_outlook()) certificate.rules = with_outlook_rule(certificate.rules);
  options.thresholds = certificate.thresholds;
  options.rules = certificate.rules;
  certificate = verify_student(student.net, options);
  return student;
}

}  // namespace

Verdict prove(StudentFile student, int threads, bool exhaustive) {
  student = checked(std::move(student), {.exhaustive = exhaustive, .threads = threads});
  if (!student.certificate.covers_lattice_without_violation()) return student;
  return ProvedStudent(std::move(student));
}

StudentFile sample_violations(StudentFile student, int threads) {
  return checked(std::move(student), {.context_stride = kSampleStride, .threads = threads});
}

const StudentFile& student_of(const Verdict& verdict) {
  const auto* proved = std::get_if<ProvedStudent>(&verdict);
  return proved != nullptr ? proved->file() : std::get<StudentFile>(verdict);
}

}  // namespace bess
