// Student file: JSON with every integer of the net, its provenance and its certificate with
// thresholds; and quantisation of a trained net into these integers.
#pragma once

#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <string>

#include "shared/host/json.h"
#include "shared/nn/student_net.h"
#include "workstation/base/answer.h"
#include "workstation/correction/student/certificate.h"
#include "workstation/data/env/plan_cache.h"
#include "workstation/policy/nn/mlp.h"
#include "workstation/policy/rl/network_input.h"

namespace bess {

// Quantisation of the float student: for each layer the largest power-of-two scale at which all
// weights fit int16, no accumulator leaves int32 and no activation saturates for ANY lattice input.

/// Throws UserError if no scale fits. `saturation`: limit of the float student's hidden
/// activations, a power of two; infinite for plain ReLU, whose integer activations never saturate.
StudentNet quantise_student(const Parameters& student, const PriceMap& price_map,
                            double saturation = std::numeric_limits<double>::infinity());

/// Largest magnitude of any int32 sum of the net over all inputs, rounding included.
std::int64_t accumulator_bound(const StudentNet& net);

struct StudentFile {
  StudentNet net;
  Certificate certificate;  ///< a claim; prove() verifies it
  std::string provenance;   ///< one line: prices, teacher, seed, options
  Entries learnt_for{};     ///< training scope of the teacher; empty: unknown
  /// With the outlook context: the plans that give the net its context class.
  std::shared_ptr<const PlanCache> outlook = nullptr;
  std::optional<double> cycles_per_day{};  ///< full cycles on validation days
};

/// Time span of the prices in a training scope; none if not stated.
std::optional<UtcSpan> learnt_span(const Entries& learnt_for);

/// Replaces the file atomically.
void save_student(const std::filesystem::path& path, const StudentFile& student);

/// Throws UserError naming the file and what is wrong: not JSON, another architecture, a number out
/// of range, a wrong hash, a net that check_net refuses. Also reads older file versions: version 1
/// has thresholds but no counts, 1 and 2 have the month context.
StudentFile load_student(const std::filesystem::path& path);
StudentFile parse_student(const std::string& text, const std::string& name);

/// The student that this program was compiled with (edge/generated/student_weights.h).
StudentFile compiled_student();

/// "violations_property_1" to 3, as in files and answers.
void add_property_violations(const Certificate& certificate, Json& json);

/// Throws UserError, with `name` in front, for a net outside the limits of the code and the bounds:
/// a price map that does not rise, a shift out of range, weights whose accumulators could overflow.
void check_net(const StudentNet& net, const std::string& name);

}  // namespace bess
