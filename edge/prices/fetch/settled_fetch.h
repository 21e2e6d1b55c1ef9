// Fetches the settled prices of past quarter-hours once a day, and keeps them in the state folder
// for `bess-edge earned` (settled_prices.h).
//
// Asked for is what is not validated yet, since the oldest day that is kept, up to today's local
// midnight: the day before, and what has become of the days before that. A day that is not there
// yet, or a server that fails, is tried again after a quarter of an hour, then half an hour, up to
// every four hours.
#pragma once

#include <cstdint>
#include <stop_token>
#include <string>
#include <vector>

#include "edge/records/account/settled_prices.h"
#include "shared/scaled_clock.h"

namespace bess {

/// Section [settled].
struct SettledSource {
  std::string url;  ///< with {from} and {until}, or Elia's without a query; empty: none is fetched
  std::string ca_file;
  std::string file;  ///< in which they are kept
  std::int32_t days = 62;
  std::int32_t timeout_ms = 60'000;
};

/// Of a whole configuration. False with one line: file, key, and what to do.
bool load_settled_source(const std::string& path, SettledSource& source, std::string& error);

/// The url for those instants.
std::string settled_url(const SettledSource& source, std::int64_t from_utc_s,
                        std::int64_t until_utc_s);

/// Rows of an answer: a list, or an object with a list `results`, as Elia's portal has both. A row
/// without a price is left out. Empty with one line in `trouble` when it is something else.
std::vector<SettledQuarter> parse_settled(std::string_view text, std::string& trouble);

/// When the next try is due.
class SettledSchedule {
 public:
  [[nodiscard]] bool is_due(std::int64_t now_utc_s) const { return now_utc_s >= next_utc_s_; }
  /// `is_whole`: yesterday is there to its last quarter-hour.
  void tried(std::int64_t now_utc_s, bool is_whole);

 private:
  std::int64_t next_utc_s_ = 0;
  std::int64_t pause_s_ = 0;
};

struct SettledResult {
  int fetched = 0;        ///< quarter-hours in the answer
  bool is_whole = false;  ///< up to the last of yesterday
  std::string trouble;    ///< empty: fetched and kept
};
/// Now, at once; waits as long as the settings say.
SettledResult fetch_settled(const SettledSource& source, std::int64_t now_utc_s,
                            const std::stop_token& stop);

/// Tries whenever it is due, until a stop is requested.
void fetch_settled_daily(const SettledSource& source, const ScaledClock& clock,
                         const std::stop_token& stop);

}  // namespace bess
