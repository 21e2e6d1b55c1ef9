// What the edge does with a student: its decisions, and behind them what its guard enforces of the
// rules. A power that the guard alone limits is nowhere in the student, and is paid for all the
// same.
#pragma once

#include <memory>

#include "workstation/correction/student/student_file.h"
#include "workstation/data/env/policy.h"

namespace bess {

/// Keeps a reference: `student` must outlive it.
std::unique_ptr<Policy> exported_policy(const StudentFile& student);

}  // namespace bess
