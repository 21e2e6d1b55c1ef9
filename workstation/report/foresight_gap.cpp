#include "workstation/report/foresight_gap.h"

#include <fmt/core.h>

#include <algorithm>
#include <limits>
#include <map>
#include <optional>

#include "shared/local_time.h"
#include "shared/utc_text.h"
#include "workstation/correction/rules/ruled_policy.h"
#include "workstation/correction/student/student_policy.h"
#include "workstation/data/env/day_errors.h"
#include "workstation/policy/planners/foresight.h"
#include "workstation/report/figures/html.h"
#include "workstation/report/report.h"

namespace bess {

namespace {

/// Tolerance at the ends of the SoC window, below the resolution of the student.
constexpr double kAtTheEndFrac = 0.005;

constexpr std::array<LossCauseText, kLossCauseCount> kTexts{{
    {"dear_missed", "missed high price",
     "discharging was optimal, but the policy did not discharge"},
    {"cheap_missed", "missed low price", "charging was optimal, but the policy did not charge"},
    {"empty", "empty at a high price",
     "too little charge kept or bought: the battery was empty at a high price later that day"},
    {"full", "full at a low price",
     "too much charge kept or bought: the battery was full at a low price later that day"},
    {"timing", "sold or bought too early", "idle was optimal"},
    {"newest_price", "newest price differs from paid price",
     "with the paid price as input, the student would have decided better"},
    {"outage", "price outage", "the same, while the newest price was late"},
    {"rules", "a rule or the guard",
     "without the rules the plain student would have decided better"},
    {"correction", "the correction",
     "the student without correction would have decided better at the same SoC"},
    {"cycle_limit", "cycle limit", "the full cycles of the day were used up, or saved for later"},
    {"rounding", "rounding", "of the foresight plan, which uses a SoC grid"},
}};

double median_paid(const std::vector<StepRecord>& records) {
  std::vector<double> paid;
  for (const StepRecord& r : records) paid.push_back(r.paid_eur_per_mwh);
  std::ranges::nth_element(paid, paid.begin() + static_cast<std::ptrdiff_t>(paid.size() / 2));
  return paid[paid.size() / 2];
}

/// Extreme prices after each step at which the battery is at an end of its SoC window.
struct RemainingExtremes {
  std::vector<double> dearest_while_empty;  ///< paid, EUR/MWh; -inf: not empty later
  std::vector<double> cheapest_while_full;  ///< +inf: not full later
  double usual_eur_per_mwh;                 ///< median of the day

  RemainingExtremes(const std::vector<StepRecord>& records, const BatteryParameters& battery)
      : dearest_while_empty(records.size()),
        cheapest_while_full(records.size()),
        usual_eur_per_mwh(median_paid(records)) {
    double dearest = -std::numeric_limits<double>::infinity();
    double cheapest = std::numeric_limits<double>::infinity();
    for (std::size_t i = records.size(); i-- > 0;) {
      dearest_while_empty[i] = dearest;
      cheapest_while_full[i] = cheapest;
      const StepRecord& r = records[i];
      if (r.soc_frac <= battery.soc_min_frac + kAtTheEndFrac) {
        dearest = std::max(dearest, r.paid_eur_per_mwh);
      }
      if (r.soc_frac >= battery.soc_max_frac - kAtTheEndFrac) {
        cheapest = std::min(cheapest, r.paid_eur_per_mwh);
      }
    }
  }

  /// Empty later at a higher price that is further from the median.
  [[nodiscard]] bool empty_is_to_blame(std::size_t i, double paid) const {
    const double dear = dearest_while_empty[i];
    return dear >= paid && dear - usual_eur_per_mwh >= usual_eur_per_mwh - paid;
  }
  [[nodiscard]] bool full_is_to_blame(std::size_t i, double paid) const {
    const double cheap = cheapest_while_full[i];
    return cheap <= paid && usual_eur_per_mwh - cheap >= paid - usual_eur_per_mwh;
  }
};

/// Step with the paid price as newest price.
MarketStep with_paid_price_shown(MarketStep step) {
  step.observed_eur_per_mwh = step.paid_eur_per_mwh;
  step.observed_age_min = 0;
  return step;
}

/// Action at a step and SoC, with its value.
struct Answer {
  Action action;
  double worth_eur;
};

/// Losses of one day of one policy.
struct DayJudge {
  const LossChain& chain;
  const BatteryParameters& battery;
  const ForesightPolicy& bound;
  int usual_age_min;

