#include "edge/account/statement.h"

#include <algorithm>
#include <cstdio>

#include "edge/account/drive.h"
#include "shared/host/text.h"
#include "shared/units_and_limits.h"
#include "shared/utc_text.h"

namespace bess {
namespace {

double driven_percent(int driven, int cycles) { return cycles == 0 ? 0 : 100.0 * driven / cycles; }

void set_money(Json& json, const QuarterHourMoney& money, double unseen_kwh) {
  json.set("estimated_eur", Decimals{money.estimated_eur, 4});
  json.set("contract_eur", Decimals{money.contract_eur, 4});
  json.set("net_eur", Decimals{money.net_eur(), 4});
  json.set("quarter_hours", money.quarter_hours);
  json.set("settled_quarter_hours", money.published);
  json.set("validated_quarter_hours", money.validated);
  json.set("unpriced_quarter_hours", money.unpriced);
  json.set("unseen_kwh", Decimals{unseen_kwh, 3});
}

}  // namespace

template <typename OfDay>
double Statement::sum(const OfDay& of_day) const {
  double total = 0;
  for (const DayAccount& day : days_) total += of_day(day);
  return total;
}

double Statement::earned_eur() const {
  return sum([](const DayAccount& day) { return day.earned_eur(); });
}
double Statement::charged_kwh() const {
  return sum([](const DayAccount& day) { return day.charged_kwh(); });
}
double Statement::discharged_kwh() const {
  return sum([](const DayAccount& day) { return day.discharged_kwh(); });
}

double Statement::unseen_kwh() const {
  return sum([](const DayAccount& day) { return day.unseen_kwh(); });
}

QuarterHourMoney Statement::money() const {
  QuarterHourMoney money;
  for (const DayAccount& day : days_) money.add(day.money());
  return money;
}

const DayAccount* Statement::first_measured() const {
  const auto found = std::ranges::find_if(days_, &DayAccount::has_soc);
  return found == days_.end() ? nullptr : &*found;
}

const DayAccount* Statement::last_measured() const {
  const auto found = std::find_if(days_.rbegin(), days_.rend(),
                                  [](const DayAccount& day) { return day.has_soc(); });
  return found == days_.rend() ? nullptr : &*found;
}

double Statement::first_soc_frac() const {
  return has_soc() ? static_cast<double>(first_measured()->first_soc_e4()) / kSocFullE4 : 0;
}
double Statement::capacity_wh() const { return has_soc() ? last_measured()->capacity_wh() : 0; }

std::int32_t Statement::stored_e4() const {
  return has_soc() ? last_measured()->last_soc_e4() - first_measured()->first_soc_e4() : 0;
}

double Statement::stored_kwh() const {
  return static_cast<double>(stored_e4()) / kSocFullE4 * capacity_wh() / 1'000;
}

double Statement::worth_eur(std::int32_t more_e4) const {
  return stored_worth_eur(contract_.applied_to({.capacity_wh = capacity_wh()}),
                          static_cast<double>(more_e4) / kSocFullE4, mean_price_eur_per_mwh());
}

double Statement::stored_eur() const { return worth_eur(stored_e4()); }

double Statement::day_at_equal_soc_eur(const DayAccount& day) const {
  return day.money().net_eur() +
         (day.has_soc() ? worth_eur(day.last_soc_e4() - day.first_soc_e4()) : 0);
}

CyclesByReason Statement::cycles_by_reason() const {
  CyclesByReason together{};
  for (const DayAccount& day : days_) {
    for (std::size_t i = 0; i < together.size(); ++i) together[i] += day.cycles_by_reason()[i];
  }
  return together;
}

std::string Statement::money_text() const {
  const QuarterHourMoney all = money();
  std::string text;
  add_formatted(text, "earned by quarter-hours: of %d, %d at the settled price", all.quarter_hours,
                all.published);
  if (all.published > 0) add_formatted(text, " (%d validated)", all.validated);
  if (all.published + all.unpriced < all.quarter_hours) {
    add_formatted(text, ", the others at the last of their minutes: %+.2f EUR is an estimate",
                  all.estimated_eur);
  }
  if (all.unpriced > 0) add_formatted(text, ", %d without any", all.unpriced);
  if (!contract_.is_free()) {
    add_formatted(text, "\nthe contract takes %.2f EUR (%s): %+.2f EUR net", all.contract_eur,
                  contract_.text().c_str(), all.net_eur());
  }
  if (unseen_kwh() > 0) {
    add_formatted(text, "\n%.2f kWh flowed while nobody looked, by the state of charge",
                  unseen_kwh());
  }
  return text + "\n";
}

std::string Statement::text() const {
  std::string text =
      "day         earned EUR  charged kWh  discharged kWh  full cycles  driven  EUR/MWh\n";
  int cycles = 0;
  int driven = 0;
  double full_cycles = 0;
  for (const DayAccount& day : days_) {
    add_formatted(text, "%s  %+10.2f  %11.1f  %14.1f  %11.2f  %4.0f %%  %7.2f\n",
                  day.date().c_str(), day.earned_eur(), day.charged_kwh(), day.discharged_kwh(),
                  day.full_cycles(), driven_percent(day.driven_cycles(), day.cycles()),
                  day.money().mean_price_eur_per_mwh());
    cycles += day.cycles();
    driven += day.driven_cycles();
    full_cycles += day.full_cycles();
  }
  if (days_.size() > 1) {
    add_formatted(text, "together    %+10.2f  %11.1f  %14.1f  %11.2f  %4.0f %%  %7.2f\n",
                  earned_eur(), charged_kwh(), discharged_kwh(), full_cycles,
                  driven_percent(driven, cycles), mean_price_eur_per_mwh());
  }
  text += money_text();
  add_formatted(
      text,
      "at the end %.1f kWh %s are stored than at the beginning, worth %.2f EUR at the mean price: "
      "%+.2f EUR with the same charge at both ends\n",
      std::abs(stored_kwh()), stored_kwh() < 0 ? "less" : "more", std::abs(stored_eur()),
      earned_at_equal_soc_eur());
  const std::string others = interventions_text(cycles_by_reason());
  if (!others.empty())
    add_formatted(text, "cycles that the student did not decide: %s\n", others.c_str());
  return text;
}

std::string Statement::csv() const {
  std::string text =
      "date,earned_eur,charged_kwh,discharged_kwh,full_cycles,cycles,driven_cycles,valued_cycles,"
      "mean_price_eur_per_mwh,first_soc_percent,last_soc_percent,contract_eur,net_eur,"
      "quarter_hours,settled_quarter_hours,validated_quarter_hours,unpriced_quarter_hours,"
      "unseen_kwh,estimated_eur\n";
  for (const DayAccount& day : days_) {
    add_formatted(text, "%s,%.4f,%.3f,%.3f,%.4f,%d,%d,%d,%.2f", day.date().c_str(),
                  day.earned_eur(), day.charged_kwh(), day.discharged_kwh(), day.full_cycles(),
                  day.cycles(), day.driven_cycles(), day.valued_cycles(),
                  day.money().mean_price_eur_per_mwh());
    if (day.has_soc()) {
      add_formatted(text, ",%.2f,%.2f", day.first_soc_e4() / 100.0, day.last_soc_e4() / 100.0);
    } else {
      text += ",,";
    }
    const QuarterHourMoney& money = day.money();
    add_formatted(text, ",%.4f,%.4f,%d,%d,%d,%d,%.3f,%.4f\n", money.contract_eur, money.net_eur(),
                  money.quarter_hours, money.published, money.validated, money.unpriced,
                  day.unseen_kwh(), money.estimated_eur);
  }
  return text;
}

Json Statement::json() const {
  Json days = Json::list();
  for (const DayAccount& day : days_) {
    Json reasons = Json::object();
    for (int i = 0; i < kReasonCount; ++i) {
      const auto reason = static_cast<Reason>(i);
      if (day.cycles_with(reason) > 0)
        reasons.set(reason_name(reason).data(), day.cycles_with(reason));
    }
    const auto soc = [&](std::int32_t soc_e4) {
      return day.has_soc() ? Json(Decimals{soc_e4 / 100.0, 2}) : Json::null();
    };
    Json of_day =
        Json::object({{"date", day.date()},
                      {"start_utc", utc_text(day.start_utc_s()).view()},
                      {"line", day.line()},
                      {"earned_eur", Decimals{day.earned_eur(), 4}},
                      {"charged_kwh", Decimals{day.charged_kwh(), 3}},
                      {"discharged_kwh", Decimals{day.discharged_kwh(), 3}},
                      {"full_cycles", Decimals{day.full_cycles(), 4}},
                      {"cycles", day.cycles()},
                      {"interventions", day.interventions()},
                      {"driven_cycles", day.driven_cycles()},
                      {"valued_cycles", day.valued_cycles()},
                      {"mean_price_eur_per_mwh", Decimals{day.money().mean_price_eur_per_mwh(), 2}},
                      {"first_soc_percent", soc(day.first_soc_e4())},
                      {"last_soc_percent", soc(day.last_soc_e4())},
                      {"cycles_by_reason", std::move(reasons)}});
    set_money(of_day, day.money(), day.unseen_kwh());
    days.add(std::move(of_day));
  }
  Json all = Json::object({{"earned_eur", Decimals{earned_eur(), 4}},
                           {"charged_kwh", Decimals{charged_kwh(), 3}},
                           {"discharged_kwh", Decimals{discharged_kwh(), 3}},
                           {"stored_kwh", Decimals{stored_kwh(), 3}},
                           {"stored_eur", Decimals{stored_eur(), 4}},
                           {"earned_at_equal_soc_eur", Decimals{earned_at_equal_soc_eur(), 4}},
                           {"mean_price_eur_per_mwh", Decimals{mean_price_eur_per_mwh(), 2}}});
  set_money(all, money(), unseen_kwh());
  all.set("contract", contract_.json());
  all.set("days", std::move(days));
  return all;
}

}  // namespace bess
