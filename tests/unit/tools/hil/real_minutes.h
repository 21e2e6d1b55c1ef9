// Real minutes, and the value of a run on them by the battery's own record.
#pragma once

#include <fmt/format.h>

#include <string>
#include <vector>

#include "edge/records/account/settled_prices.h"
#include "edge/records/log/log_text.h"
#include "shared/host/minute_file.h"
#include "shared/utc_text.h"
#include "tools/hil_runner/evidence/evidence.h"
#include "tools/simulators/settle/settlement.h"

namespace bess {

inline constexpr const char* kRealMinutes =
    BESS_SOURCE_DIR "/tests/data/benchmark_minutes_2023.csv.gz";

inline MoneyTerms terms_of(const MinuteSeries& prices) {
  MoneyTerms terms{.capacity_wh = 8'000};
  std::vector<SettledQuarter> quarters;
  for (std::size_t m = 0; m < prices.size(); m += 15) {
    quarters.push_back({prices.utc_s(m), prices.settled[m], PriceState::kValidated});
  }
  terms.settled.put(quarters);
  return terms;
}

/// As `bess-sim settle --record --edge-log --prices` computes it.
inline Account settled_by_record(const Evidence& evidence, const MinuteSeries& prices,
                                 std::int64_t from_utc_s, std::int64_t until_utc_s) {
  std::string record = "minute_utc,energy_wh,soc\n";
  for (const MinuteRecord& m : evidence.minutes) {
    if (m.minute_utc_s < from_utc_s || m.minute_utc_s >= until_utc_s) continue;
    record +=
        fmt::format("{},{:.6f},{:.8f}\n", utc_text(m.minute_utc_s).view(), m.energy_wh, m.soc_frac);
  }
  char line[kLogLineBytes];
  std::string log = std::string(line, format_csv_header(line)) + "\n";
  for (const CycleRecord& r : evidence.log) {
    if (r.utc_s < from_utc_s || r.utc_s >= until_utc_s) continue;
    log.append(line, format_csv_line(r, line)).append("\n");
  }
  return settle(CsvTable(record, "record"), CsvTable(log, "log"), prices, {}).battery;
}

}  // namespace bess