  void judge(std::span<const MarketStep> steps, const std::vector<StepRecord>& records,
             DayLoss& loss) const {
    const RemainingExtremes ends(records, battery);
    for (std::size_t i = 0; i < steps.size(); ++i) judge_step(i, steps[i], records[i], ends, loss);
    double sum = 0;
    for (const double part : loss.part_eur) sum += part;
    // With a cycle limit, the plan includes the shadow price of throughput, which is not in
    // profits.
    const LossCause rest =
        battery.cycles_per_day_max > 0 ? LossCause::kCycleLimit : LossCause::kRounding;
    loss.part_eur[static_cast<std::size_t>(rest)] += loss.missed_eur() - sum;
  }

  [[nodiscard]] Answer answer(std::size_t i, double soc_frac, Action action, double share) const {
    return {action, bound.worth_eur(i, soc_frac, power_sign(action) * battery.power_w_max * share)};
  }
  [[nodiscard]] Answer ask(const Policy& policy, const MarketStep& shown, std::size_t i,
                           double soc_frac) const {
    return answer(i, soc_frac, policy.decide(shown, i, soc_frac),
                  policy.power_share_max(shown, soc_frac));
  }
  [[nodiscard]] Answer best(std::size_t i, double soc_frac) const {
    Answer best = answer(i, soc_frac, Action::kIdle, 1);
    for (const Action action : {Action::kDischarge, Action::kCharge}) {
      const Answer other = answer(i, soc_frac, action, 1);
      if (other.worth_eur > best.worth_eur) best = other;
    }
    return best;
  }

  void judge_step(std::size_t i, const MarketStep& step, const StepRecord& record,
                  const RemainingExtremes& ends, DayLoss& loss) const {
    const double soc = record.soc_frac;
    const Answer optimum = best(i, soc);
    const Answer done{record.action, bound.worth_eur(i, soc, record.power_w)};
    const std::size_t hour = static_cast<std::size_t>(step.quarter_hour) / 4;
    loss.regret_eur[hour] += optimum.worth_eur - done.worth_eur;
    Answer now = done;
    const auto add = [&](LossCause cause, const Answer& freer) {
      const auto c = static_cast<std::size_t>(cause);
      const double eur = freer.worth_eur - now.worth_eur;
      loss.part_eur[c] += eur;
      if (eur > loss.moment[c].eur) {
        loss.moment[c] = {eur, step, soc, record.action, optimum.action};
      }
      now = freer;
    };
    const Policy* last = &chain.policy;
    const Answer wanted = ask(*last, step, i, soc);
    if (wanted.action != record.action) {  // cycle limit reached
      add(LossCause::kCycleLimit, optimum);
      return;
    }
    if (chain.under_rules != nullptr) {
      last = chain.under_rules;
      add(LossCause::kCorrection, ask(*last, step, i, soc));
    }
    if (chain.plain != nullptr) {
      last = chain.plain;
      const bool has_rules = chain.under_rules != nullptr;
      add(has_rules ? LossCause::kRules : LossCause::kCorrection, ask(*last, step, i, soc));
    }
    add(step.observed_age_min > usual_age_min ? LossCause::kOutage : LossCause::kNewestPrice,
        ask(*last, with_paid_price_shown(step), i, soc));
    add(cause_of_the_future(now.action, optimum.action, step.paid_eur_per_mwh, i, ends), optimum);
  }

