// How the Belgian imbalance price came about, by date: a policy that learnt one way knows little of
// another. Margins halved from 2024 to 2025.
#pragma once

#include <cstdint>
#include <string>

namespace bess {

/// The end is excluded.
struct UtcSpan {
  std::int64_t from_s, until_s;
};

/// Names of the regimes that `traded` meets and `learnt` does not, "from 26 November 2024
/// (PICASSO)"; or empty.
std::string regimes_not_learnt(const UtcSpan& learnt, const UtcSpan& traded);

}  // namespace bess
