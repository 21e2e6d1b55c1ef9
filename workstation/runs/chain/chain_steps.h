// Steps of the chain that `run` shares with the single subcommands.
#pragma once

#include <string>
#include <vector>

#include "shared/host/minute_file.h"
#include "shared/host/user_error.h"
#include "workstation/correction/student/correct_and_prove.h"
#include "workstation/policy/rl/train.h"

namespace bess {

/// One line for the files made from this training.
std::string training_provenance(const std::string& prices, const TrainOptions& options,
                                const TrainResult& result);
/// One line on stderr when the support of C51 is too narrow for the values met.
void warn_narrow_support(const TrainOptions& options, const TrainResult& result);

/// CRC-32 of both columns: a checkpoint or a fold belongs to the prices that it was made from.
std::uint32_t prices_checksum(const MinuteSeries& series);
/// "crc32 1234abcd, 525600 minutes from 2023-01-01T00:00:00Z"
std::string prices_hash(const MinuteSeries& series);
/// Of a stretch of them: the checksum is of the whole.
std::string prices_hash(std::uint32_t checksum, std::int64_t minutes, std::int64_t from_utc_s);

/// A student that was not proved, whatever was tried.
struct ProofFailed : UserError {
  using UserError::UserError;
};
/// The proved student of `result`. Throws ProofFailed with what describe_failed_proof says.
const ProvedStudent& require_proof(const CorrectionResult& result, CorrectionMethod method,
                                   const std::string& where = "", const std::string& note = "");

}  // namespace bess
