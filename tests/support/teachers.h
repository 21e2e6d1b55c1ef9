// Teachers for tests: untrained networks, and programs.
#pragma once

#include <memory>
#include <string>
#include <utility>

#include "workstation/data/env/context_fit.h"
#include "workstation/policy/rl/teacher.h"

namespace bess {

inline Teacher network_teacher(Method method, const Support& support, const PriceMap& map,
                               std::uint64_t seed, const std::string& provenance = "untrained") {
  const MlpShape shape = teacher_shape(method, support);
  return {method, support, shape, map, initial_parameters(shape, seed), provenance};
}

inline std::shared_ptr<const StochasticProgram> program_of(const MarketSteps& market) {
  return std::make_shared<const StochasticProgram>(market, market.days_of(Split::kTrain),
                                                   BatteryParameters{});
}

inline Teacher program_teacher(const MarketSteps& market, const PriceMap& map,
                               std::shared_ptr<const StochasticProgram> program) {
  return {.method = Method::kSdp,
          .support = {},
          .shape = {},
          .price_map = map,
          .parameters = {},
          .provenance = "program",
          .program = std::move(program),
          .context = fit_context_classes(market, ContextKind::kLevel)};
}

}  // namespace bess
