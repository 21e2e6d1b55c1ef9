#include "tools/hil_runner/scenario/day_ahead.h"

#include <fmt/core.h>

#include "shared/host/file.h"
#include "shared/local_time.h"
#include "shared/scaled_clock.h"
#include "shared/units_and_limits.h"
#include "shared/utc_text.h"
#include "tools/hil_runner/scenario/scenario_reader.h"

namespace bess {
namespace {

double made_up_day_ahead(std::int64_t utc_s) {
  const LocalMinute local = local_minute_of(utc_s);
  const int hour = local.minute_of_day / 60;
  const std::int64_t day =
      utc_from_civil({local.year, local.month, local.day, 0, 0, 0}) / kSecondsPerDay;
  const double of_hour = hour >= 18 && hour < 21   ? 110
                         : hour >= 11 && hour < 16 ? -70
                         : hour >= 7 && hour < 10  ? 60
                                                   : 0;
  return 80 + of_hour + 9 * static_cast<double>(day % 7) + 2 * (local.quarter_hour % 4);
}

}  // namespace

void read_day_ahead(TomlTable table, const std::filesystem::path& folder, Scenario& scenario) {
  if (table.value() == nullptr) return;
  AuctionSettings& auction = scenario.day_ahead.emplace();
  auction.start_utc_s = scenario.start_utc_s;
  if (const std::string* const file = table.text("file")) {
    scenario.day_ahead_file = (folder / *file).string();
  }
  int fault = 0;
  table.choice("fault", fault, kAuctionFaultNames);
  auction.fault = static_cast<AuctionFault>(fault);
  for (const char* key : {"every", "from_min", "to_min", "mend_min"}) {
    if (fault == 0 && table.has(key)) table.fail(key, "requires a fault");
  }
  read_fault_span(table, scenario.minutes, auction);
  table.integer("every", auction.every, 1, 1'000'000);
  double mend_min = 0;
  read_decimal(table, "mend_min", mend_min, 0, kScenarioMinutesMax);
  if (table.has("mend_min")) auction.repair_s = 60 * mend_min;
  table.finish();
}

std::string day_ahead_csv(const Scenario& scenario) {
  if (!scenario.day_ahead_file.empty()) return read_file(scenario.day_ahead_file);
  std::string csv = "quarter_hour_utc,day_ahead_eur_mwh,resolution_min,published_utc\n";
  const std::int64_t end_utc_s = scenario.end_utc_ns() / kNanosecondsPerSecond + 2 * kSecondsPerDay;
  for (std::int64_t t = local_midnight_utc_s(scenario.start_utc_s, -1); t < end_utc_s;
       t += kSecondsPerQuarterHour) {
    csv += fmt::format("{},{:.2f},15,\n", utc_text(t).view(), made_up_day_ahead(t));
  }
  return csv;
}

std::vector<AuctionRow> day_ahead_rows(const Scenario& scenario) {
  return parse_auction_rows(day_ahead_csv(scenario), scenario.day_ahead_file.empty()
                                                         ? scenario.path
                                                         : scenario.day_ahead_file);
}

}  // namespace bess
