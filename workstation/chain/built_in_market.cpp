#include "workstation/chain/built_in_market.h"

#include <fmt/core.h>

#include "workstation/market/model/quarter_hours_to_minutes.h"
#include "workstation/market/model/simulated_market.h"
#include "workstation/market/series/local_date.h"

namespace bess {
namespace {

constexpr LocalDate kStart{2023, 1, 1};
constexpr int kDays = 365;
constexpr std::uint64_t kSeed = 1;

}  // namespace

MinuteSeries built_in_market() {
  const SimulationPeriod period{local_midnight_utc_s(kStart),
                                local_midnight_utc_s(add_days(kStart, kDays))};
  return minutes_on_quarter_hours(simulate_quarter_hours(period, kSeed), kSeed);
}

std::string built_in_market_provenance() {
  return fmt::format("{}: {}, seed {}", kSimulatedProvenance, kBuiltInMarketName, kSeed);
}

}  // namespace bess
