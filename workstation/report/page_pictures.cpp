#include "workstation/report/page_pictures.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "shared/utc_text.h"
#include "workstation/env/day_risk.h"
#include "workstation/report/figures/curves.h"
#include "workstation/report/figures/policy_map.h"
#include "workstation/report/figures/price_histogram.h"
#include "workstation/report/headline.h"
#include "workstation/report/shown_policies.h"

namespace bess {
namespace {

constexpr int kBars = 14;  ///< at most, of the distribution of days: as tear_sheet.js has them
constexpr int kHours = 24;

/// The exported policy, or the first, and of the first `rivals` of the baselines beside it those
/// that were evaluated.
std::vector<const NamedEvaluation*> shown(const ReportInputs& in, std::size_t rivals) {
  std::vector<const NamedEvaluation*> found;
  const auto add = [&](std::string_view name) {
    const auto at = std::ranges::find(in.evaluations, name, &NamedEvaluation::name);
    if (at != in.evaluations.end() && !at->carried_over.days.empty()) found.push_back(&*at);
    return !found.empty();
  };
  if (!add(kCorrectedName) && !add(kUnprovedName) && !in.evaluations.empty())
    found.push_back(&in.evaluations.front());
  for (const std::string& rival : rival_names()) {
    if (rivals-- == 0) break;
    add(rival);
  }
  return found;
}

/// A row a label, a column a policy.
PictureTable by_policy(const char* name, const char* label, const std::vector<std::string>& labels,
                       const std::vector<const NamedEvaluation*>& policies,
                       const std::vector<std::vector<double>>& values) {
  PictureTable table{name, {label}, {}};
  for (const NamedEvaluation* policy : policies) table.columns.push_back(policy->name);
  for (std::size_t i = 0; i < labels.size(); ++i) {
    std::vector<std::string> row{labels[i]};
    for (const auto& column : values) row.push_back(exact(column[i]));
    table.rows.push_back(std::move(row));
  }
  return table;
}

std::vector<std::string> dates_of(const NamedEvaluation& policy) {
  std::vector<std::string> dates;
  for (const DayResult& day : policy.carried_over.days) dates.push_back(day.date);
  return dates;
}

PictureTable cumulative_table(const ReportInputs& in) {
  const auto policies = shown(in, rival_names().size());
  std::vector<std::vector<double>> sums;
  for (const auto* policy : policies)
    sums.push_back(cumulative(daily_profits(policy->carried_over)));
  const auto dates = policies.empty() ? std::vector<std::string>{} : dates_of(*policies.front());
  return by_policy("cumulative", "date", dates, policies, sums);
}

PictureTable drawdown_table(const ReportInputs& in) {
  const auto policies = shown(in, 1);
  std::vector<std::vector<double>> falls;
  for (const auto* policy : policies) {
    falls.push_back(below_peak(cumulative(daily_profits(policy->carried_over))));
  }
  const auto dates = policies.empty() ? std::vector<std::string>{} : dates_of(*policies.front());
  return by_policy("drawdown", "date", dates, policies, falls);
}

PictureTable month_table(const ReportInputs& in) {
  const auto policies = shown(in, 2);
  std::vector<std::string> months;
  std::vector<std::vector<double>> means;
  for (const auto* policy : policies) {
    std::map<std::string, std::pair<double, double>> sums;  // and days
    for (const DayResult& day : policy->carried_over.days) {
      auto& [sum, days] = sums[day.date.substr(0, kMonthTextLength)];
      sum += day.profit_eur / policy->carried_over.capacity_mwh;
      days += 1;
    }
    months.clear();
    means.emplace_back();
    for (const auto& [month, sum] : sums) {
      months.push_back(month);
      means.back().push_back(sum.first / sum.second);
    }
  }
  return by_policy("months", "month", months, policies, means);
}

/// 1, 2 or 5 times a power of ten: the least that cuts `range` into at most `count`.
double tic_distance(double range, int count) {
  const double rough = std::max(range, 1e-9) / count;
  const double power = std::pow(10, std::floor(std::log10(rough)));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (rough <= factor * power) return factor * power;
  }
  return 10 * power;
}

PictureTable distribution_table(const ReportInputs& in) {
  const auto policies = shown(in, 1);
  std::vector<std::vector<double>> profits;
  double low = 0;
  double high = 0;
  for (const auto* policy : policies) {
    profits.push_back(daily_profits(policy->carried_over));
    const auto [least, most] = std::ranges::minmax(profits.back());
    low = profits.size() == 1 ? least : std::min(low, least);
    high = profits.size() == 1 ? most : std::max(high, most);
  }
  if (profits.empty()) return by_policy("days", "from_eur_per_mwh", {}, policies, {});
  const double width = tic_distance(high - low, kBars);
  const double first = std::floor(low / width) * width;
  const auto count = static_cast<std::size_t>((high - first) / width) + 1;
  std::vector<std::string> labels;
  for (std::size_t b = 0; b < count; ++b) {
    labels.push_back(fmt::format("{:g}", first + static_cast<double>(b) * width));
  }
  std::vector<std::vector<double>> counts;
  for (const auto& of : profits) {
    counts.emplace_back(count, 0.0);
    for (const double profit : of) {
      counts.back()[static_cast<std::size_t>((profit - first) / width)] += 1;
    }
  }
  return by_policy("days", "from_eur_per_mwh", labels, policies, counts);
}

/// Local hour of a step.
int hour_of(const MarketStep& step) { return step.quarter_hour / 4; }

/// Calls `look` with each step of the days that the page holds and its index among all records.
template <typename Look>
void for_each_step(const ReportInputs& in, const PageSteps& steps, Look look) {
  std::size_t first = 0;
  for (std::size_t d = 0; d < steps.days.size(); ++d) {
    const auto of_day = in.market.of(steps.days[d]);
    if (std::ranges::binary_search(steps.kept, d)) {
      for (std::size_t s = 0; s < of_day.size(); ++s) look(of_day[s], first + s);
    }
    first += of_day.size();
  }
}

PictureTable hour_table(const ReportInputs& in, const PageSteps& steps) {
  std::vector<double> charging(kHours, 0.0);
  std::vector<double> discharging(kHours, 0.0);
  const double share = 1e6 / (in.battery.capacity_wh * static_cast<double>(steps.kept.size()));
  for_each_step(in, steps, [&](const MarketStep& step, std::size_t i) {
    const StepRecord& r = steps.policies.front().records[i];
    (r.power_w > 0 ? charging : discharging)[static_cast<std::size_t>(hour_of(step))] +=
        r.profit_eur * share;
  });
  PictureTable table{"hours", {"local_hour", "charging", "discharging", "together"}, {}};
  for (std::size_t h = 0; h < kHours; ++h) {
    table.rows.push_back({fmt::format("{}", h), exact(charging[h]), exact(discharging[h]),
                          exact(charging[h] + discharging[h])});
  }
  return table;
}

PictureTable step_table(const ReportInputs& in, const PageSteps& steps) {
  PictureTable table{
      "steps", {"utc", "observed_eur_per_mwh", "paid_eur_per_mwh"}, {}, /*packed=*/true};
  for (const PolicySteps& policy : steps.policies) {
    for (const char* what : {"soc_frac", "action", "power_w", "profit_eur"}) {
      table.columns.push_back(fmt::format("{} {}", policy.name, what));
    }
  }
  for_each_step(in, steps, [&](const MarketStep& step, std::size_t i) {
    std::vector<std::string> row{std::string(utc_text(step.utc_s).view()),
                                 fmt::format("{:.2f}", step.observed_eur_per_mwh),
                                 fmt::format("{:.3f}", step.paid_eur_per_mwh)};
    for (const PolicySteps& policy : steps.policies) {
      const StepRecord& r = policy.records[i];
      row.push_back(fmt::format("{:.4f}", r.soc_frac));
      row.emplace_back(action_name(r.action));
      row.push_back(fmt::format("{:.1f}", r.power_w + 0.0));
      row.push_back(fmt::format("{:.4f}", r.profit_eur + 0.0));
    }
    table.rows.push_back(std::move(row));
  });
  return table;
}

/// A row a run of prices with the same action, at each SoC.
PictureTable map_table(const ReportInputs& in) {
  PictureTable table{"policy_map",
                     {"student", "context_class", "quarter_hour", "minute", "soc_frac",
                      "price_from_eur_per_mwh", "price_to_eur_per_mwh", "action"},
                     {}};
  const PolicyContext context = first_map(in);
  const auto add = [&](const char* name, const StudentFile* student) {
    if (student == nullptr) return;
    const ActionGrid grid = student_grid(student->net, context);
    const auto prices = static_cast<int>(grid.size()) / kSocCount;
    for (int soc = 0; soc < kSocCount; ++soc) {
      const std::int8_t* row = &grid[static_cast<std::size_t>(soc) * prices];
      for (int from = 0, p = 1; p <= prices; ++p) {
        if (p < prices && row[p] == row[from]) continue;
        table.rows.push_back({name, fmt::format("{}", context.context_class),
                              fmt::format("{}", context.quarter_hour),
                              fmt::format("{}", context.minute_of_quarter_hour),
                              fmt::format("{:.3f}", static_cast<double>(soc) / (kSocCount - 1)),
                              fmt::format("{}", kLatticePriceMinEurPerMwh + from),
                              fmt::format("{}", kLatticePriceMinEurPerMwh + p - 1),
                              std::string(action_name(static_cast<Action>(row[from])))});
        from = p;
      }
    }
  };
  if (in.corrected) add(own_student_name(in.corrected->certificate), in.corrected);
  add(kPlainName, in.uncorrected);
  return table;
}

PictureTable teacher_table(const ReportInputs& in) {
  PictureTable table{
      "validation_teacher",
      {"step", "validation_eur_per_day_per_mwh", "state", "rule_eur_per_day_per_mwh"},
      {}};
  const std::string rule = exact(rule_validation_profit(in.market, in.battery));
  for (const CurvePoint& point : in.training_curve) {
    const CheckpointState state = &point == &kept_point(in.training_curve)
                                      ? CheckpointState::kChosen
                                      : CheckpointState::kPassedOver;
    table.rows.push_back({fmt::format("{}", point.step),
                          exact(point.validation_eur_per_day_per_mwh),
                          std::string(checkpoint_state_name(state)), rule});
  }
  return table;
}

PictureTable student_table(const ReportInputs& in) {
  PictureTable table{
      "validation_student", {"round", "epoch", "validation_eur_per_day_per_mwh", "state"}, {}};
  for (const StudentCheckpoint& c : in.checkpoints) {
    table.rows.push_back({fmt::format("{}", c.round), fmt::format("{}", c.epoch),
                          exact(c.validation_eur_per_day_per_mwh),
                          std::string(checkpoint_state_name(c.state))});
  }
  return table;
}

PictureTable price_table(const ReportInputs& in) {
  return histogram_table("prices_seen", price_histogram(in.market));
}

}  // namespace

std::vector<PictureTable> page_pictures(const ReportInputs& in, const PageSteps& steps) {
  return {cumulative_table(in),  drawdown_table(in),
          month_table(in),       distribution_table(in),
          hour_table(in, steps), step_table(in, steps),
          map_table(in),         teacher_table(in),
          student_table(in),     distil_losses_table("distillation", in.distil_curve),
          price_table(in)};
}

}  // namespace bess
