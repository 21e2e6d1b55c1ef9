// Report test support: two simulated months, policies without training, a tag checker.
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "shared/local_time.h"
#include "tests/support/carried_over.h"
#include "tests/support/teachers.h"
#include "workstation/correction/distillation/distil.h"
#include "workstation/correction/student/student_file.h"
#include "workstation/data/env/evaluate.h"
#include "workstation/data/market/model/simulated_market.h"
#include "workstation/data/market/series/local_date.h"
#include "workstation/report/report.h"

namespace bess {

/// January and February 2023, simulated.
inline const MarketSteps& small_market() {
  static const MarketSteps market = [] {
    set_market_time_zone();
    const UtcSpan period{local_midnight_utc_s({2023, 1, 1}), local_midnight_utc_s({2023, 3, 1})};
    return make_market_steps(minutes_on_quarter_hours(simulate_quarter_hours(period, 3), 3), {});
  }();
  return market;
}

inline PriceMap small_price_map() {
  std::vector<double> observed;
  for (const MarketStep& step : small_market().steps) observed.push_back(step.observed_eur_per_mwh);
  return PriceMap::fit(observed);
}

inline Teacher untrained_teacher() {
  return network_teacher(Method::kDqn, {.v_min = -15, .v_max = 15, .count = 51}, small_price_map(),
                         1, "untrained teacher");
}

inline StudentNet untrained_student() {
  return quantise_student(initial_parameters(kStudentShape, 2), small_price_map());
}

/// As a run evaluates: both accounting modes, with the value of the final charge.
inline NamedEvaluation named_evaluation(const std::string& name, Policy& policy) {
  const auto days = small_market().days_of(Split::kTest);
  NamedEvaluation named{name, evaluate(small_market(), days, policy, {}),
                        evaluate(small_market(), days, policy, kCarriedOver)};
  value_charge_left(named.carried_over, {}, mean_settled_eur_per_mwh(small_market(), days));
  return named;
}

/// Empty if every tag is closed in order, otherwise the first that is not.
inline std::string first_unbalanced_tag(const std::string& html) {
  std::vector<std::string> open;
  for (std::size_t at = html.find('<'); at != std::string::npos; at = html.find('<', at + 1)) {
    const std::size_t end = html.find('>', at);
    if (end == std::string::npos) return "unfinished tag";
    if (html[at + 1] == '!' || html[end - 1] == '/') continue;
    const bool closing = html[at + 1] == '/';
    const std::size_t name_at = at + (closing ? 2 : 1);
    const std::string name = html.substr(name_at, html.find_first_of(" \n>", name_at) - name_at);
    if (name == "meta" || name == "input" || name == "br") continue;
    if (!closing) {
      open.push_back(name);
    } else if (open.empty() || open.back() != name) {
      return "</" + name + ">";
    } else {
      open.pop_back();
    }
  }
  return open.empty() ? "" : "<" + open.back() + ">";
}

}  // namespace bess
