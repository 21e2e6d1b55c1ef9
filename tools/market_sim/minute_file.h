// Reads the one exchange format of minute prices, CSV or .csv.gz:
//   minute_utc,indicative_eur_mwh,settled_eur_mwh     UTC with Z, strictly ascending, # comments
// An empty indicative price means: not published. An own small reader, so that the simulator shares
// no code with the workstation whose prices it serves.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace bess {

struct MinutePrice {
  std::int64_t minute_utc_s;
  double indicative_eur_per_mwh;  ///< NaN = not published
  double settled_eur_per_mwh;     ///< NaN = not settled
};

/// Throws SimError naming file and line.
std::vector<MinutePrice> parse_minute_prices(std::string_view text, const std::string& name);
std::vector<MinutePrice> read_minute_prices(const std::string& path);

}  // namespace bess
