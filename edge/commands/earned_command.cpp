// `bess-edge earned`: what the battery earned in some local days, from the decision log.
#include <cstdio>
#include <optional>

#include "edge/account/account_days.h"
#include "edge/account/comparison.h"
#include "edge/account/money_settings.h"
#include "edge/account/period.h"
#include "edge/account/statement_page.h"
#include "edge/account/stops.h"
#include "edge/commands/command_list.h"
#include "edge/log/journal.h"
#include "shared/local_time.h"

namespace bess {
namespace {

struct EarnedGiven {
  std::string period;  ///< empty = today
  bool beside = false;
  bool csv = false;
  bool json = false;
  bool html = false;
};

using O = OptionsOf<EarnedGiven>;
constexpr CommandOption kOptions[] = {
    O::word<&EarnedGiven::period>(), O::flag<&EarnedGiven::beside>("--beside"),
    O::flag<&EarnedGiven::csv>("--csv"), O::flag<&EarnedGiven::json>("--json"),
    O::flag<&EarnedGiven::html>("--html")};

constexpr const char* kHelp =
    R"(bess-edge earned: what the battery earned in some days

  bess-edge earned [PERIOD] [--config FILE] [--beside] [--csv | --json | --html]

  PERIOD         today, yesterday, week, month, last-month, a month as 2026-10, a day as
                 2026-11-23, or 2026-11-01..2026-11-23; local days, default today; week and month
                 are those that today lies in
  --config FILE  the controller's settings; default /etc/bess/edge.toml
  --beside       and what rest, a rule, the student undisturbed, and foresight would have been
                 paid with this battery (90 % there and back), from the same charge on; the rule's
                 thresholds are the quartiles of the 30 days before
  --csv          one line a day, with a header
  --json         one JSON object: the days, and all of them together
  --html         a page to print, to hold beside the bill

Earned is what flowed, by quarter-hours: at the settled price where bess-prices has fetched it
([settled]), else at the last of the minutes, an estimate. Then what [contract] takes; what is
stored more or less at the end than at the beginning; and where the student did not decide, by
reasons, with what it would have earned there.
Read from the log in [state] folder: days that it no longer holds are not counted.
Exit codes: 0 done   1 the log cannot be read, or has nothing of these days   2 bad command line

  bess-edge earned
  bess-edge earned week --beside
  bess-edge earned month --csv > november.csv
  bess-edge earned last-month --html > bill.html
)";

const char* complaint(const EarnedGiven& given) {
  if (given.csv && given.json) return "--csv or --json, not both";
  if (given.html && (given.csv || given.json)) return "--html, or --csv or --json: one of them";
  if (given.html && given.beside) return "--beside is no part of the bill: not with --html";
  if (given.csv && given.beside) return "--beside is of all days together: not with --csv";
  Period period;
  if (given.period.empty() || parse_period(given.period, 19'700'101, period)) return nullptr;
  return "the period must be today, yesterday, week, month, last-month, a month as 2026-10, a day "
         "as 2026-11-23, or two with .. between";
}

std::string span_text(std::int32_t first_day, std::int32_t last_day) {
  return DayAccount(first_day).date() + " to " + DayAccount(last_day).date();
}

/// The days that one can ask for.
std::string held_text(const LogReader& log) {
  CycleRecord oldest, newest;
  if (!log.read(log.oldest_number(), oldest) || !log.newest(newest)) return "";
  return "; it has " + span_text(local_day_at(oldest.utc_s), local_day_at(newest.utc_s));
}

/// As the controller may use it.
BatteryParameters battery_of(const EdgeConfig& config, const Statement& statement) {
  const GuardSettings& guard = config.control.guard;
  BatteryParameters battery;
  battery.power_w_max = guard.power_w;
  battery.capacity_wh = statement.capacity_wh();
  battery.soc_min_frac = static_cast<double>(guard.soc_min_e4) / kSocFullE4;
  battery.soc_max_frac = static_cast<double>(guard.soc_max_e4) / kSocFullE4;
  return statement.contract().applied_to(battery);
}

/// What is told of some days.
struct Earned {
  Statement statement;
  Stops stops{};
  std::optional<Comparison> beside{};
};

void compare(const LogReader& log, const Period& period, const BatteryParameters& battery,
             const GuardSettings& guard, const QuarterPrices& prices, Earned& earned) {
  const Statement& statement = earned.statement;
  const LoggedMarket market = logged_market(log, period, prices, guard.price_age_s_max);
  const QuartileRule rule = quartile_rule(log, period.first_day);
  earned.beside.emplace(
      Comparison{find_rivals(market.cycles, statement.first_soc_frac(), battery, guard.thresholds,
                             rule, statement.mean_price_eur_per_mwh()),
                 rule, market.decided, market.decided_otherwise, statement});
}

std::string text_of(const EarnedGiven& given, const Earned& earned) {
  const auto& [statement, stops, beside] = earned;
  if (given.csv) return statement.csv();
  if (given.html) return statement_page(statement, stops);
  if (!given.json) {
    return statement.text() + stops_text(stops) + (beside ? beside->text() : "");
  }
  Json json = statement.json();
  json.set("stops", stops_json(stops));
  if (beside) json.set("beside", beside->json());
  return json.text();
}

int run_earned(const EarnedGiven& given, SettingsFile& settings) {
  set_market_time_zone();
  const EdgeConfig& config = settings.config;
  LogReader log;
  FileMessage error;
  if (!log.open(config.log, error)) return failed(error.c_str());
  const std::int32_t today = local_day_at(config.clock.now_utc_ns() / kNanosecondsPerSecond);
  Period period{today, today};
  if (!given.period.empty()) parse_period(given.period, today, period);
  std::string trouble;
  MoneySettings money;
  if (!load_money_settings(settings.path, money, trouble)) return failed(trouble);
  const MoneyTerms terms = money_terms(money, trouble);
  if (!trouble.empty()) report(JournalLevel::kWarning, "%s", trouble.c_str());
  const auto [first_day, last_day] = period;
  Earned earned{.statement =
                    Statement(accounts_of_days(log, first_day, last_day, terms), terms.contract)};
  const Statement& statement = earned.statement;
  if (statement.is_empty()) {
    return failed("the log holds no cycle of " + span_text(first_day, last_day) + held_text(log));
  }
  const BatteryParameters battery = battery_of(config, statement);
  const PriceThresholds& thresholds = config.control.guard.thresholds;
  QuarterPrices prices(terms.settled);
  for_each_record_around(log, first_day, last_day,
                         [&](const CycleRecord& record) { prices.note(record); });
  earned.stops = stops_of_days(log, first_day, last_day, battery, thresholds, prices);
  if (given.beside) compare(log, period, battery, config.control.guard, prices, earned);
  std::fputs(text_of(given, earned).c_str(), stdout);
  if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0) return 0;
  return failed("the output cannot be written");
}

}  // namespace

const EdgeCommand kEarnedCommand = {.name = "earned",
                                    .usage = "earned [PERIOD] [--config FILE] ...",
                                    .does = "what it earned, by days",
                                    .help = kHelp,
                                    .options = kOptions,
                                    .run = run_with<EarnedGiven, run_earned, complaint>};

}  // namespace bess
