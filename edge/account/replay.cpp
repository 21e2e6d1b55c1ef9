#include "edge/account/replay.h"

#include <algorithm>
#include <map>

#include "edge/account/account_days.h"
#include "edge/account/day_account.h"
#include "edge/control/policy.h"
#include "shared/host/text.h"
#include "shared/local_text.h"
#include "shared/utc_text.h"

namespace bess {
namespace {

std::size_t index(Action action) { return static_cast<std::size_t>(action); }

Action decide_again(const CycleRecord& record) {
  return decide_with_student(
      make_lattice_state(local_minute_of(record.utc_s), context_class_now(record),
                         record.measurement.soc_e4, decided_price_centi(record)));
}

double eur_per_mwh(const PriceReport& price) {
  return static_cast<double>(price.price_centi_eur_per_mwh) / kCentiPerEur;
}

/// A day while its mean price is not known yet.
struct OpenDay {
  ReplayedDay day;
  double prices_eur_per_mwh = 0;  ///< the sum over its cycles that have one
  int priced = 0;
  double mwh_moved = 0;  ///< that the new decisions charge more
  double paid_eur = 0;   ///< for it
};

void compare(const CycleRecord& record, double cycle_mwh, OpenDay& open, Replay& replay) {
  const Action before = record.student_action;
  const Action now = decide_again(record);
  ++open.day.compared;
  ++replay.decisions[index(before)][index(now)];
  if (before == now) return;
  replay.others.push_back(
      {record.utc_s, decided_price_centi(record), record.measurement.soc_e4, before, now});
  const double more_mwh = (power_sign(now) - power_sign(before)) * cycle_mwh;
  ++open.day.differing;
  open.mwh_moved += more_mwh;
  open.paid_eur += more_mwh * eur_per_mwh(record.price);
}

std::string day_line(const ReplayedDay& day) {
  return formatted("%s: %d of %d, %+.2f EUR", DayAccount(day.local_day).date().c_str(),
                   day.differing, day.compared, day.gained_eur);
}

}  // namespace

const ReplayedDay* Replay::worst_day() const {
  const auto worst = std::ranges::min_element(days, {}, &ReplayedDay::gained_eur);
  return worst == days.end() ? nullptr : &*worst;
}

Replay replay_days(const LogReader& log, std::int32_t first_day, std::int32_t last_day,
                   std::int32_t power_w) {
  const double cycle_mwh = power_w * kHoursPerStep / kWattsPerMegawatt;
  Replay replay;
  std::map<std::int32_t, OpenDay> days;
  for_each_record(log, first_day, last_day, [&](std::int32_t day, const CycleRecord& record) {
    OpenDay& open = days.try_emplace(day, OpenDay{{.local_day = day}}).first->second;
    if (record.has_measurement && record.price.has_row) {
      open.prices_eur_per_mwh += eur_per_mwh(record.price);
      ++open.priced;
    }
    const bool has_context =
        student_outlook() == nullptr || record.outlook.source != OutlookSource::kNone;
    if (record.has_student_action && record.context_class > 0 && has_context) {
      compare(record, cycle_mwh, open, replay);
    }
  });
  std::ranges::reverse(replay.others);  // the log is read from its end
  for (auto& [day, open] : days) {
    if (open.day.compared == 0) continue;
    open.day.gained_eur =
        open.mwh_moved * open.prices_eur_per_mwh / std::max(open.priced, 1) - open.paid_eur;
    replay.compared += open.day.compared;
    replay.differing += open.day.differing;
    replay.gained_eur += open.day.gained_eur;
    replay.days.push_back(open.day);
  }
  return replay;
}

std::string replayed_cycles_text(const Replay& replay) {
  std::string text;
  for (const ReplayedCycle& other : replay.others) {
    add_formatted(text, "%s local  price %.2f EUR/MWh, SoC %.1f %%: %s -> %s\n",
                  local_text(other.utc_s).c_str(),
                  static_cast<double>(other.price_centi_eur_per_mwh) / kCentiPerEur,
                  other.soc_e4 / 100.0, action_name(other.before).data(),
                  action_name(other.now).data());
  }
  return text;
}

std::string replay_text(const Replay& replay) {
  std::string text = formatted(
      "student %08x would decide otherwise in %d of %d cycles (%.2f %%), for about %+.2f EUR\n",
      student_hash(), replay.differing, replay.compared, 100 * replay.differing_share(),
      replay.gained_eur);
  for (int before = 0; before < kActionCount; ++before) {
    for (int now = 0; now < kActionCount; ++now) {
      const int cycles =
          replay.decisions[static_cast<std::size_t>(before)][static_cast<std::size_t>(now)];
      if (before == now || cycles == 0) continue;
      add_formatted(text, "%-9s -> %-9s %6d\n", action_name(static_cast<Action>(before)).data(),
                    action_name(static_cast<Action>(now)).data(), cycles);
    }
  }
  if (replay.differing == 0) return text;
  text += "worst day  " + day_line(*replay.worst_day()) + "\n";
  text +=
      "estimate: each decision by itself, at full power for two minutes, what it moves given back "
      "at the day's mean price\n";
  return text;
}

Json replay_json(const Replay& replay) {
  Json days = Json::list();
  for (const ReplayedDay& day : replay.days) {
    days.add(Json::object({{"date", DayAccount(day.local_day).date()},
                           {"compared", day.compared},
                           {"differing", day.differing},
                           {"gained_eur", Decimals{day.gained_eur, 4}}}));
  }
  Json others = Json::list();
  for (const ReplayedCycle& other : replay.others) {
    others.add(Json::object(
        {{"utc", utc_text(other.utc_s).view()},
         {"price_eur_per_mwh",
          Decimals{static_cast<double>(other.price_centi_eur_per_mwh) / kCentiPerEur, 2}},
         {"soc_percent", Decimals{other.soc_e4 / 100.0, 2}},
         {"before", action_name(other.before)},
         {"now", action_name(other.now)}}));
  }
  return Json::object({{"student", formatted("%08x", student_hash())},
                       {"compared", replay.compared},
                       {"differing", replay.differing},
                       {"differing_percent", Decimals{100 * replay.differing_share(), 4}},
                       {"gained_eur", Decimals{replay.gained_eur, 4}},
                       {"days", std::move(days)},
                       {"others", std::move(others)}});
}

}  // namespace bess
