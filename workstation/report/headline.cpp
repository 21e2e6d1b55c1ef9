#include "workstation/report/headline.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "workstation/base/answer.h"
#include "workstation/report/figures/html.h"

namespace bess {
namespace {

constexpr std::string_view kUnder = "plain student under ";
constexpr const char* kHeadlineKeys =
    "days,months,profit_eur_per_day_per_mwh,profit_standard_error,profit_standard_error_by_month,"
    "charge_price_eur_per_mwh,charge_value_eur_per_day_per_mwh";

/// One rule, all rules, the correction, or both.
struct Part {
  const char* kind;
  const HeadlineGain* gain;
  [[nodiscard]] bool is_rule() const { return kind == std::string_view("rule"); }
};

/// " ± 1.1" and " (1.4 by month)", if known.
std::string plain_error(const DayErrors& errors) {
  return std::isnan(errors.plain) ? "" : fmt::format(" \u00b1 {:.1f}", errors.plain);
}
std::string month_error(const DayErrors& errors) {
  return std::isnan(errors.by_month) ? "" : fmt::format(" ({:.1f} by month)", errors.by_month);
}
std::string errors_text(const DayErrors& errors) {
  return plain_error(errors) + month_error(errors);
}

/// "+5.2", with a true minus.
std::string signed_text(double value) {
  return fmt::format("{}{:.1f}", value < 0 ? "\u2212" : "+", std::abs(value));
}

/// Half width of the confidence interval; 0 if unknown.
double half_width(const PairedDifference& difference) {
  const double half = interval_half_width(difference.errors, kShownCoverage);
  return std::isnan(half) ? 0 : half;
}

/// Half width of the bars' axis, EUR per day per MWh, without foresight.
double bar_reach(const Headline& headline) {
  double reach = 1;
  for (const HeadlineGain& gain : headline.gains) {
    if (gain.against == kForesightName) continue;
    for (const PairedDifference& d : gain.difference) {
      reach = std::max(reach, std::abs(d.mean) + half_width(d));
    }
  }
  return reach;
}

/// Mean and interval on an axis centred at zero, drawn by the style sheet.
std::string bar(const PairedDifference& difference, double reach) {
  const auto percent = [&](double value) { return 50 + 50 * std::clamp(value / reach, -1.0, 1.0); };
  const double half = half_width(difference);
  const char* kind = !is_shown(difference) ? "open" : difference.mean > 0 ? "better" : "worse";
  return fmt::format(
      "<span class=\"bar {}\" aria-hidden=\"true\" style=\"--from:{:.1f}%;--to:{:.1f}%;--mean:"
      "{:.1f}%\"></span>",
      kind, percent(difference.mean - half), percent(difference.mean + half),
      percent(difference.mean));
}

/// Head of a column of kHeadlineWears.
std::string wear_head(std::size_t w) {
  return w == 0 ? "No wear" : fmt::format("Wear {:g}", kHeadlineWears[w]);
}

std::string gain_row(const HeadlineGain& gain, double reach) {
  const bool bound = gain.against == kForesightName;
  std::string row = fmt::format("<tr{}><th scope=\"row\">{}<small>{}</small></th>",
                                bound ? " class=\"bound\"" : "", html_escaped(gain.against),
                                html_escaped(gain.meaning));
  for (std::size_t w = 0; w < kHeadlineWears.size(); ++w) {
    const PairedDifference& d = gain.difference[w];
    row += fmt::format(
        "<td data-label=\"{}, EUR/day/MWh\"><span "
        "class=\"number\">{}{}</span><small>{}</small>{}</td>",
        wear_head(w), signed_text(d.mean), plain_error(d.errors), month_error(d.errors),
        bound ? "" : bar(d, reach));
  }
  return row + "</tr>\n";
}

/// Gain as text, negative when it costs; claimed only outside its interval.
std::string effect_text(const HeadlineGain& gain, std::string_view against) {
  const PairedDifference& d = gain.difference.front();
  return fmt::format("{}{} EUR per day per MWh of capacity against the {}",
                     is_shown(d) ? "" : "not significant, ", difference_text(d), against);
}

/// Accounting of the result, as text, with the day-reset figure.
std::string headline_accounting(const Headline& headline) {
  std::string text = "The SoC is carried over from day to day";
  if (!std::isnan(headline.charge_left.price_eur_per_mwh)) {
    text += fmt::format(
        "; the final charge is valued at {:.1f} EUR/MWh, the mean settled price of these "
        "days, with losses and costs: {} of the result, EUR per day per MWh of capacity",
        headline.charge_left.price_eur_per_mwh,
        signed_text(headline.charge_left.value_eur_per_day_per_mwh));
  }
  text += ".";
  if (!headline.reset_profit) return text;
  return text + fmt::format(
                    " Day-reset accounting (each day starts at the same SoC, its end is not "
                    "valued): {:.1f} EUR per day per MWh of capacity.",
                    *headline.reset_profit);
}

}  // namespace

Evaluation at_wear(const Evaluation& evaluation, double wear_eur_per_mwh) {
  Evaluation worn = evaluation;
  worn.wear_eur_per_mwh = wear_eur_per_mwh;
  for (DayResult& day : worn.days) {
    day.profit_eur -= (wear_eur_per_mwh - evaluation.wear_eur_per_mwh) * day.throughput_mwh;
  }
  return worn;
}

HeadlineGain gain_over(const NamedEvaluation& exported, const NamedEvaluation& other,
                       std::string_view meaning) {
  HeadlineGain gain{other.name, std::string(meaning), {}};
  for (std::size_t w = 0; w < kHeadlineWears.size(); ++w) {
    gain.difference[w] = paired_difference(at_wear(exported.carried_over, kHeadlineWears[w]),
                                           at_wear(other.carried_over, kHeadlineWears[w]));
  }
  return gain;
}

std::string difference_text(const PairedDifference& difference) {
  return signed_text(difference.mean) + errors_text(difference.errors);
}

bool is_shown(const PairedDifference& difference) {
  return std::abs(difference.mean) >
         interval_half_width(difference.errors, kShownCoverage);  // false for NaN
}

const NamedEvaluation* find_own_student(const std::vector<NamedEvaluation>& evaluations) {
  const NamedEvaluation* corrected = carried_over_by(evaluations, kCorrectedName);
  return corrected != nullptr ? corrected : carried_over_by(evaluations, kUnprovedName);
}

std::optional<Headline> headline_of(const std::vector<NamedEvaluation>& evaluations) {
  const NamedEvaluation* exported = find_own_student(evaluations);
  if (exported == nullptr) return std::nullopt;
  const Evaluation& days = exported->carried_over;
  const Evaluation& reset = exported->day_reset;
  const NamedEvaluation* bound = carried_over_by(evaluations, kForesightName);
  Headline headline{comparison_row(exported->name, days, nullptr,
                                   bound == nullptr ? nullptr : &bound->carried_over)};
  if (!reset.days.empty()) headline.reset_profit = reset.profit_eur_per_day_per_mwh();
  const auto add = [&](const std::string& name, const std::string& meaning) {
    const NamedEvaluation* other = carried_over_by(evaluations, name);  // null if not evaluated
    if (other != nullptr) headline.gains.push_back(gain_over(*exported, *other, meaning));
  };
  add(kPlainName, "the student without correction");
  for (const std::string& rival : rival_names()) add(rival, find_baseline(rival)->meaning);
  const bool is_finished = headline.name == kCorrectedName;
  if (const auto prices = rule_prices_of(evaluations)) {
    if (is_finished) headline.correction = prices->correction;
    headline.rules = prices->together;
  } else if (is_finished && carried_over_by(evaluations, kPlainName) != nullptr) {
    headline.correction = headline.gains.front();
  }
  return headline;
}

std::string headline_text(const Headline& headline) {
  return fmt::format(
      "The {} earned {:.1f} EUR per day per MWh of capacity{} on {} test days.\n{}\n",
      headline.name, headline.profit, errors_text(headline.errors), headline.days,
      headline_accounting(headline));
}

std::string gains_text(const Headline& headline) {
  std::string text =
      "Gain over each policy without wear cost, EUR per day per MWh of capacity; significant if "
      "the 95 % interval "
      "excludes 0:\n";
  for (const HeadlineGain& gain : headline.gains) {
    if (gain.against == kForesightName) continue;
    const PairedDifference& d = gain.difference.front();
    text += fmt::format("  {:<22} {}, {}\n", gain.against, difference_text(d),
                        is_shown(d) ? "significant" : "not significant");
  }
  return text;
}

Json headline_json(const Headline& headline) {
  Json json = Json::object({{"policy", headline.name}, {key::kCarrySoc, true}});
  figures_table({headline}).only(kHeadlineKeys).add_row(0, json);
  json.set("profit_from_same_soc_eur_per_day_per_mwh",
           Decimals{headline.reset_profit.value_or(std::nan("")), 4});
  return json;
}

std::string headline_html(const Headline& headline) {
  std::string text = fmt::format(
      "<p class=\"figure\"><strong id=\"headline-profit\">{:.1f}</strong><span>EUR per day per MWh "
      "of capacity{}<br>{}, {} test days, SoC carried over</span></p>\n"
      "<p class=\"note\" id=\"headline-accounting\">{}</p>\n<ul class=\"badges\">\n",
      headline.profit, errors_text(headline.errors), headline.name, headline.days,
      html_escaped(headline_accounting(headline)));
  if (headline.correction) {
    text +=
        fmt::format("<li id=\"effect-of-correction\">Effect of the correction: {}</li>\n",
                    html_escaped(effect_text(*headline.correction, headline.correction->against)));
  }
  if (headline.rules) {
    text += fmt::format("<li id=\"effect-of-rules\">Effect of the rules: {}</li>\n",
                        html_escaped(effect_text(*headline.rules, kPlainName)));
  }
  if (headline.foresight_share) {
    text += fmt::format("<li>{:.1f} % of the profit of perfect foresight</li>\n",
                        100 * *headline.foresight_share);
  }
  text += "</ul>\n";
  if (headline.gains.empty()) return text;
  text += fmt::format(
      "<table class=\"gains\">\n<caption>Gain over each alternative: mean day-by-day difference, "
      "EUR/day/MWh (EUR per day per MWh of capacity) \u00b1 standard error (by month)</caption>\n"
      "<thead><tr><th scope=\"col\">Against</th><th scope=\"col\">{}, EUR/day/MWh</th><th "
      "scope=\"col\">{}, EUR/day/MWh</th></tr></thead>\n<tbody>\n",
      wear_head(0), wear_head(1));
  const double reach = bar_reach(headline);
  for (const HeadlineGain& gain : headline.gains) text += gain_row(gain, reach);
  return text + fmt::format(
                    "</tbody></table>\n<p class=\"note\">Wear: EUR per MWh charged and per MWh "
                    "discharged. A bar spans the 95 % interval of the larger error (Student's t); "
                    "one that touches the line is not significant. By month: {}. SoC carried "
                    "over.</p>\n",
                    html_escaped(by_month_meaning(headline.errors.months)));
}

const NamedEvaluation* carried_over_by(const std::vector<NamedEvaluation>& evaluations,
                                       std::string_view name) {
  const NamedEvaluation* found = find_evaluation(evaluations, name);
  return found == nullptr || found->carried_over.days.empty() ? nullptr : found;
}

std::string under_rule_name(const std::string& rule) {
  return fmt::format("{}\"{}\"", kUnder, rule);
}

bool is_under_rules(std::string_view policy) { return policy.starts_with(kUnder); }

std::optional<RulePrices> rule_prices_of(const std::vector<NamedEvaluation>& evaluations) {
  const NamedEvaluation* plain = carried_over_by(evaluations, kPlainName);
  const NamedEvaluation* under_all = carried_over_by(evaluations, kUnderAllRules);
  const NamedEvaluation* exported = find_own_student(evaluations);
  if (plain == nullptr || under_all == nullptr || exported == nullptr) return std::nullopt;
  const bool is_finished = exported->name == kCorrectedName;
  RulePrices prices{
      .student = exported->name,
      .together = gain_over(*under_all, *plain, "all rules together"),
      .correction = gain_over(*exported, *under_all,
                              is_finished ? "the correction" : "the unfinished correction"),
      .total = gain_over(*exported, *plain, "both")};
  for (const NamedEvaluation& named : evaluations) {
    if (!is_under_rules(named.name) || named.name == kUnderAllRules) continue;
    const std::string quoted = named.name.substr(kUnder.size());
    prices.rules.push_back(gain_over(named, *plain, quoted.substr(1, quoted.size() - 2)));
  }
  return prices;
}

Table rule_prices_table(const RulePrices& prices) {
  using P = Part;
  std::vector<P> parts;
  for (const HeadlineGain& rule : prices.rules) parts.push_back({"rule", &rule});
  parts.push_back({"all rules", &prices.together});
  parts.push_back({"correction", &prices.correction});
  parts.push_back({"both", &prices.total});
  Table table{{Column<P>{{"part"}, &P::kind},
               {{"rule"}, [](const P& p) { return p.is_rule() ? p.gain->meaning : ""; }},
               {{"", "change against the plain student", "", 0, "Change against the plain student"},
                [](const P& p) { return p.gain->meaning + (p.is_rule() ? ", alone" : ""); }}},
              parts};
  for (std::size_t w = 0; w < kHeadlineWears.size(); ++w) {
    const std::string key = fmt::format("at_wear_{:g}", kHeadlineWears[w]);
    const std::string wear = fmt::format("wear {:g}", kHeadlineWears[w]);
    table.add<P>({{key + "_eur_per_day_per_mwh", wear, "{:+.1f}", 4},
                  [w](const P& p) { return p.gain->difference[w].mean; }},
                 parts);
    table.add<P>({{key + "_standard_error", "s.e.", "{:.1f}", 4},
                  [w](const P& p) { return p.gain->difference[w].errors.plain; }},
                 parts);
    table.add<P>({{key + "_standard_error_by_month", "by month", "{:.1f}", 4},
                  [w](const P& p) { return p.gain->difference[w].errors.by_month; }},
                 parts);
    table.add<P>({{"", "", "", 0, "W" + wear.substr(1) + ", EUR/day/MWh"},
                  [w](const P& p) { return difference_text(p.gain->difference[w]); }},
                 parts);
  }
  return table;
}

std::string rule_prices_text(const RulePrices& prices) {
  return fmt::format(
      "Effect of the rules, EUR per day per MWh of capacity: decisions of the plain student are "
      "moved to\nthe nearest allowed ones; the difference to the {} is {}\n{}",
      prices.student, prices.correction.meaning, rule_prices_table(prices).text());
}

}  // namespace bess
