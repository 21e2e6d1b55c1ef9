// The whole correction: distil through the layer, quantise, prove over the whole lattice; while the
// proof finds violations, train on them as counterexamples with wider slope margins, and prove
// again.
#pragma once

#include "workstation/correction/distil.h"
#include "workstation/student/verify.h"

namespace bess {

struct CorrectedStudent {
  StudentNet net;
  Certificate certificate;  ///< of `net`; violations() == 0 when the correction succeeded
  std::vector<DistilPoint> curve;
  std::vector<std::int64_t> violations_by_round;
};

/// Never throws for a failed proof: look at certificate.violations(). With options.correct false
/// there is one round and no repair.
CorrectedStudent correct_and_prove(const Teacher& teacher, const Matrix& visited,
                                   const DistilOptions& options,
                                   const std::atomic<bool>& interrupted);

}  // namespace bess
