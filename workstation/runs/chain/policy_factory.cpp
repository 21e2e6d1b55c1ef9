#include "workstation/runs/chain/policy_factory.h"

#include <filesystem>

#include "shared/host/user_error.h"
#include "workstation/correction/student/student_policy.h"
#include "workstation/data/env/context_fit.h"
#include "workstation/policy/planners/baselines.h"

namespace bess {
namespace {

constexpr std::string_view kCompiled = "compiled";

std::unique_ptr<Policy> teacher_policy(const Teacher& teacher) {
  return std::make_unique<TeacherPolicy>(teacher);
}

/// Policy that `make` returns, with the model that it uses.
template <typename Model>
std::shared_ptr<Policy> owning(Model model, std::unique_ptr<Policy> (*make)(const Model&)) {
  struct Owner {
    Model model;
    std::unique_ptr<Policy> policy;
  };
  const auto owner = std::make_shared<Owner>(Owner{std::move(model), nullptr});
  owner->policy = make(owner->model);
  return {owner, owner->policy.get()};
}

std::shared_ptr<Policy> model_policy(const std::string& path, const MarketSteps* market) {
  if (!std::filesystem::exists(path)) {
    fail("--policy {}: neither a file nor one of: {}", path, policy_help());
  }
  const auto require_day_ahead = [&](const ContextClasses& context) {
    if (!context.is_outlook() || market == nullptr || market->day_ahead != nullptr) return;
    fail(
        "{}: decides by the outlook and needs day-ahead prices: add --day-ahead to evaluate or "
        "backtest",
        path);
  };
  if (is_teacher_file(path)) {
    Teacher teacher = load_teacher(path);
    require_day_ahead(teacher.context);
    return owning(std::move(teacher), teacher_policy);
  }
  StudentFile student = load_student(path);
  require_day_ahead(student.net.context);
  return owning(std::move(student), exported_policy);
}

}  // namespace

std::string policy_help() {
  std::string text;
  for (const Baseline& baseline : baselines()) {
    text += baseline.name + (baseline.help.empty() ? "" : " (" + baseline.help + ")") + ", ";
  }
  return text + "rbc:LOW:HIGH, compiled (the array in this program), or a teacher or student file";
}

void require_policies(const std::vector<std::string>& names) {
  for (const std::string& name : names) {
    if (name == kCompiled || find_baseline(name) != nullptr) continue;
    const bool is_pipe = std::filesystem::exists(name) && !std::filesystem::is_regular_file(name);
    if (is_pipe) continue;  // can be read only once
    name.starts_with(kGivenRule) ? given_rule(name) : model_policy(name, nullptr);
  }
}

void require_outlook(const std::vector<std::string>& names, const std::string& day_ahead) {
  for (const std::string& name : names) {
    const Baseline* baseline = find_baseline(name);
    if (!day_ahead.empty() || baseline == nullptr || !baseline->is_for(kNeedsDayAhead)) continue;
    fail("--policy {} plans on day-ahead prices: add their file with --day-ahead", name);
  }
}

std::shared_ptr<Policy> make_policy(const std::string& name, const MarketSteps& market,
                                    const BatteryParameters& battery) {
  if (const auto baseline = make_baseline(name, market, battery)) return baseline;
  if (name == kCompiled) return owning(compiled_student(), exported_policy);
  return model_policy(name, &market);
}

ContextClasses context_of_policy(const std::string& policy, const MarketSteps& market,
                                 ContextKind otherwise) {
  if (policy == kCompiled) return compiled_student().net.context;
  if (!std::filesystem::exists(policy)) return fit_context_classes(market, otherwise);
  if (is_teacher_file(policy)) return load_teacher(policy).context;
  return load_student(policy).net.context;
}

}  // namespace bess
