// The guard's price thresholds beside those that the student is proved for. The one comes from the
// operator's file, the other with the weights; where they differ, a price lies between them for
// which only one of the two answers, or neither. Said at every start, never a reason to refuse it.
#pragma once

#include <string>

#include "shared/price_thresholds.h"

namespace bess {

struct ThresholdNote {
  bool agree = false;
  std::string
      text;  ///< one line: the thresholds, or each that differs and who answers between the two
};

ThresholdNote compare_thresholds(const PriceThresholds& guard, const PriceThresholds& proved);

}  // namespace bess
