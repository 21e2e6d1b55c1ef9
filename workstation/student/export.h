// Writes the proved student as edge/generated/student_weights.h: constant arrays that C and C++
// compilers read alike, with provenance, hashes, the thresholds it is bound to and self-check
// vectors.
#pragma once

#include <string>

#include "workstation/student/student_file.h"

namespace bess {

/// Text of the header. Self-check vectors are corners of the lattice and states drawn from a fixed
/// seed.
std::string format_weight_header(const StudentFile& student);

}  // namespace bess
