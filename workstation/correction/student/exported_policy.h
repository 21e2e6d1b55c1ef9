// Exported policy: student plus the rules that the guard enforces, as on the edge. Includes the
// cost of power limits, which only the guard applies.
#pragma once

#include <memory>

#include "workstation/correction/student/student_file.h"
#include "workstation/data/env/policy.h"

namespace bess {

/// Keeps a reference: `student` must outlive it.
std::unique_ptr<Policy> exported_policy(const StudentFile& student);

}  // namespace bess
