#include "workstation/report/page_pictures.h"

#include <fmt/core.h>

#include <algorithm>

#include "shared/utc_text.h"
#include "workstation/report/figures/policy_map.h"
#include "workstation/report/figures/price_histogram.h"
#include "workstation/report/headline.h"
#include "workstation/report/shown_policies.h"

namespace bess {
namespace {

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

PictureTable price_table(const ReportInputs& in) {
  return histogram_table("prices_seen", price_histogram(in.market));
}

}  // namespace

std::vector<PictureTable> page_pictures(const ReportInputs& in, const PageSteps& steps) {
  return {step_table(in, steps), map_table(in), price_table(in)};
}

}  // namespace bess
