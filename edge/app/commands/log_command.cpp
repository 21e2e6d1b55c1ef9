// Decision log from the ring in the state folder, as text or CSV: `bess-edge log`.
#include <algorithm>
#include <cstdio>

#include "edge/app/commands/command.h"
#include "edge/records/account/day_accounts.h"
#include "edge/records/log/log_reader.h"
#include "edge/records/log/log_text.h"
#include "edge/records/why/explanation.h"
#include "edge/records/why/local_moment.h"
#include "shared/local_time.h"

namespace bess {
namespace {

struct LogOptions {
  bool csv = false;
  bool is_short = false;
  bool local = false;
  bool explain = false;
  std::int64_t last = -1;  ///< -1 = all
  std::string since;       ///< moments; empty = all
  std::string until;
  std::string at;
};

constexpr const char* kLogFooter =
    R"(MOMENT is local time: 14:32 (the latest), yesterday, "yesterday 14:32" or "2026-11-23 14:32";
an age: 2h; or UTC: 2026-11-23T13:32:00Z. Energy and money are estimates: the power measured at the
start of the control cycle, for two minutes, at the price of the decision; bess-edge earned uses
settled prices. Read from the ring in [state] folder, oldest first; the controller need not run.
Exit codes:
  0 done
  1 log unreadable
  2 command line error
Examples:
  bess-edge log --short --last 10
  bess-edge log --local --since 14:00 --until 15:00
  bess-edge log --explain --last 30
  bess-edge log --csv --since 2026-11-01T00:00:00Z > november.csv)";

/// Records to print, by number and time.
struct LogSpan {
  std::uint64_t first = 1;
  std::uint64_t last = 0;
  std::int64_t since_utc_s = INT64_MIN;
  std::int64_t until_utc_s = INT64_MAX;
};

/// By number first, because torn records count and the clock may have been stepped.
LogSpan span_of(const LogOptions& options, const LogReader& log, std::int64_t now_utc_s) {
  LogSpan span{.first = log.oldest_number(), .last = log.newest_number()};
  std::int64_t at_utc_s = 0;
  if (!options.at.empty() && parse_moment(options.at, now_utc_s, at_utc_s)) {
    const std::uint64_t number = number_at(log, at_utc_s);
    return {.first = std::max<std::uint64_t>(number, 1), .last = number};  // 0: none
  }
  if (options.last >= 0 && static_cast<std::uint64_t>(options.last) <= span.last) {
    span.first = std::max(span.first, span.last - static_cast<std::uint64_t>(options.last) + 1);
  }
  if (!options.since.empty()) parse_moment(options.since, now_utc_s, span.since_utc_s);
  if (!options.until.empty()) parse_moment(options.until, now_utc_s, span.until_utc_s);
  return span;
}

void print_csv(const CycleRecord& record, const LogOptions& options,
               const PriceThresholds& thresholds) {
  char line[kLogLineBytes];
  format_csv_line(record, line);
  std::fputs(line, stdout);
  if (options.local) {
    std::printf(",%s,%.2f,%.6f", local_text(record.utc_s).c_str(), cycle_energy_wh(record),
                cycle_earned_eur(record));
  }
  Margins at;
  if (options.explain && margins_of(record, thresholds, at)) {
    std::printf(",%.2f,%.2f", eur_of(at.charge_up_to_centi), eur_of(at.discharge_from_centi));
  } else if (options.explain) {
    std::fputs(",,", stdout);  // no student decision
  }
  std::putchar('\n');
}

void print_text(const CycleRecord& record, const LogOptions& options,
                const PriceThresholds& thresholds) {
  char line[kLogLineBytes];
  if (options.is_short) {
    format_short_line(record, line);
  } else {
    format_log_line(record, line);
  }
  if (options.local) {
    std::printf("%s  %+8.1f Wh  %+8.4f EUR  ", local_text(record.utc_s).c_str(),
                cycle_energy_wh(record), cycle_earned_eur(record));
  }
  std::fputs(line, stdout);
  Margins at;
  if (options.explain && margins_of(record, thresholds, at)) {
    std::printf(" charge_up_to=%.2f discharge_from=%.2f", eur_of(at.charge_up_to_centi),
                eur_of(at.discharge_from_centi));
  }
  std::putchar('\n');
}

int run_log(const LogOptions& options, SettingsFile& settings) {
  set_market_time_zone();
  const EdgeConfig& config = settings.config;
  LogReader log;
  if (!open_log(config, log)) return 1;
  const LogSpan span = span_of(options, log, utc_seconds(config.clock));
  if (!options.at.empty() && span.last == 0) return failed("no control cycle at " + options.at);
  if (options.csv) {
    char header[kLogLineBytes];
    format_csv_header(header);
    std::printf("%s%s%s\n", header, options.local ? ",local,energy_wh,earned_eur" : "",
                options.explain ? ",charge_up_to_eur_per_mwh,discharge_from_eur_per_mwh" : "");
  }
  if (options.is_short) std::puts(kShortLineHead);
  const PriceThresholds& thresholds = config.control.guard.thresholds;
  CycleRecord record;
  for (std::uint64_t n = span.first; n <= span.last; ++n) {
    if (!log.read(n, record)) continue;
    if (record.utc_s < span.since_utc_s || record.utc_s > span.until_utc_s) continue;
    if (options.csv) {
      print_csv(record, options, thresholds);
    } else {
      print_text(record, options, thresholds);
    }
  }
  return end_of_output();
}

}  // namespace

void add_log(EdgeCommand root) {
  EdgeCommand command = root.subcommand("log", "decision log: one line per control cycle");
  const auto options = std::make_shared<LogOptions>();
  command.flag("--csv", options->csv,
               "CSV with a header; default: one key=value line per control cycle");
  command.flag("--local", options->local,
               "also local time, energy (Wh, positive charges) and money (EUR)");
  command
      .flag("--short", options->is_short,
            "local time, order, price, SoC and reason of each control cycle, as a table")
      .excludes("--csv")
      .excludes("--local");
  command.flag("--explain", options->explain,
               "also the decision margins (EUR/MWh): highest price to charge, lowest to discharge");
  command.option("--last", options->last, "only the newest N control cycles")
      .value_name("N")
      .positive();
  command.moment("--since", options->since, "only from MOMENT");
  command.moment("--until", options->until, "only up to MOMENT");
  command.moment("--at", options->at, "only the control cycle in force at MOMENT")
      .excludes("--last")
      .excludes("--since")
      .excludes("--until");
  command.footer(kLogFooter);
  command.set_action([options](SettingsFile& settings) { return run_log(*options, settings); });
}

}  // namespace bess
