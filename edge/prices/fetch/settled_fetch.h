// Settled price fetcher: once a day, into the state folder, for `bess-edge earned`
// (settled_prices.h).
//
// It requests the prices not yet validated, from the oldest stored day up to today's local
// midnight: the previous day, and updates of earlier days. A missing day or a failed request is
// retried after 15 minutes, then 30, up to every four hours.
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
  std::string url;  ///< with {from} and {until}, or Elia's without a query; empty: no fetch
  std::string ca_file;
  std::string file;  ///< of settled prices, in the state folder
  std::int32_t days = 62;
  std::int32_t timeout_ms = 60'000;
};

/// Reads the section from a configuration. False with one line: file, key and remedy.
bool load_settled_source(const std::string& path, SettledSource& source, std::string& error);

/// The url for these instants.
std::string settled_url(const SettledSource& source, std::int64_t from_utc_s,
                        std::int64_t until_utc_s);

/// Rows of an answer: a list, or an object with a list `results`, as Elia's portal provides. Rows
/// without a price are skipped. Empty with one line in `trouble` for another format.
std::vector<SettledQuarter> parse_settled(std::string_view text, std::string& trouble);

/// Schedule of the requests.
class SettledSchedule {
 public:
  /// Also after a step of the clock backwards.
  [[nodiscard]] bool is_due(std::int64_t now_utc_s) const {
    return now_utc_s >= next_utc_s_ || now_utc_s < last_utc_s_;
  }
  /// `is_whole`: yesterday's last quarter-hour is known; `wait_s`: requested by the server.
  void tried(std::int64_t now_utc_s, bool is_whole, double wait_s = 0);

 private:
  std::int64_t last_utc_s_ = 0;
  std::int64_t next_utc_s_ = 0;
  std::int64_t pause_s_ = 0;
};

struct SettledResult {
  int fetched = 0;        ///< quarter-hours in the answer
  bool is_whole = false;  ///< up to the last quarter-hour of yesterday
  std::string trouble{};  ///< empty: fetched and stored
  double wait_s = 0;      ///< requested by the server
};
/// Fetches now; waits as long as the settings say.
SettledResult fetch_settled(const SettledSource& source, std::int64_t now_utc_s,
                            const std::stop_token& stop);

/// Fetches whenever due, until a stop request.
void fetch_settled_daily(const SettledSource& source, const ScaledClock& clock,
                         const std::stop_token& stop);

}  // namespace bess
