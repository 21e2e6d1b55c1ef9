#include "workstation/runs/log/log_input.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "shared/host/user_error.h"
#include "shared/local_time.h"
#include "shared/utc_text.h"
#include "workstation/base/answer.h"
#include "workstation/correction/student/student_policy.h"
#include "workstation/data/market/series/local_date.h"

namespace bess {
namespace {

std::size_t index(Action action) { return static_cast<std::size_t>(action); }

void compare(const LoggedCycle& c, Action now, double cycle_mwh, ReplayedDay& day,
             LogReplay& replay) {
  ++day.compared;
  ++replay.decisions[index(*c.student)][index(now)];
  if (*c.student == now) return;
  replay.others.push_back({c.utc_s, c.decided_eur_per_mwh, c.soc_frac, *c.student, now});
  const double more_mwh = (power_sign(now) - power_sign(*c.student)) * cycle_mwh;
  ++day.differing;
  day.mwh_moved += more_mwh;
  day.gained_eur -= more_mwh * c.price_eur_per_mwh;
}

}  // namespace

LogReplay replay_log(const CycleLog& log, const LoggedSpan& span, const StudentNet& student) {
  const double cycle_mwh = most_ordered_w(log) * kHoursPerStep / kWattsPerMegawatt;
  const ContextKind context = student.context.kind;
  const StudentPolicy policy(student);
  LogReplay replay;
  replay.student_hash = student_weights_hash(student);
  std::map<std::int32_t, ReplayedDay> days;
  for (const LoggedCycle& c : log.cycles) {
    const LocalMinute local = local_minute_of(c.utc_s);
    if (!span.holds(local_day_of(local)) || !c.has_reading || !c.has_price) continue;
    ReplayedDay& day = days[local_day_of(local)];
    day.date = format_local_date({local.year, local.month, local.day});
    day.prices_eur_per_mwh += c.price_eur_per_mwh;
    ++day.priced;
    if (!c.student) continue;
    if (context == ContextKind::kOutlook && !c.break_even_centi) {
      ++replay.without_context;
      continue;
    }
    compare(c, policy.decide(step_of(c, context), 0, c.soc_frac), cycle_mwh, day, replay);
  }
  for (auto& [date, day] : days) {
    if (day.compared == 0) continue;
    day.gained_eur += day.mwh_moved * day.prices_eur_per_mwh / day.priced;
    replay.compared += day.compared;
    replay.differing += day.differing;
    replay.gained_eur += day.gained_eur;
    replay.days.push_back(std::move(day));
  }
  if (replay.compared > 0) return replay;
  if (replay.without_context > 0) {
    fail(
        "the student decides by the outlook, but none of the {} logged decisions has one: use a "
        "log of a controller with [outlook]",
        replay.without_context);
  }
  fail("the log has no decision of a student on these days; change --from or --to");
}

std::string LogReplay::text() const {
  std::string text =
      fmt::format("student {:08x} changes {} of {} decisions ({:.2f} %), worth about {:+.2f} EUR\n",
                  student_hash, differing, compared, differing_percent(), gained_eur);
  for (const Action before : {Action::kDischarge, Action::kIdle, Action::kCharge}) {
    for (const Action now : {Action::kDischarge, Action::kIdle, Action::kCharge}) {
      const int cycles = decisions[index(before)][index(now)];
      if (before == now || cycles == 0) continue;
      text += fmt::format("{:<9} -> {:<9} {:6}\n", action_name(before), action_name(now), cycles);
    }
  }
  if (without_context > 0)
    text += fmt::format("{} control cycles without an outlook\n", without_context);
  if (differing == 0) return text;
  const ReplayedDay& worst = *std::ranges::min_element(days, {}, &ReplayedDay::gained_eur);
  return text +
         fmt::format(
             "worst day  {}: {} of {}, {:+.2f} EUR\n"
             "estimate: each decision alone, full power for two minutes, offset at the day's "
             "mean price\n",
             worst.date, worst.differing, worst.compared, worst.gained_eur);
}

Json LogReplay::json() const {
  Json json = answer("log_replay", {{"weights_hash", fmt::format("{:08x}", student_hash)},
                                    {"compared", compared},
                                    {"differing", differing},
                                    {"differing_percent", Decimals{differing_percent(), 4}},
                                    {"without_context", without_context},
                                    {"gained_eur", Decimals{gained_eur, 4}}});
  json.set("days", Json::list_from(days, [](const ReplayedDay& day) {
             return Json::object({{"date", day.date},
                                  {"compared", day.compared},
                                  {"differing", day.differing},
                                  {"gained_eur", Decimals{day.gained_eur, 4}}});
           }));
  json.set("others", Json::list_from(others, [](const ReplayedCycle& other) {
             return Json::object({{"utc", utc_text(other.utc_s).view()},
                                  {"price_eur_per_mwh", Decimals{other.price_eur_per_mwh, 2}},
                                  {"soc_percent", Decimals{100 * other.soc_frac, 2}},
                                  {"before", action_name(other.before)},
                                  {"now", action_name(other.now)}});
           }));
  return json;
}

}  // namespace bess
