// Chain steps shared by `run` and the single-stage commands.
#pragma once

#include <string>

#include "shared/host/minute_file.h"
#include "shared/host/user_error.h"
#include "workstation/correction/student/correct_and_prove.h"
#include "workstation/data/market/series/imbalance_price.h"
#include "workstation/policy/rl/train.h"

namespace bess {

/// Provenance line of the files made from this training.
std::string training_provenance(const std::string& prices, const TrainOptions& options,
                                const TrainResult& result);
/// Warning on stderr when the support of C51 is too narrow for its values.
void warn_narrow_support(const TrainOptions& options, const TrainResult& result);

/// CRC-32 of both price columns, which identifies the prices of a checkpoint or fold.
std::uint32_t prices_checksum(const MinuteSeries& series);
/// "crc32 1234abcd, 525600 minutes from 2023-01-01T00:00:00Z"
std::string prices_hash(const MinuteSeries& series);
/// For a part of the prices; the checksum covers the whole.
std::string prices_hash(const MinuteSeries& series, const UtcSpan& part);

/// The student could not be proved.
struct ProofFailed : UserError {
  using UserError::UserError;
};
/// Proved student of `result`. Throws ProofFailed with the text of describe_failed_proof.
const ProvedStudent& require_proof(const CorrectionResult& result, CorrectionMethod method,
                                   const std::string& where = "", const std::string& note = "");

}  // namespace bess
