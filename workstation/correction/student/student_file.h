// The student on disk: a JSON text with every integer of the net, what it was made from, and its
// certificate with the thresholds it is bound to; and quantisation of a trained net into these
// integers.
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
#include "workstation/data/env/outlook_book.h"
#include "workstation/policy/nn/mlp.h"
#include "workstation/policy/rl/price_map.h"

namespace bess {

// From the float student to the integer one: the largest power-of-two scale for each layer at which
// no weight leaves int16, no accumulator can leave int32 and no activation saturates for ANY
// lattice input.

/// Throws UserError when the weights are so large that no scale fits.
/// `saturation`: where the float student's hidden activations were cut off, a power of two;
/// infinite for plain ReLU, whose integer activations never reach their end.
StudentNet quantise_student(const Parameters& student, const PriceMap& price_map,
                            double saturation = std::numeric_limits<double>::infinity());

/// Largest magnitude that any int32 sum of the net can reach over all inputs, rounding included.
std::int64_t accumulator_bound(const StudentNet& net);

struct StudentFile {
  StudentNet net;
  Certificate certificate;  ///< a claim: prove() finds out whether it holds
  std::string provenance;   ///< one line: prices, teacher, seed, options
  Entries learnt_for{};     ///< as the teacher was; empty: the file does not say
  /// By outlook: the plans that give the net its context.
  std::shared_ptr<const OutlookBook> outlook = nullptr;
  std::optional<double> cycles_per_day{};  ///< full ones, on validation days
};

/// Of what a model was learnt for the span of its prices; none when it does not tell.
std::optional<UtcSpan> learnt_span(const Entries& learnt_for);

/// Written beside and renamed.
void save_student(const std::filesystem::path& path, const StudentFile& student);

/// Throws UserError naming the file and what is wrong: not JSON, another architecture, a number out
/// of range, a hash that differs, a net that check_net refuses. Reads the files of before too:
/// version 1 has thresholds but no counts, 1 and 2 are by month.
StudentFile load_student(const std::filesystem::path& path);
StudentFile parse_student(const std::string& text, const std::string& name);

/// The array that this program was compiled with (edge/generated/student_weights.h).
StudentFile compiled_student();

/// "violations_property_1" to 3, as files and answers have them.
void add_property_violations(const Certificate& certificate, Json& json);

/// Throws UserError, with `name` in front, for a net that neither code nor bounds hold for: a price
/// map that does not rise, a shift out of range, weights whose accumulators could overflow.
void check_net(const StudentNet& net, const std::string& name);

}  // namespace bess
