// Checkpoints of a correction: the students checked, their validation results, and the chosen one.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace bess {

enum class CheckpointState {
  kPassedOver,  ///< another one earned more
  kDisobeys,    ///< earned more than the chosen one but violates a demand
  kChosen,
};
std::string_view checkpoint_state_name(CheckpointState state);  ///< "passed over", ...

struct StudentCheckpoint {
  int round;  ///< from 1
  int epoch;  ///< over all rounds
  double validation_eur_per_day_per_mwh;
  CheckpointState state;
};

/// Header `round,epoch,validation_eur_per_day_per_mwh,state`.
std::string student_checkpoints_csv(const std::vector<StudentCheckpoint>& checkpoints);
/// Parses it; throws UserError naming `name` and the line.
std::vector<StudentCheckpoint> parse_student_checkpoints_csv(std::string_view text,
                                                             const std::string& name);

}  // namespace bess
