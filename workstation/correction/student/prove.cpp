#include "workstation/correction/student/prove.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <numeric>

#include "shared/host/csv.h"
#include "shared/host/user_error.h"
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

/// No effect if no state that violates the rule is known.
void add_example(const StudentFile& student, const Rule& rule, BrokenDemand& demand) {
  const StudentNet& net = student.net;
  const ContextKind kind = net.context.kind;
  RuleCount known;
  std::ranges::copy_if(student.certificate.counterexamples,
                       std::back_inserter(known.counterexamples),
                       [&](const LatticeState& s) { return holds_at(rule, kind, s); });
  const std::optional<RuleInput> along = rule.demand->pairs_along();
  if (!along) {
    const auto worst = worst_state(net, rule, known);
    if (!worst) return;
    demand.state = worst->state;
    demand.example =
        fmt::format("{} at {}", action_name(worst->action), state_text(worst->state, kind));
    return;
  }
  for (const LatticeState& state : known.counterexamples) {
    const auto next = next_state(state, *along);
    if (!next) continue;
    const Action here = net.decide(state);
    const Action there = net.decide(*next);
    if (!rule.demand->is_broken(here, there)) continue;
    demand.state = state;
    demand.example =
        fmt::format("{} at {}, and {} at {}", action_name(here), state_text(state, kind),
                    action_name(there), state_text(*next, kind));
    return;
  }
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

constexpr std::string_view kCounterexampleHeader =
    "minute_of_quarter_hour,quarter_hour,context_class,soc_index,price_eur_per_mwh";

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

constexpr std::string_view kRoundsHeader = "round,looked_at,demand,violations";
constexpr std::string_view kLattice = "lattice";
constexpr std::string_view kCorners = "corners";

constexpr std::string_view kCheckpointHeader = "round,epoch,validation_eur_per_day_per_mwh,state";
constexpr std::array<std::string_view, 3> kStates{"passed over", "disobeys", "chosen"};

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
    BrokenDemand demand{
        count, "",
        advice_of(student.certificate, student.net.context.kind, count.rules.front(), method)};
    for (const Rule& rule : count.rules) {
      if (!demand.state) add_example(student, rule, demand);
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

std::string counterexamples_csv(const std::vector<LatticeState>& states) {
  std::string text = fmt::format("{}\n", kCounterexampleHeader);
  for (const LatticeState& s : states) {
    text += fmt::format("{},{},{},{},{}\n", s.minute_of_quarter_hour, s.quarter_hour,
                        s.context_class, s.soc_index, s.price_eur_per_mwh);
  }
  return text;
}

std::vector<LatticeState> parse_counterexamples_csv(std::string_view text,
                                                    const std::string& name) {
  std::vector<LatticeState> states;
  if (text == fmt::format("{}\n", kCounterexampleHeader)) return states;
  const CsvTable table(text, name, kCounterexampleHeader);
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

std::int64_t ProofRound::violations() const {
  std::int64_t sum = 0;
  for (const DemandLeft& demand : left) sum += demand.violations;
  return sum;
}

std::string ProofRound::text() const {
  std::string text;
  for (const DemandLeft& demand : left) {
    if (demand.violations == 0) continue;
    text += fmt::format("{}{}: {}", text.empty() ? "" : ", ", demand.label, demand.violations);
  }
  return text;
}

ProofRound round_of(const Certificate& certificate) {
  ProofRound round;
  for (const DemandCount& count : demand_counts(certificate)) {
    if (count.binds_student) round.left.push_back({count.label(), count.violations});
  }
  return round;
}

std::string round_line(const ProofRound& round, const RoundsState& state) {
  const std::string head = fmt::format("round {} of at most {}", state.done, state.most);
  if (round.violations() == 0) return head + ": no violation";
  const double seconds = state.seconds_left;
  const std::string time =
      seconds < 90 ? fmt::format("{:.0f} s", seconds) : fmt::format("{:.0f} min", seconds / 60);
  const std::string more =
      state.done < state.most ? fmt::format("; at most {} more and a proof", time) : "";
  return fmt::format("{}: {} left{}{}", head, round.text(),
                     round.is_whole ? "" : " at the deciding states", more);
}

std::string proof_rounds_csv(const std::vector<ProofRound>& rounds) {
  std::string text = fmt::format("{}\n", kRoundsHeader);
  for (std::size_t i = 0; i < rounds.size(); ++i) {
    for (const DemandLeft& demand : rounds[i].left) {
      text += fmt::format("{},{},{},{}\n", i + 1, rounds[i].is_whole ? kLattice : kCorners,
                          csv_field(demand.label), demand.violations);
    }
  }
  return text;
}

std::vector<ProofRound> parse_proof_rounds_csv(std::string_view text, const std::string& name) {
  const CsvTable table(text, name, kRoundsHeader);
  std::vector<ProofRound> rounds;
  for (std::size_t row = 0; row < table.row_count(); ++row) {
    const auto number = static_cast<std::size_t>(table.whole(row, 0, 1, 1'000'000));
    const std::string& looked_at = table.text(row, 1);
    if (looked_at != kLattice && looked_at != kCorners) {
      fail("{}:{}: looked_at \"{}\" is neither {} nor {}", name, table.line(row), looked_at,
           kLattice, kCorners);
    }
    if (number != rounds.size()) rounds.push_back({looked_at == kLattice, {}});
    if (number != rounds.size()) {
      fail("{}:{}: round {} follows {}", name, table.line(row), number, rounds.size() - 1);
    }
    rounds.back().left.push_back(
        {table.text(row, 2), static_cast<std::int64_t>(table.number(row, 3))});
  }
  return rounds;
}

std::string_view checkpoint_state_name(CheckpointState state) {
  return kStates[static_cast<std::size_t>(state)];
}

std::string student_checkpoints_csv(const std::vector<StudentCheckpoint>& checkpoints) {
  std::string text = fmt::format("{}\n", kCheckpointHeader);
  for (const StudentCheckpoint& c : checkpoints) {
    text += fmt::format("{},{},{:.4f},{}\n", c.round, c.epoch, c.validation_eur_per_day_per_mwh,
                        checkpoint_state_name(c.state));
  }
  return text;
}

std::vector<StudentCheckpoint> parse_student_checkpoints_csv(std::string_view text,
                                                             const std::string& name) {
  std::vector<StudentCheckpoint> checkpoints;
  if (text == fmt::format("{}\n", kCheckpointHeader)) return checkpoints;
  const CsvTable table(text, name, kCheckpointHeader);
  for (std::size_t row = 0; row < table.row_count(); ++row) {
    const auto state = std::ranges::find(kStates, table.text(row, 3));
    if (state == kStates.end()) {
      fail("{}:{}: unknown state \"{}\"", name, table.line(row), table.text(row, 3));
    }
    checkpoints.push_back({static_cast<int>(table.number(row, 0)),
                           static_cast<int>(table.number(row, 1)), table.number(row, 2),
                           static_cast<CheckpointState>(state - kStates.begin())});
  }
  return checkpoints;
}

}  // namespace bess
