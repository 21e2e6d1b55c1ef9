#include "edge/account/comparison.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "edge/control/policy.h"
#include "shared/host/text.h"
#include "shared/units_and_limits.h"

namespace bess {
namespace {

double eur_of(std::int32_t centi) { return static_cast<double>(centi) / kCentiPerEur; }

std::string rule_text(const QuartileRule& rule) {
  std::string text = formatted("the rule charges below %.2f and discharges above %.2f EUR/MWh, ",
                               eur_of(rule.low_centi), eur_of(rule.high_centi));
  text += rule.days > 0 ? formatted("the quartiles of the prices of %d days before", rule.days)
                        : "the quartiles of the prices that this student learnt on: the log holds "
                          "less than a week before";
  return text + "\n";
}

}  // namespace

double Comparison::ahead_eur(const Rival& rival) const {
  return battery.earned_at_equal_soc_eur() - rival.at_equal_charge_eur;
}

double Comparison::error_eur(const Rival& rival) const {
  constexpr std::size_t kDaysMin = 8;
  const auto days = static_cast<double>(battery.days().size());
  if (battery.days().size() < kDaysMin) return std::numeric_limits<double>::quiet_NaN();
  double sum = 0, squares = 0;
  for (const DayAccount& day : battery.days()) {
    const auto found = rival.by_day.find(day.local_day());
    const double rival_eur = found == rival.by_day.end() ? 0 : found->second;
    const double ahead = battery.day_at_equal_soc_eur(day) - rival_eur;
    sum += ahead;
    squares += ahead * ahead;
  }
  return std::sqrt(std::max(squares - sum * sum / days, 0.0) * days / (days - 1));
}

std::string Comparison::text() const {
  const double earned_eur = battery.earned_at_equal_soc_eur();
  std::string text = formatted("%-38s  %10s  with the same charge at both ends\n",
                               "on the same prices, paid alike", "paid EUR");
  const auto row = [&](const std::string& name, double paid_eur, double together_eur) {
    add_formatted(text, "  %-36s  %+10.2f  %+10.2f", name.c_str(), paid_eur, together_eur);
  };
  row("this battery", battery.money().net_eur(), earned_eur);
  text += "\n";
  const auto rival_row = [&](const std::string& name, const Rival& rival) {
    row(name, rival.paid_eur, rival.at_equal_charge_eur);
    add_formatted(text, ": this battery %+.2f", ahead_eur(rival));
    const double error = error_eur(rival);
    if (!std::isnan(error)) add_formatted(text, " ± %.2f over days", error);
    text += "\n";
  };
  rival_row("at rest", {});
  rival_row("a rule", rivals.rule);
  rival_row(formatted("student %08x, undisturbed", student_hash()), rivals.student);
  rival_row("foresight, the most in each column", rivals.foresight);
  if (rivals.foresight.at_equal_charge_eur > 0) {
    add_formatted(text, "%.0f %% of foresight\n",
                  100 * earned_eur / rivals.foresight.at_equal_charge_eur);
  }
  text += "paid by quarter-hours, less the contract; where the log has no price all rest\n";
  text += rule_text(rule);
  if (student_outlook() != nullptr) {
    text += "the student's plan is known at the battery's own charge alone: an estimate\n";
  }
  if (decided_otherwise > 0) {
    add_formatted(text,
                  "student %08x is this program's: in %d of %d cycles that of the time decided "
                  "otherwise\n",
                  student_hash(), decided_otherwise, decided);
  }
  return text;
}

Json Comparison::json() const {
  Json json = Json::object({{"this_battery_eur", Decimals{battery.earned_at_equal_soc_eur(), 4}},
                            {"rest_eur", Decimals{0, 4}}});
  Json paid = Json::object({{"this_battery_eur", Decimals{battery.money().net_eur(), 4}}});
  Json errors = Json::object();
  const auto add = [&](const char* name, const Rival& rival) {
    json.set(name, Decimals{rival.at_equal_charge_eur, 4});
    paid.set(name, Decimals{rival.paid_eur, 4});
    errors.set(name, Decimals{error_eur(rival), 4});
  };
  add("rule_eur", rivals.rule);
  add("student_undisturbed_eur", rivals.student);
  add("foresight_eur", rivals.foresight);
  if (rivals.foresight.at_equal_charge_eur > 0) {
    json.set("share_of_foresight",
             Decimals{battery.earned_at_equal_soc_eur() / rivals.foresight.at_equal_charge_eur, 4});
  }
  json.set("paid", std::move(paid));
  json.set("error_of_difference", std::move(errors));
  json.set("rule",
           Json::object({{"charge_below_eur_per_mwh", Decimals{eur_of(rule.low_centi), 2}},
                         {"discharge_above_eur_per_mwh", Decimals{eur_of(rule.high_centi), 2}},
                         {"days_before", rule.days}}));
  json.set("student", formatted("%08x", student_hash()));
  json.set("student_decided", decided);
  json.set("student_decided_otherwise", decided_otherwise);
  return json;
}

}  // namespace bess
