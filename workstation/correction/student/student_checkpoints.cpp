#include "workstation/correction/student/student_checkpoints.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>

#include "shared/host/csv.h"
#include "shared/host/user_error.h"

namespace bess {
namespace {

constexpr std::string_view kHeader = "round,epoch,validation_eur_per_day_per_mwh,state";
constexpr std::array<std::string_view, 3> kStates{"passed over", "disobeys", "chosen"};

}  // namespace

std::string_view checkpoint_state_name(CheckpointState state) {
  return kStates[static_cast<std::size_t>(state)];
}

std::string student_checkpoints_csv(const std::vector<StudentCheckpoint>& checkpoints) {
  std::string text = fmt::format("{}\n", kHeader);
  for (const StudentCheckpoint& c : checkpoints) {
    text += fmt::format("{},{},{:.4f},{}\n", c.round, c.epoch, c.validation_eur_per_day_per_mwh,
                        checkpoint_state_name(c.state));
  }
  return text;
}

std::vector<StudentCheckpoint> parse_student_checkpoints_csv(std::string_view text,
                                                             const std::string& name) {
  std::vector<StudentCheckpoint> checkpoints;
  if (text == fmt::format("{}\n", kHeader)) return checkpoints;
  const CsvTable table(text, name, kHeader);
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
