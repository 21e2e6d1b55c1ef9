// Writes the proved student as edge/generated/student_weights.h: constant arrays that C and C++
// compilers read alike, with provenance, hashes, certificate and self-check vectors.
#pragma once

#include <string>

#include "workstation/correction/student/prove.h"

namespace bess {

// The operator's rules in the exported header: what was proved of them, for people; the rule file's
// text, so that the proof can be made again; and what the guard enforces, as constant tables with
// golden points. Without rules nothing is written.

/// Behind the three properties, a line each; empty without rules.
std::string rule_lines(const Certificate& certificate);

/// Macros and tables; empty without rules.
std::string rule_section(const ProvedStudent& student);

/// Points at which each field of each rule shows: inside its box, at its ends, and just beyond.
std::vector<RulePoint> rule_check_points(const std::vector<GuardRule>& rules);

/// Text of the header. Self-check vectors are corners of the lattice and states drawn from a fixed
/// seed.
std::string format_weight_header(const ProvedStudent& student);

/// Beside the header: what `bess-edge signature` has to print of a build with it. The time zone
/// must be set.
inline constexpr const char* kDecisionSignatureFile = "decision_signature.txt";
std::string decision_signature_line(const StudentFile& student);

/// A C string literal of `text`: no byte of it can end the literal, nor start an escape or a
/// trigraph; what is not printable ASCII becomes a question mark.
std::string c_string_literal(const std::string& text);

}  // namespace bess
