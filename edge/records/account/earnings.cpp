#include <cmath>

#include "edge/records/account/day_accounts.h"
#include "shared/host/text.h"
#include "shared/utc_text.h"

namespace bess {
namespace {

/// Column in CSV and JSON, of a day and of the sum.
struct Column {
  const char* name;
  int decimals;
  double (*of)(const DayAccount&);
};
using D = DayAccount;
constexpr Column kColumns[] = {
    {"earned_eur", 4, [](const D& d) { return d.exchanged.money.earned_eur; }},
    {"charged_kwh", 3, [](const D& d) { return d.charged_kwh(); }},
    {"discharged_kwh", 3, [](const D& d) { return d.discharged_kwh(); }},
    {"full_cycles", 4, [](const D& d) { return d.full_cycles(); }},
    {"cycles", 0, [](const D& d) { return double(d.cycles); }},
    {"driven_cycles", 0, [](const D& d) { return double(d.driven_cycles); }},
    {"valued_cycles", 0, [](const D& d) { return double(d.valued_cycles); }},
    {"mean_price_eur_per_mwh", 2,
     [](const D& d) { return d.exchanged.money.mean_price_eur_per_mwh(); }},
    {"first_soc_percent", 2, [](const D& d) { return d.first_soc_percent(); }},
    {"last_soc_percent", 2, [](const D& d) { return d.last_soc_percent(); }},
    {"quarter_hours", 0, [](const D& d) { return double(d.exchanged.money.quarter_hours); }},
    {"settled_quarter_hours", 0, [](const D& d) { return double(d.exchanged.money.published); }},
    {"validated_quarter_hours", 0, [](const D& d) { return double(d.exchanged.money.validated); }},
    {"unpriced_quarter_hours", 0, [](const D& d) { return double(d.exchanged.money.unpriced); }},
    {"unseen_kwh", 3, [](const D& d) { return d.unseen_kwh(); }},
    {"estimated_eur", 4, [](const D& d) { return d.exchanged.money.estimated_eur; }},
};

void set_columns(Json& json, const DayAccount& account) {
  for (const Column& column : kColumns) {
    json.set(column.name, Decimals{column.of(account), column.decimals});
  }
}

std::string table_line(const std::string& name, const DayAccount& account) {
  const double driven_percent =
      account.cycles == 0 ? 0 : 100.0 * account.driven_cycles / account.cycles;
  return formatted("%-10s  %+10.2f  %11.1f  %14.1f  %11.2f  %4.0f %%  %7.2f\n", name.c_str(),
                   account.exchanged.money.earned_eur, account.charged_kwh(),
                   account.discharged_kwh(), account.full_cycles(), driven_percent,
                   account.exchanged.money.mean_price_eur_per_mwh());
}

std::string money_text(const DayAccount& all) {
  const QuarterHourMoney& money = all.exchanged.money;
  std::string text = formatted("earned by quarter-hours: of %d, %d at the settled price",
                               money.quarter_hours, money.published);
  if (money.published > 0) add_formatted(text, " (%d validated)", money.validated);
  if (money.published + money.unpriced < money.quarter_hours) {
    add_formatted(text, ", the others at their last indicative price: %+.2f EUR is an estimate",
                  money.estimated_eur);
  }
  if (money.unpriced > 0) add_formatted(text, ", %d without a price", money.unpriced);
  if (all.unseen_kwh() > 0) {
    add_formatted(text, "\n%.2f kWh unmetered energy (estimated from the SoC)", all.unseen_kwh());
  }
  return text + "\n";
}

/// Reasons that replaced the student's decision.
Json stops_json(const DayAccount& all) {
  Json reasons = Json::list();
  for (std::size_t i = 0; i < all.cycles_by_reason.size(); ++i) {
    const auto reason = static_cast<Reason>(i);
    if (all.cycles_by_reason[i] == 0 || reason == Reason::kStudent) continue;
    reasons.add(Json::object({{"reason", reason_name(reason)},
                              {"meaning", info_of(reason).meaning},
                              {"cycles", all.cycles_by_reason[i]},
                              {"not_driven", all.not_driven_by_reason[i]}}));
  }
  return Json::object({{"driven_share", Decimals{all.driven_share(), 4}},
                       {"missing_cycles", all.missing_cycles},
                       {"by_reason", std::move(reasons)}});
}

Json day_json(const DayAccount& day) {
  Json json = Json::object({{"date", local_day_text(day.local_day)},
                            {"start_utc", utc_text(local_day_start_utc_s(day.local_day)).view()},
                            {"line", day.line()},
                            {"interventions", day.interventions()}});
  set_columns(json, day);
  json.set("stops", stops_json(day));
  return json;
}

}  // namespace

DayAccount sum_of(const std::vector<DayAccount>& days) {
  DayAccount sum;
  for (const DayAccount& day : days) sum.add(day);
  return sum;
}

std::string earnings_text(const std::vector<DayAccount>& days) {
  const DayAccount together = sum_of(days);
  std::string text =
      "day         earned EUR  charged kWh  discharged kWh  full cycles  driven  mean EUR/MWh\n";
  for (const DayAccount& day : days) text += table_line(local_day_text(day.local_day), day);
  if (days.size() > 1) text += table_line("total", together);
  text += money_text(together);
  add_formatted(
      text,
      "stored energy: %.1f kWh %s at the end, worth %.2f EUR at the mean price: %+.2f EUR at equal "
      "SoC\n",
      std::fabs(together.stored_kwh()), together.stored_kwh() < 0 ? "less" : "more",
      std::fabs(together.stored_eur()),
      together.exchanged.money.earned_eur + together.stored_eur());
  add_formatted(text, "in control %.1f %% of the time", 100 * together.driven_share());
  if (together.missing_cycles > 0) {
    add_formatted(text, "; %d control cycles without a record", together.missing_cycles);
  }
  const std::string others = together.interventions_text();
  if (!others.empty()) text += "\ncontrol cycles by other reasons: " + others;
  return text + "\n";
}

std::string earnings_csv(const std::vector<DayAccount>& days) {
  std::string text = "date";
  for (const Column& column : kColumns) text += std::string(",") + column.name;
  for (const DayAccount& day : days) {
    text += "\n" + local_day_text(day.local_day);
    for (const Column& column : kColumns) {
      const double value = column.of(day);
      text += std::isnan(value) ? "," : formatted(",%.*f", column.decimals, value);
    }
  }
  return text + "\n";
}

Json earnings_json(const std::vector<DayAccount>& days) {
  const DayAccount together = sum_of(days);
  Json all = Json::object();
  set_columns(all, together);
  all.set("stored_kwh", Decimals{together.stored_kwh(), 3});
  all.set("stored_eur", Decimals{together.stored_eur(), 4});
  all.set("earned_at_equal_soc_eur",
          Decimals{together.exchanged.money.earned_eur + together.stored_eur(), 4});
  all.set("stops", stops_json(together));
  all.set("days", Json::list_from(days, day_json));
  return all;
}

}  // namespace bess
