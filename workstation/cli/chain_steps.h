// Steps of the chain that `run` shares with the single subcommands; each is defined where its subcommand is.
#pragma once

#include <string>

#include "workstation/rl/train.h"
#include "workstation/student/correct_and_prove.h"
#include "workstation/student/student_file.h"

namespace bess {

/// One line for the files made from this training.
std::string training_provenance(const std::string& prices, const TrainOptions& options,
                                const TrainResult& result);
/// One line on stderr when the support of C51 is too narrow for the values met.
void warn_narrow_support(const TrainOptions& options, const TrainResult& result);

StudentFile student_file(const CorrectedStudent& student, const DistilOptions& options,
                         const std::string& teacher_provenance);

/// Writes the weight header if the whole lattice is free of violations, else throws UserError.
void export_proved_student(const StudentFile& student, const std::string& name,
                           const std::string& out, int threads);

}  // namespace bess
