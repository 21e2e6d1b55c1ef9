#include "workstation/env/foresight.h"

namespace bess {
namespace {
constexpr std::size_t kSocPoints = 1801;
constexpr std::size_t kBlockSteps = 750;  // the longest local day, so that a day is one block
}  // namespace

ForesightPolicy::ForesightPolicy(const BatteryParameters& battery)
    : battery_(battery), grid_(battery, kSocPoints), sweep_(battery, grid_) {}

void ForesightPolicy::begin(std::span<const MarketStep> ahead) {
  paid_.clear();
  for (const MarketStep& step : ahead) paid_.push_back(static_cast<float>(step.paid_eur_per_mwh));
  const std::size_t blocks = (paid_.size() + kBlockSteps - 1) / kBlockSteps;
  border_.assign((blocks + 1) * kSocPoints, 0.0F);
  value_.resize((kBlockSteps + 1) * kSocPoints);
  for (std::size_t block = blocks; block-- > 0;) {
    solve_block(block);
    // Only differences between SoCs decide; taken relative to the empty battery they stay small, so
    // that a float tells them apart even a year ahead.
    for (std::size_t i = 0; i < kSocPoints; ++i) {
      border_[block * kSocPoints + i] = value_[i] - value_[0];
    }
  }
}

void ForesightPolicy::solve_block(std::size_t block) const {
  const std::size_t first = block * kBlockSteps;
  const std::size_t count = std::min(kBlockSteps, paid_.size() - first);
  std::copy_n(&border_[(block + 1) * kSocPoints], kSocPoints, &value_[count * kSocPoints]);
  for (std::size_t t = count; t-- > 0;) {
    sweep_.run(&value_[(t + 1) * kSocPoints], paid_[first + t], &value_[t * kSocPoints]);
  }
  solved_block_ = block;
}

Action ForesightPolicy::decide(const MarketStep& step, std::size_t index, double soc_frac) const {
  if (index / kBlockSteps != solved_block_) solve_block(index / kBlockSteps);
  const float* next = &value_[(index % kBlockSteps + 1) * kSocPoints];
  return best_action(battery_, grid_, next, step.paid_eur_per_mwh, soc_frac);
}

}  // namespace bess
