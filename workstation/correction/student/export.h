// Weight header writer: the proved student as edge/generated/student_weights.h, constant arrays for
// C and C++ with provenance, hashes, certificate and self-check vectors.
#pragma once

#include <string>

#include "workstation/correction/student/prove.h"

namespace bess {

// Operator's rules in the exported header: their proof results as comments, the text of the rule
// file so that the proof is repeatable, and the guard's rules as constant tables with check points.
// Empty without rules.

/// Points that test each field of each rule: inside its box, at its ends, and just beyond.
std::vector<RulePoint> rule_check_points(const std::vector<GuardRule>& rules);

/// Text of the header. Self-check vectors are corners of the lattice and states from a fixed seed.
std::string format_weight_header(const ProvedStudent& proved);

/// File next to the header: expected output of `bess-edge signature` for a build with it. The time
/// zone must be set.
inline constexpr const char* kDecisionSignatureFile = "decision_signature.txt";
std::string decision_signature_line(const StudentFile& student);

/// A C string literal of `text`: escapes quotes, backslashes and trigraphs; characters that are not
/// printable ASCII become question marks.
std::string c_string_literal(const std::string& text);

}  // namespace bess
