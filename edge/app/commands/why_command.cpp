// Explanation of a control cycle: `bess-edge why`.
#include <cstdio>

#include "edge/app/commands/command.h"
#include "edge/records/why/explanation.h"
#include "edge/records/why/local_moment.h"
#include "shared/local_time.h"

namespace bess {
namespace {

struct WhyOptions {
  std::string at;  ///< empty = newest control cycle
  bool json = false;
};

constexpr const char* kWhyFooter =
    R"(Prints the decider of one control cycle, since when and until when, and the decision margins:
the highest price and state of charge at which it would have charged, and the lowest at which it
would have discharged. The student is proved monotone in both, so there are no other changes.
Limits, your own rules and stop reasons override the student and are named. Read from the log in
[state] folder; the controller need not run.
Exit codes:
  0 done
  1 log unreadable, or no control cycle at that time
  2 command line error
Examples:
  bess-edge why
  bess-edge why --at 14:32
  bess-edge why --json | jq .margins)";

/// Record number of the requested control cycle; `trouble` names the cause if there is none.
std::uint64_t find_cycle(const WhyOptions& options, const EdgeConfig& config, const LogReader& log,
                         std::string& trouble) {
  if (log.newest_number() == 0) trouble = "the decision log is empty";
  if (options.at.empty() || !trouble.empty()) return log.newest_number();
  std::int64_t at_utc_s = 0;
  const std::int64_t now_utc_s = utc_seconds(config.clock);
  parse_moment(options.at, now_utc_s, at_utc_s);
  const std::uint64_t number = number_at(log, at_utc_s);
  CycleRecord oldest;
  if (number == 0 && log.read(log.oldest_number(), oldest)) {
    trouble = std::string("no control cycle at ") + local_text(at_utc_s).c_str() +
              " local time; the log begins at " + local_text(oldest.utc_s).c_str();
  }
  return number;
}

int run_why(const WhyOptions& options, SettingsFile& settings) {
  set_market_time_zone();
  const EdgeConfig& config = settings.config;
  LogReader log;
  if (!open_log(config, log)) return 1;
  std::string trouble;
  const std::uint64_t number = find_cycle(options, config, log, trouble);
  if (!trouble.empty()) return failed(trouble);
  Explanation explanation;
  if (!explain(log, number, config.control.guard.thresholds, explanation)) {
    return failed("the record of that control cycle cannot be read");
  }
  const std::string text = options.json ? explanation_json(explanation, config.control).text()
                                        : explanation_text(explanation, config.control);
  std::fputs(text.c_str(), stdout);
  return end_of_output();
}

}  // namespace

void add_why(EdgeCommand root) {
  EdgeCommand command = root.subcommand("why", "explain one decision and its margins");
  const auto options = std::make_shared<WhyOptions>();
  command.moment("--at", options->at,
                 "control cycle in force at MOMENT, local time: 14:32 (the latest), \"2026-11-23 "
                 "14:32\", or UTC: 2026-11-23T13:32:00Z; default: the newest");
  command.flag("--json", options->json, "one JSON object with the same values");
  command.footer(kWhyFooter);
  command.set_action([options](SettingsFile& settings) { return run_why(*options, settings); });
}

}  // namespace bess
