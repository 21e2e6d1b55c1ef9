#include "workstation/report/report.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <optional>

#include "shared/host/file.h"
#include "shared/host/user_error.h"
#include "workstation/report/html.h"
#include "workstation/student/student_policy.h"

namespace bess {
namespace {

namespace fs = std::filesystem;

constexpr const char* kPageTitle = "Battery arbitrage: what was learned, corrected and proved";

/// What the students were checked against.
PriceThresholds thresholds_of(const ReportInputs& in) {
  if (in.corrected) return in.corrected->certificate.thresholds;
  return in.uncorrected ? in.uncorrected->certificate.thresholds : PriceThresholds{};
}

double rule_validation_profit(const ReportInputs& in) {
  RuleBasedPolicy rule(kPaperRuleLowEurPerMwh, kPaperRuleHighEurPerMwh);
  return evaluate(in.market, in.market.days_of(Split::kValidation), rule, {.battery = in.battery})
      .profit_eur_per_day_per_mwh();
}

std::vector<NamedPolicyMap> policy_maps(const ReportInputs& in, const PolicyContext& context) {
  std::vector<NamedPolicyMap> maps;
  if (in.teacher) maps.push_back({"teacher", teacher_grid(*in.teacher, context)});
  if (in.uncorrected) {
    maps.push_back({"uncorrected student", student_grid(in.uncorrected->net, context)});
  }
  if (in.corrected) maps.push_back({"corrected student", student_grid(in.corrected->net, context)});
  return maps;
}

/// Where the uncorrected student's counterexamples are most frequent; none without any.
std::optional<PolicyContext> worst_context(const ReportInputs& in) {
  if (in.uncorrected == nullptr) return std::nullopt;
  std::map<PolicyContext, int> count;
  for (const LatticeState& s : in.uncorrected->certificate.counterexamples) {
    ++count[{.context_class = s.context_class,
             .quarter_hour = s.quarter_hour,
             .minute_of_quarter_hour = s.minute_of_quarter_hour}];
  }
  const auto worst = std::ranges::max_element(count, {}, [](const auto& c) { return c.second; });
  return worst == count.end() ? std::nullopt : std::optional(worst->first);
}

ContextClasses classes_of(const ReportInputs& in) {
  if (in.teacher) return in.teacher->context;
  if (in.corrected) return in.corrected->net.context;
  return in.uncorrected ? in.uncorrected->net.context : ContextClasses{};
}

std::string context_note(const MarketSteps& market, const ContextClasses& classes,
                         int context_class) {
  for (const MarketDay& day : market.days_of(Split::kTrain)) {
    for (const MarketStep& step : market.of(day)) {
      if (classes.class_of(step.month, step.level_centi_eur_per_mwh) == context_class) return "";
    }
  }
  return "No training day saw this context: it is extrapolated. ";
}

void add_policy_map(const ReportInputs& in, const PolicyContext& context, const std::string& note,
                    std::vector<Figure>& figures) {
  const std::vector<NamedPolicyMap> maps = policy_maps(in, context);
  if (maps.empty()) return;
  const ContextClasses classes = classes_of(in);
  figures.push_back(
      policy_map_figure(context, classes, maps, in.battery,
                        note + context_note(in.market, classes, context.context_class)));
}

void add_policy_maps(const ReportInputs& in, std::vector<Figure>& figures) {
  for (const PolicyContext& context : in.maps) add_policy_map(in, context, "", figures);
  const std::optional<PolicyContext> worst = worst_context(in);
  if (!worst || std::ranges::find(in.maps, *worst) != in.maps.end()) return;
  add_policy_map(in, *worst, "The time at which the uncorrected student erred most. ", figures);
}

struct ShownPolicy {
  std::string name;
  std::unique_ptr<Policy> policy;
};

/// The last link of the chain that there is.
ShownPolicy shown_policy(const ReportInputs& in) {
  if (in.corrected) {
    return {"corrected student", std::make_unique<StudentPolicy>(in.corrected->net)};
  }
  if (in.uncorrected) {
    return {"uncorrected student", std::make_unique<StudentPolicy>(in.uncorrected->net)};
  }
  if (in.teacher) return {"teacher", std::make_unique<TeacherPolicy>(*in.teacher)};
  return {"rule-based controller",
          std::make_unique<RuleBasedPolicy>(kPaperRuleLowEurPerMwh, kPaperRuleHighEurPerMwh)};
}

Figure widest_day_figure(const ReportInputs& in, const MarketDay& day) {
  const ShownPolicy shown = shown_policy(in);
  std::vector<StepRecord> records;
  evaluate(in.market, {day}, *shown.policy, {.battery = in.battery}, &records);
  return day_figure({day.date(), shown.name, in.market.of(day), records, in.battery});
}

std::vector<Figure> figures_of(const ReportInputs& in) {
  std::vector<Figure> figures;
  if (const MarketDay* day = widest_test_day(in.market)) {
    figures.push_back(widest_day_figure(in, *day));
  }
  add_policy_maps(in, figures);
  if (in.training_curve.size() > 1) {  // a program is fitted, not trained
    figures.push_back(learning_figure(in.training_curve, rule_validation_profit(in)));
  }
  if (!in.distil_curve.empty()) figures.push_back(distillation_figure(in.distil_curve));
  figures.push_back(price_density_figure(in.market, thresholds_of(in)));
  return figures;
}

/// The policy with the highest mean, the foresight bound aside; null when there is none to name.
const ComparisonRow* best_of(const std::vector<ComparisonRow>& rows) {
  const ComparisonRow* best = nullptr;
  for (const ComparisonRow& row : rows) {
    if (row.name != kForesightName && (best == nullptr || row.profit > best->profit)) best = &row;
  }
  return best;
}

/// Claims a difference only beyond two standard errors.
std::string difference_text(const PairedDifference& difference, const std::string& first) {
  if (std::isnan(difference.standard_error)) {
    return fmt::format("that is {:+.1f} against {}, on one day: no difference is shown",
                       difference.mean, first);
  }
  if (std::abs(difference.mean) < 2 * difference.standard_error) {
    return fmt::format(
        "that is {:+.1f} against {}, within two standard errors ({:.1f} each): no "
        "difference is shown",
        difference.mean, first, difference.standard_error);
  }
  return fmt::format("that is {:.1f} {} than {} (standard error of the daily differences {:.1f})",
                     std::abs(difference.mean), difference.mean > 0 ? "more" : "less", first,
                     difference.standard_error);
}

std::string lead(const std::vector<ComparisonRow>& rows) {
  const ComparisonRow* best = best_of(rows);
  if (best == nullptr) return {};
  std::string text = fmt::format(
      "Over {} test days \u201c{}\u201d has the highest mean profit: {:.1f} EUR per day per MWh of "
      "battery capacity",
      best->days, best->name, best->profit);
  if (best->difference) text += "; " + difference_text(*best->difference, rows.front().name);
  if (best->foresight_share) {
    text += fmt::format(". Perfect foresight would have earned {:.1f}",
                        best->profit / *best->foresight_share);
  }
  return text + ".";
}

/// 6,950,033,280
std::string grouped(std::int64_t count) {
  const std::string digits = fmt::format("{}", count);
  std::string text;
  for (std::size_t i = 0; i < digits.size(); ++i) {
    if (i > 0 && (digits.size() - i) % 3 == 0) text += ',';
    text += digits[i];
  }
  return text;
}

std::string proof_sentence(const Certificate& c) {
  if (c.violations() != 0) {
    return fmt::format(
        "The corrected student still breaks its constraints {} times; it may not be "
        "exported.",
        grouped(c.violations()));
  }
  return fmt::format("The corrected student was checked on {} lattice states: not one violation.",
                     grouped(c.states_checked));
}

std::string dash_or(bool present, const std::string& text) { return present ? text : "\u2013"; }

std::string error_text(double standard_error) {
  return dash_or(!std::isnan(standard_error), fmt::format("{:.1f}", standard_error));
}

std::vector<std::string> comparison_cells(const ComparisonRow& row) {
  const PairedDifference d = row.difference.value_or(PairedDifference{0, 0});
  return {row.name,
          fmt::format("{:.1f}", row.profit),
          error_text(row.standard_error),
          dash_or(row.difference.has_value(), fmt::format("{:+.1f}", d.mean)),
          dash_or(row.difference.has_value(), error_text(d.standard_error)),
          fmt::format("{:.1f}", row.worst_day),
          fmt::format("{:.2f}", row.cycles_per_day),
          fmt::format("{:.1f}", row.switches_per_day),
          dash_or(row.foresight_share.has_value(),
                  fmt::format("{:.1f}", 100 * row.foresight_share.value_or(0))),
          fmt::format("{:.1f}", row.profit_at_reference_wear)};
}

std::string comparison_table(const std::string& caption, const std::vector<ComparisonRow>& rows) {
  if (rows.empty()) return {};
  HtmlTable table{
      fmt::format("{}, {} days", caption, rows.front().days),
      {"Policy", "EUR/day/MWh", "s.e.", "Gain", "s.e.", "Worst day", "Cycles/day", "Switches/day",
       "% of foresight", fmt::format("At wear {:g}", kReferenceWearEurPerMwh)},
      {}};
  for (const ComparisonRow& row : rows) table.rows.push_back(comparison_cells(row));
  return format_table(table);
}

std::vector<std::string> proof_cells(const std::string& name, const Certificate& c) {
  return {name, grouped(c.states_checked), grouped(c.violations_property_1),
          grouped(c.violations_property_2), grouped(c.violations_property_3)};
}

std::string proof_section(const ReportInputs& in) {
  HtmlTable table{"Violations before and after the correction",
                  {"Student", "States checked", "Not charging when cheap",
                   "Not discharging when dear", "Pairs out of order"},
                  {}};
  if (in.uncorrected) {
    table.rows.push_back(proof_cells("uncorrected", in.uncorrected->certificate));
  }
  if (in.corrected) table.rows.push_back(proof_cells("corrected", in.corrected->certificate));
  if (table.rows.empty()) return {};
  const PriceThresholds thresholds = thresholds_of(in);
  return fmt::format(
      "<section class=\"block\"><h2>The proof</h2>\n{}<p class=\"note\">Checked over the lattice "
      "of "
      "minute, quarter-hour, context class, charge and price that the edge can meet: charge at {} "
      "EUR/MWh "
      "and below{}, discharge at {} and above{}, and never a larger action at a higher price or a "
      "fuller battery.</p></section>\n",
      format_table(table), thresholds.low_eur_per_mwh,
      guard_alone_note(thresholds.low_binds_student()), thresholds.high_eur_per_mwh,
      guard_alone_note(thresholds.high_binds_student()));
}

std::string comparison_section(const ReportInputs& in) {
  const auto reset = comparison_rows(in.evaluations, &NamedEvaluation::day_reset);
  const auto carried = comparison_rows(in.evaluations, &NamedEvaluation::carried_over);
  if (reset.empty() && carried.empty()) return {};
  return fmt::format(
      "<section class=\"block\"><h2>What each policy earned</h2>\n{}{}<p class=\"note\">Money in "
      "EUR "
      "per day per MWh of capacity. Gain: mean day-by-day difference to {}; s.e.: standard error "
      "of "
      "the mean to its left. A gain under two standard errors shows nothing. Cycles: energy "
      "through "
      "the battery over twice its capacity; switches: changes of the order. At wear {:g}: "
      "{}.</p></section>\n",
      comparison_table("Each day starts at the same charge", reset),
      comparison_table("Charge carried over from day to day", carried),
      html_escaped(in.evaluations.front().name), kReferenceWearEurPerMwh,
      html_escaped(reference_wear_meaning(configured_wear_eur_per_mwh(in.evaluations))));
}

std::string figure_section(const Figure& figure, const fs::path& folder) {
  const std::string svg = read_file(folder / (figure.name + ".svg"));
  return fmt::format(
      "<figure>\n<h2>{}</h2>\n<div class=\"wide\">{}</div>\n<figcaption>{}</figcaption>\n"
      "</figure>\n",
      html_escaped(figure.title), inline_svg(svg, figure), html_escaped(figure.caption));
}

std::string head_section(const ReportInputs& in) {
  const auto rows = comparison_rows(in.evaluations, &NamedEvaluation::day_reset);
  std::string text = fmt::format("<h1>{}</h1>\n", kPageTitle);
  if (!rows.empty()) text += fmt::format("<p class=\"lead\">{}</p>\n", html_escaped(lead(rows)));
  if (in.corrected) {
    text += fmt::format("<p class=\"lead\">{}</p>\n", proof_sentence(in.corrected->certificate));
  }
  return text;
}

std::string provenance_section(const ReportInputs& in) {
  const std::string battery =
      fmt::format("battery {:g} MW, {:g} MWh, round trip {:.1f} %, charge {:.0f} to {:.0f} %",
                  in.battery.power_w_max / 1e6, in.battery.capacity_wh / 1e6,
                  100 * in.battery.charge_efficiency * in.battery.discharge_efficiency,
                  100 * in.battery.soc_min_frac, 100 * in.battery.soc_max_frac);
  return fmt::format("<section><h2>Where this comes from</h2>\n<pre>{}\n{}</pre></section>\n",
                     battery, html_escaped(in.provenance));
}

}  // namespace

void write_report(const ReportInputs& inputs, const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) fail("{}: cannot create: {}", folder.string(), error.message());
  std::string body = head_section(inputs) + comparison_section(inputs) + proof_section(inputs);
  for (const Figure& figure : figures_of(inputs)) {
    draw_figure(figure, folder);
    body += figure_section(figure, folder);
  }
  body += provenance_section(inputs);
  write_file(folder / "report.html", format_page(kPageTitle, body));
}

}  // namespace bess