  static LossCause cause_of_the_future(Action wanted, Action best, double paid_eur_per_mwh,
                                       std::size_t i, const RemainingExtremes& ends) {
    const bool leaves_too_little = power_sign(wanted) < power_sign(best);
    if (leaves_too_little && ends.empty_is_to_blame(i, paid_eur_per_mwh)) return LossCause::kEmpty;
    if (!leaves_too_little && ends.full_is_to_blame(i, paid_eur_per_mwh)) return LossCause::kFull;
    if (best == Action::kDischarge) return LossCause::kDearMissed;
    if (best == Action::kCharge) return LossCause::kCheapMissed;
    return LossCause::kTiming;
  }
};

constexpr std::size_t kWorstDays = 8;
constexpr double kNamedShare = 0.1;  ///< minimum share of a day's gap for a named cause

LossCause cause_at(std::size_t index) { return static_cast<LossCause>(index); }

std::string number(double value) { return with_true_minus(fmt::format("{:.1f}", value + 0.0)); }

/// Means over days, EUR per day per MWh.
struct Means {
  double missed = 0;
  std::array<double, kLossCauseCount> part{};

  Means(const std::vector<DayLoss>& losses, double capacity_mwh) {
    const double share = 1 / (capacity_mwh * static_cast<double>(losses.size()));
    for (const DayLoss& day : losses) {
      missed += day.missed_eur() * share;
      for (std::size_t c = 0; c < kLossCauseCount; ++c) part[c] += day.part_eur[c] * share;
    }
  }
};

/// "2023-01" -> mean regret by hour, EUR per day per MWh.
std::map<std::string, std::array<HeatValue, kHoursPerDay>> regret_by_month(
    const std::vector<DayLoss>& losses, double capacity_mwh) {
  std::map<std::string, std::array<std::vector<DayValue>, kHoursPerDay>> days;
  for (const DayLoss& day : losses) {
    auto& hours = days[day.date.substr(0, kMonthTextLength)];
    for (std::size_t h = 0; h < kHoursPerDay; ++h) {
      hours[h].emplace_back(day.date, day.regret_eur[h] / capacity_mwh);
    }
  }
  std::map<std::string, std::array<HeatValue, kHoursPerDay>> months;
  for (const auto& [month, hours] : days) {
    for (std::size_t h = 0; h < kHoursPerDay; ++h) {
      months[month][h] = {mean_of(hours[h]), day_errors(hours[h]).plain};
    }
  }
  return months;
}

/// Causes by size, without zero parts.
std::vector<LossCause> causes_of(const std::array<double, kLossCauseCount>& part) {
  std::vector<LossCause> causes;
  for (std::size_t c = 0; c < kLossCauseCount; ++c) {
    if (part[c] != 0) causes.push_back(cause_at(c));
  }
  std::ranges::stable_sort(causes, std::ranges::greater{},
                           [&](LossCause cause) { return part[static_cast<std::size_t>(cause)]; });
  return causes;
}

std::string causes_html(const Means& means) {
  std::string text =
      "<figure id=\"lost-causes\"><figcaption>By cause<small>mean over the test days, EUR per day "
      "per MWh of capacity; the parts add up to the gap " +
      csv_link("lost_causes.csv") +
      "</small></figcaption>\n<table class=\"causes\"><thead><tr><th scope=\"col\">Cause</th><th "
      "scope=\"col\">EUR/day/MWh</th><th scope=\"col\">% of gap</th></tr></thead>\n<tbody>\n";
  double reach = 0;
  for (const double part : means.part) reach = std::max(reach, std::abs(part));
  for (const LossCause cause : causes_of(means.part)) {
    const double part = means.part[static_cast<std::size_t>(cause)];
    text += fmt::format(
        "<tr><th scope=\"row\">{}<small>{}</small><i class=\"{}\" "
        "style=\"--share:{:.1f}%\"></i></th><td data-label=\"EUR/day/MWh\">{}</td><td "
        "data-label=\"% of gap\">{}</td></tr>\n",
        text_of(cause).name, text_of(cause).meaning, part < 0 ? "helped" : "lost",
        100 * std::abs(part) / reach, number(part), number(100 * part / means.missed));
  }
  return text +
         fmt::format(
             "<tr class=\"sum\"><th scope=\"row\">gap</th><td "
             "data-label=\"EUR/day/MWh\">{}</td><td data-label=\"% of gap\">100.0</td></tr>\n"
             "</tbody></table></figure>\n",
             number(means.missed));
}

std::string heat_html(const std::vector<DayLoss>& losses, double capacity_mwh) {
  const auto months = regret_by_month(losses, capacity_mwh);
  double most = 0;
  for (const auto& [month, hours] : months)
    most = std::max(most, std::ranges::max(hours, {}, &HeatValue::value).value);
  std::string text = fmt::format(
      "<figure id=\"lost-hours\"><figcaption>By hour and month<small>gap by decisions of each "
      "local hour, mean over the month's test days, EUR per day per MWh of capacity; darkest: "
      "{:.1f}; {} {}</small></figcaption>\n<table class=\"heat\"><thead><tr><th "
      "scope=\"col\">Month</th>",
      most, kShadeMeaning, csv_link("lost_hours.csv"));
  for (std::size_t h = 0; h < kHoursPerDay; ++h) {
    text += fmt::format("<th scope=\"col\">{:02}</th>", h);
  }
  text += "</tr></thead>\n<tbody>\n";
  for (const auto& [month, hours] : months) {
    text += fmt::format("<tr><th scope=\"row\">{}</th>", month);
    HeatValue shade{0, 0};
    for (std::size_t h = 0; h < kHoursPerDay; ++h) {
      const HeatValue& hour = hours[h];
      shade = shade_of(hour, shade);
      text += fmt::format(
          "<td style=\"--heat:{:.3f}\" title=\"{}, {:02}:00: {:.1f} \u00b1 {}\"><span>{:.0f}</span>"
          "</td>",
          most > 0 ? shade.value / most : 0, month, h, hour.value,
          error_text(hour.error, 1, kNoValue), hour.value);
    }
    text += "</tr>\n";
  }
  return text + "</tbody></table></figure>\n";
}

std::string clock_text(const MarketStep& step) {
  const int minute = local_minute_of(step.utc_s).minute_of_day;
  return fmt::format("{:02}:{:02}", minute / 60, minute % 60);
}

/// "missed high price 312.4, the correction −20.1"
std::string parts_text(const DayLoss& day, double capacity_mwh) {
  std::string text;
  for (const LossCause cause : causes_of(day.part_eur)) {
    if (std::abs(day.of(cause)) < kNamedShare * day.missed_eur()) continue;
    text += fmt::format("{}{} <b>{}</b>", text.empty() ? "" : ", ", text_of(cause).name,
                        number(day.of(cause) / capacity_mwh));
  }
  return text;
}

/// Most expensive decision of the main cause, as text.
std::string moment_html(const DayLoss& day, double capacity_mwh) {
  const GapMoment& m = day.moment[static_cast<std::size_t>(day.main_cause())];
  if (m.eur <= 0) return {};
  return fmt::format(
      "<a href=\"#day\" data-day=\"{}\" data-minute=\"{}\">{}</a> at {:.0f} %: {}, optimum {}; "
      "paid {}, newest price {} EUR/MWh; loss {} EUR per MWh of capacity",
      day.date, m.step.utc_s / 60, clock_text(m.step), 100 * m.soc_frac, action_name(m.done),
      action_name(m.best), number(m.step.paid_eur_per_mwh), number(m.step.observed_eur_per_mwh),
      number(m.eur / capacity_mwh));
}

/// Days by profit gap, largest first.
std::vector<const DayLoss*> by_missed(const std::vector<DayLoss>& losses) {
  std::vector<const DayLoss*> order;
  for (const DayLoss& day : losses) order.push_back(&day);
  std::ranges::stable_sort(order, std::ranges::greater{}, &DayLoss::missed_eur);
  return order;
}

std::string days_html(const std::vector<DayLoss>& losses, double capacity_mwh) {
  std::string text =
      "<figure id=\"lost-days\"><figcaption>Worst days<small>largest gap to perfect "
      "foresight, EUR per MWh of capacity; click a date or time to open it below; causes below a "
      "tenth are in the file " +
      csv_link("lost_days.csv") +
      "</small></figcaption>\n<table id=\"worst-days\"><thead><tr><th scope=\"col\">Day</th><th "
      "scope=\"col\">Gap, EUR/MWh of capacity</th><th scope=\"col\">Earned, EUR/MWh of capacity"
      "</th><th scope=\"col\">Foresight, EUR/MWh of capacity</th><th "
      "scope=\"col\" class=\"why\">Causes</th><th scope=\"col\" class=\"why\">Most expensive "
      "decision of the first cause</th></tr></thead>\n<tbody>\n";
  const std::vector<const DayLoss*> worst = by_missed(losses);
  for (std::size_t d = 0; d < std::min(kWorstDays, worst.size()); ++d) {
    const DayLoss& day = *worst[d];
    text += fmt::format(
        "<tr><th scope=\"row\"><a href=\"#day\" data-day=\"{0}\">{0}</a></th><td "
        "data-label=\"Gap, EUR/MWh of capacity\">{1}</td><td data-label=\"Earned, EUR/MWh of "
        "capacity\">{2}</td><td data-label=\"Foresight, EUR/MWh of capacity\">{3}</td><td "
        "class=\"why\">{4}</td><td class=\"why\">{5}</td></tr>\n",
        day.date, number(day.missed_eur() / capacity_mwh), number(day.earned_eur / capacity_mwh),
        number(day.foresight_eur / capacity_mwh), parts_text(day, capacity_mwh),
        moment_html(day, capacity_mwh));
  }
  return text + "</tbody></table></figure>\n";
}

PictureFile cause_file(const std::vector<DayLoss>& losses, double capacity_mwh) {
  const Means means(losses, capacity_mwh);
  std::string csv = "cause,missed_eur_per_day_per_mwh\n";
  for (const LossCause cause : causes_of(means.part)) {
    csv += fmt::format("{},{}\n", text_of(cause).key,
                       exact(means.part[static_cast<std::size_t>(cause)]));
  }
  return {"lost_causes.csv", csv + fmt::format("all,{}\n", exact(means.missed))};
}

PictureFile hour_file(const std::vector<DayLoss>& losses, double capacity_mwh) {
  std::string csv = "month,local_hour,missed_eur_per_day_per_mwh\n";
  for (const auto& [month, hours] : regret_by_month(losses, capacity_mwh)) {
    for (std::size_t h = 0; h < kHoursPerDay; ++h) {
      csv += fmt::format("{},{},{}\n", month, h, exact(hours[h].value));
    }
  }
  return {"lost_hours.csv", std::move(csv)};
}

PictureFile day_file(const std::vector<DayLoss>& losses, double capacity_mwh) {
  std::string csv = "date,missed_eur_per_mwh,earned_eur_per_mwh,foresight_eur_per_mwh,";
  for (const LossCauseText& cause : kTexts) csv += fmt::format("{}_eur_per_mwh,", cause.key);
  csv +=
      "main_cause,moment_utc,moment_soc,moment_action,moment_best_action,moment_paid_eur_per_mwh,"
      "moment_observed_eur_per_mwh,moment_missed_eur_per_mwh\n";
  for (const DayLoss* day : by_missed(losses)) {
    csv += fmt::format("{},{},{},{},", day->date, exact(day->missed_eur() / capacity_mwh),
                       exact(day->earned_eur / capacity_mwh),
                       exact(day->foresight_eur / capacity_mwh));
    for (const double part : day->part_eur) csv += exact(part / capacity_mwh) + ",";
    const GapMoment& m = day->moment[static_cast<std::size_t>(day->main_cause())];
    csv += fmt::format("{},{},{:.4f},{},{},{:.4f},{:.4f},{}\n", text_of(day->main_cause()).key,
                       utc_text(m.step.utc_s).view(), m.soc_frac, action_name(m.done),
                       action_name(m.best), m.step.paid_eur_per_mwh, m.step.observed_eur_per_mwh,
                       exact(m.eur / capacity_mwh));
  }
  return {"lost_days.csv", std::move(csv)};
}

}  // namespace

const LossCauseText& text_of(LossCause cause) { return kTexts[static_cast<std::size_t>(cause)]; }

LossCause DayLoss::main_cause() const {
  return static_cast<LossCause>(std::ranges::max_element(part_eur) - part_eur.begin());
}

std::vector<DayLoss> foresight_gap(const MarketSteps& market, const std::vector<MarketDay>& days,
                                   const LossChain& chain, const BatteryParameters& battery,
                                   double initial_soc_frac) {
  const EvaluationOptions options{battery, initial_soc_frac, false};
  const auto youngest = std::ranges::min_element(market.steps, {}, &MarketStep::observed_age_min);
  const int usual_age_min = youngest == market.steps.end() ? 0 : youngest->observed_age_min;
  std::vector<DayLoss> losses;
  for (const MarketDay& day : days) {
    ForesightPolicy bound(battery);
    std::vector<StepRecord> records;
    DayLoss loss{.date = day.date()};
    loss.foresight_eur = evaluate(market, {day}, bound, options).days.front().profit_eur;
    loss.earned_eur =
        evaluate(market, {day}, chain.policy, options, &records).days.front().profit_eur;
    DayJudge{chain, battery, bound, usual_age_min}.judge(market.of(day), records, loss);
    losses.push_back(std::move(loss));
  }
  return losses;
}

std::vector<DayLoss> losses_of(const RunResults& in) {
  const std::unique_ptr<Policy> exported = exported_policy(in.corrected);
  const auto plain = std::make_shared<StudentPolicy>(in.plain->net, in.plain->outlook);
  LossChain chain{.policy = *exported, .plain = plain.get()};
  std::optional<RuledPolicy> under_rules;
  const RuleSet rules = projected_rules(in.corrected.certificate.rules);
  if (!rules.empty()) chain.under_rules = &under_rules.emplace(plain, rules, in.plain->net.context);
  return foresight_gap(in.market, in.market.days_of(Split::kTest), chain, in.battery,
                       in.initial_soc_frac);
}

std::string foresight_gap_html(const std::vector<DayLoss>& losses, double capacity_mwh) {
  const Means means(losses, capacity_mwh);
  return fmt::format(
             "<p>Perfect foresight would have earned {} EUR per day per MWh of capacity more.</p>\n"
             "<div class=\"grid\">\n",
             number(means.missed)) +
         causes_html(means) + heat_html(losses, capacity_mwh) + "</div>\n" +
         days_html(losses, capacity_mwh) +
         "<p class=\"note\">The loss of a decision assumes optimal later decisions: energy that an "
         "empty battery could not sell is charged to the decision that emptied it. At the same "
         "step and SoC, other policies are evaluated in turn: the plain student under the rules "
         "(difference: the correction), the plain student (rules), and the plain student with the "
         "paid price as input (newest price or outage). The rest is attributed to the price of "
         "that moment or to a later price at which the battery is empty or full, whichever is "
         "further from the day's median. A negative part is a gain. Each day starts at the same "
         "SoC; wear as configured. The part of the correction is by decision; the cost of the "
         "correction above compares two whole runs.</p>\n";
}

std::vector<PictureFile> foresight_gap_files(const std::vector<DayLoss>& losses,
                                             double capacity_mwh) {
  return {cause_file(losses, capacity_mwh), hour_file(losses, capacity_mwh),
          day_file(losses, capacity_mwh)};
}

}  // namespace bess
