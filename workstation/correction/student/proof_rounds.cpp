#include "workstation/correction/student/proof_rounds.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>

#include "shared/host/csv.h"
#include "shared/host/user_error.h"

namespace bess {
namespace {

constexpr std::string_view kHeader = "round,looked_at,demand,violations";
constexpr std::string_view kLattice = "lattice";
constexpr std::string_view kCorners = "corners";

std::string minutes_text(double seconds) {
  return seconds < 90 ? fmt::format("{:.0f} s", seconds) : fmt::format("{:.0f} min", seconds / 60);
}

}  // namespace

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
  const std::string more = state.done < state.most ? fmt::format("; at most {} more and a proof",
                                                                 minutes_text(state.seconds_left))
                                                   : "";
  return fmt::format("{}: {} left{}{}", head, round.text(),
                     round.is_whole ? "" : " at the deciding states", more);
}

std::string proof_rounds_csv(const std::vector<ProofRound>& rounds) {
  std::string text = fmt::format("{}\n", kHeader);
  for (std::size_t i = 0; i < rounds.size(); ++i) {
    for (const DemandLeft& demand : rounds[i].left) {
      text += fmt::format("{},{},{},{}\n", i + 1, rounds[i].is_whole ? kLattice : kCorners,
                          csv_field(demand.label), demand.violations);
    }
  }
  return text;
}

std::vector<ProofRound> parse_proof_rounds_csv(std::string_view text, const std::string& name) {
  const CsvTable table(text, name, kHeader);
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

namespace {

constexpr std::string_view kCheckpointHeader = "round,epoch,validation_eur_per_day_per_mwh,state";
constexpr std::array<std::string_view, 3> kStates{"passed over", "disobeys", "chosen"};

}  // namespace

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
