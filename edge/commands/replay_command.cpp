// `bess-edge replay`: what this version's student would have decided in the cycles of the log.
#include <cstdio>

#include "edge/account/account_days.h"
#include "edge/account/period.h"
#include "edge/account/replay.h"
#include "edge/commands/command_list.h"
#include "edge/log/journal.h"
#include "shared/local_time.h"

namespace bess {
namespace {

struct ReplayGiven {
  std::string period;               ///< empty = month
  std::int64_t limit_percent = -1;  ///< of decisions that may differ; below 0 = any
  bool each = false;
  bool json = false;
};

using O = OptionsOf<ReplayGiven>;
constexpr CommandOption kOptions[] = {
    O::word<&ReplayGiven::period>(), O::count<&ReplayGiven::limit_percent>("--limit"),
    O::flag<&ReplayGiven::each>("--each"), O::flag<&ReplayGiven::json>("--json")};

constexpr int kOverTheLimit = 3;

constexpr const char* kHelp =
    R"(bess-edge replay: what this version would have decided in the cycles of the log

  bess-edge replay [PERIOD] [--config FILE] [--limit PERCENT] [--each | --json]

  PERIOD           as bess-edge earned takes it: week, month, 2026-11-01..2026-11-23; default
                   month
  --config FILE    the controller's settings; default /etc/bess/edge.toml
  --limit PERCENT  exit code 3 when more of the decisions would be others
  --each           and each decision that would be another one, in a line of its own
  --json           one JSON object: all days together, each, and each decision that would differ

Asked of a new version before it may drive: with its program, on the log of the version before.
Each cycle in which the student was asked is decided again with the same price, state of charge
and context; stops, limits and holds are of the settings, and are not replayed. Writes nothing,
and the controller may run.
Exit codes:
  0 done
  1 the log cannot be read, or has no decision of these days
  2 bad command line
  3 more than --limit would be decided otherwise

  bess-edge replay week
  dpkg-deb -x bess-edge_2.deb new && new/usr/bin/bess-edge replay --limit 10
)";

const char* complaint(const ReplayGiven& given) {
  if (given.each && given.json) return "--each and --json exclude each other";
  if (given.limit_percent > 100) return "--limit is a share in percent: 1 to 100";
  Period period;
  if (given.period.empty() || parse_period(given.period, 19'700'101, period)) return nullptr;
  return "the period must be today, yesterday, week, month, a day as 2026-11-23, or two with .. "
         "between";
}

int run_replay(const ReplayGiven& given, SettingsFile& settings) {
  set_market_time_zone();
  const EdgeConfig& config = settings.config;
  LogReader log;
  FileMessage error;
  if (!log.open(config.log, error)) return failed(error.c_str());
  const std::int32_t today = local_day_at(config.clock.now_utc_ns() / kNanosecondsPerSecond);
  Period period;
  parse_period(given.period.empty() ? "month" : given.period, today, period);
  const Replay replay =
      replay_days(log, period.first_day, period.last_day, config.control.guard.power_w);
  if (replay.compared == 0) return failed("the log holds no decision of the student in these days");
  const std::string text = given.json ? replay_json(replay).text() : replay_text(replay);
  if (given.each) std::fputs(replayed_cycles_text(replay).c_str(), stdout);
  std::fputs(text.c_str(), stdout);
  if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0) {
    return failed("the output cannot be written");
  }
  const std::int64_t differing_percent_of_all = std::int64_t{100} * replay.differing;
  const bool is_over = differing_percent_of_all > given.limit_percent * replay.compared;
  if (given.limit_percent < 0 || !is_over) return 0;
  report(JournalLevel::kError, "%.2f %% of the decisions would be others, more than --limit %lld",
         100 * replay.differing_share(), static_cast<long long>(given.limit_percent));
  return kOverTheLimit;
}

}  // namespace

const EdgeCommand kReplayCommand = {.name = "replay",
                                    .usage = "replay [PERIOD] [--config FILE] ...",
                                    .does = "what this version would have decided",
                                    .help = kHelp,
                                    .options = kOptions,
                                    .run = run_with<ReplayGiven, run_replay, complaint>};

}  // namespace bess
