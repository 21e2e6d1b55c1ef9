// The proved student on disk: a JSON text with every integer of the net, what it was made from, the
// thresholds it is bound to and its certificate. Readable by people and by other programs.
#pragma once

#include <filesystem>
#include <string>

#include "shared/nn/student_net.h"
#include "workstation/student/verify.h"

namespace bess {

struct StudentFile {
  StudentNet net;
  int low_price_eur_per_mwh = kLatticePriceMinEurPerMwh;
  int high_price_eur_per_mwh = kLatticePriceMaxEurPerMwh;
  std::string provenance;  ///< one line: prices, teacher, seed, options
};

/// Written beside and renamed.
void save_student(const std::filesystem::path& path, const StudentFile& student);

/// Throws UserError naming the file and what is wrong: not JSON, another architecture, a number out
/// of range, a hash that differs, weights whose accumulators could overflow.
StudentFile load_student(const std::filesystem::path& path);
StudentFile parse_student(const std::string& text, const std::string& name);

/// The array that this program was compiled with (edge/generated/student_weights.h).
StudentFile compiled_student();

/// The certificate of a student against its own thresholds.
Certificate prove(const StudentFile& student, int threads, bool exhaustive = false);

}  // namespace bess
