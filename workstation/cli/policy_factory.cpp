#include "workstation/cli/policy_factory.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <filesystem>

#include "shared/host/user_error.h"
#include "workstation/planners/cycle_limit.h"
#include "workstation/planners/foresight.h"
#include "workstation/planners/outlook_program.h"
#include "workstation/planners/rolling_horizon.h"
#include "workstation/planners/stochastic_program.h"
#include "workstation/planners/tabular.h"
#include "workstation/planners/tuned_rule.h"
#include "workstation/student/exported_policy.h"

namespace bess {
namespace {

constexpr std::string_view kGivenRule = "rbc:";
constexpr std::string_view kOutlook = "sdp-outlook";

/// Keeps a model alive as long as the policy that reads it.
template <typename Model, typename ModelPolicy, typename View>
std::shared_ptr<Policy> owning(Model model, View view) {
  struct Holder {
    Model model;
    ModelPolicy policy;
    Holder(Model m, View v) : model(std::move(m)), policy(v(model)) {}
  };
  auto holder = std::make_shared<Holder>(std::move(model), view);
  return {holder, &holder->policy};
}

std::shared_ptr<Policy> student_policy(StudentFile student) {
  struct Holder {
    StudentFile student;
    std::unique_ptr<Policy> policy;
  };
  const auto holder = std::make_shared<Holder>(std::move(student), nullptr);
  holder->policy = exported_policy(holder->student);
  return {holder, holder->policy.get()};
}

std::shared_ptr<Policy> model_policy(const std::string& path, const Risk& risk) {
  if (!std::filesystem::exists(path)) {
    fail("--policy {}: neither a file nor one of: {}", path, kPolicyHelp);
  }
  if (is_teacher_file(path)) {
    return owning<Teacher, TeacherPolicy>(load_teacher(path, risk),
                                          [](const Teacher& t) -> const Teacher& { return t; });
  }
  return student_policy(load_student(path));
}

/// "rbc:LOW:HIGH", EUR/MWh.
std::shared_ptr<Policy> given_rule(const std::string& name) {
  double low = 0;
  double high = 0;
  const char* at = name.data() + kGivenRule.size();
  const char* const end = name.data() + name.size();
  auto read = std::from_chars(at, end, low);
  const bool low_ok = read.ec == std::errc() && read.ptr != end && *read.ptr == ':';
  if (low_ok) read = std::from_chars(read.ptr + 1, end, high);
  if (!low_ok || read.ec != std::errc() || read.ptr != end || !std::isfinite(low) ||
      !std::isfinite(high) || low > high) {
    fail("--policy {}: use rbc:LOW:HIGH with two prices in EUR/MWh, LOW not above HIGH: rbc:11:179",
         name);
  }
  return std::make_shared<RuleBasedPolicy>(low, high);
}

/// Fits a planner on the training days, mindful of a limit on daily cycles.
template <typename Planner, typename... Options>
std::shared_ptr<Policy> fit_planner(const MarketSteps& market, const BatteryParameters& battery,
                                    const Options&... options) {
  const std::vector<MarketDay> days = market.days_of(Split::kTrain);
  return std::make_shared<Planner>(
      market, days, battery_with_shadow_price<Planner>(market, days, battery, options...),
      options...);
}

}  // namespace

std::pair<double, double> training_quartiles(const MarketSteps& market) {
  std::vector<double> prices;
  for (const MarketDay& day : market.days_of(Split::kTrain)) {
    for (const MarketStep& step : market.of(day)) prices.push_back(step.paid_eur_per_mwh);
  }
  require_training_days(prices.size());
  std::ranges::sort(prices);
  return {prices[prices.size() / 4], prices[prices.size() * 3 / 4]};
}

void require_policies(const std::vector<std::string>& names) {
  constexpr std::array<std::string_view, 10> kKnown{
      "rbc", "rbc-quartile", "rbc-tuned", "tabular",   "mpc",
      "sdp", "sdp-hour",     kOutlook,    "foresight", "compiled"};
  for (const std::string& name : names) {
    if (std::ranges::find(kKnown, name) != kKnown.end()) continue;
    const bool is_pipe = std::filesystem::exists(name) && !std::filesystem::is_regular_file(name);
    if (is_pipe) continue;  // it can be read once
    name.starts_with(kGivenRule) ? given_rule(name) : model_policy(name, {});
  }
}

void require_outlook(const std::vector<std::string>& names, const std::string& day_ahead) {
  if (!day_ahead.empty() || std::ranges::find(names, kOutlook) == names.end()) return;
  fail("--policy {} plans on day-ahead prices: give their file with --day-ahead", kOutlook);
}

std::shared_ptr<Policy> make_policy(const std::string& name, const MarketSteps& market,
                                    const BatteryParameters& battery, const Risk& risk) {
  if (name == "rbc") {
    return std::make_shared<RuleBasedPolicy>(kPaperRuleLowEurPerMwh, kPaperRuleHighEurPerMwh);
  }
  if (name == "rbc-quartile") {
    const auto [low, high] = training_quartiles(market);
    return std::make_shared<RuleBasedPolicy>(low, high);
  }
  if (name == "tabular") {
    return fit_planner<TabularPolicy>(market, battery);
  }
  if (name == "sdp") return fit_planner<StochasticProgramPolicy>(market, battery);
  if (name == kOutlook) return fit_planner<OutlookPolicy>(market, battery);
  if (name == "sdp-hour") {
    return fit_planner<StochasticProgramPolicy>(market, battery,
                                                StochasticProgramOptions{.level_weight = 0});
  }
  if (name.starts_with(kGivenRule)) return given_rule(name);
  if (name == "rbc-tuned") {
    const RuleThresholds t = tune_rule(market, market.days_of(Split::kTrain), battery);
    return std::make_shared<RuleBasedPolicy>(t.low_eur_per_mwh, t.high_eur_per_mwh);
  }
  if (name == "mpc") {
    return fit_planner<RollingHorizonPolicy>(market, battery);
  }
  if (name == "foresight") return std::make_shared<ForesightPolicy>(battery);
  if (name == "compiled") return student_policy(compiled_student());
  return model_policy(name, risk);
}

}  // namespace bess
