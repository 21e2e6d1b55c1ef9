// Earnings by local day, from the decision log: `bess-edge earned`.
#include <cstdio>

#include "edge/app/commands/command.h"
#include "edge/records/account/day_accounts.h"
#include "edge/records/log/journal.h"
#include "shared/local_time.h"

namespace bess {
namespace {

struct EarnedOptions {
  std::string period;  ///< empty = today
  bool csv = false;
  bool json = false;
};

constexpr const char* kEarnedFooter =
    R"(Earnings are the energy of each quarter-hour at its settled price, if bess-prices has fetched
it ([settled]), else at its last indicative price, an estimate. Fees, taxes and wear are not
subtracted. Also printed: the change in stored energy, and the control cycles that the student did
not decide, by reason. Source: the log in [state] folder; days that it no longer has are missing.
bess-train log makes a statement from bess-edge log --csv, to compare with the bill and with other
policies.
Exit codes:
  0 done
  1 log unreadable, or without these days
  2 command line error
Examples:
  bess-edge earned
  bess-edge earned week
  bess-edge earned month --csv > november.csv)";

std::string complaint(const std::string& text) {
  Period period;
  if (parse_period(text, 19'700'101, period)) return "";
  return "must be today, yesterday, week, month, last-month, a month as 2026-10, a day as "
         "2026-11-23, or two with .. between, not " +
         text;
}

std::string span_text(std::int32_t first_day, std::int32_t last_day) {
  return local_day_text(first_day) + " to " + local_day_text(last_day);
}

/// First and last day of the log.
std::string held_text(const LogReader& log) {
  CycleRecord oldest, newest;
  if (!log.read(log.oldest_number(), oldest) || !log.newest(newest)) return "";
  return "; it covers " + span_text(local_day_at(oldest.utc_s), local_day_at(newest.utc_s));
}

int run_earned(const EarnedOptions& options, SettingsFile& settings) {
  set_market_time_zone();
  const EdgeConfig& config = settings.config;
  LogReader log;
  if (!open_log(config, log)) return 1;
  const std::int32_t today = local_day_at(utc_seconds(config.clock));
  Period period{today, today};
  if (!options.period.empty()) parse_period(options.period, today, period);
  MoneyTerms terms{.capacity_wh = config.battery.capacity_wh};
  const std::string trouble = terms.settled.read(state_file(config, "settled.csv").c_str());
  if (!trouble.empty()) report(JournalLevel::kWarning, "%s", trouble.c_str());
  const std::vector<DayAccount> days =
      accounts_of_days(log, period.first_day, period.last_day, terms);
  if (days.empty()) {
    return failed("the log has no control cycle of " +
                  span_text(period.first_day, period.last_day) + held_text(log));
  }
  const std::string text = options.csv    ? earnings_csv(days)
                           : options.json ? earnings_json(days).text()
                                          : earnings_text(days);
  std::fputs(text.c_str(), stdout);
  return end_of_output();
}

}  // namespace

void add_earned(EdgeCommand root) {
  EdgeCommand command = root.subcommand("earned", "earnings and energy by local day");
  const auto options = std::make_shared<EarnedOptions>();
  command
      .option("period", options->period,
              "local days: today, yesterday, week, month, last-month, 2026-10, 2026-11-23 or "
              "2026-11-01..2026-11-23; default: today")
      .value_name("PERIOD")
      .check(complaint);
  command.flag("--csv", options->csv, "CSV with a header, one line per day");
  command.flag("--json", options->json, "one JSON object: days and their sum").excludes("--csv");
  command.footer(kEarnedFooter);
  command.set_action([options](SettingsFile& settings) { return run_earned(*options, settings); });
}

}  // namespace bess
