#include "workstation/chain/distilled_prices.h"

#include <fmt/core.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <limits>
#include <memory>

#include "shared/host/user_error.h"
#include "workstation/chain/interruption.h"
#include "workstation/chain/rule_files.h"
#include "workstation/chain/rule_price_json.h"
#include "workstation/rules/rule_conflicts.h"
#include "workstation/student/correct_and_prove.h"
#include "workstation/student/exported_policy.h"
#include "workstation/student/failed_proof.h"

namespace bess {
namespace {

/// Of one set of rules: what its students earn, by seed, and what their proofs counted.
struct Students {
  std::vector<Evaluation> reset, carried;
  std::int64_t states = 0, violations = 0;
  std::size_t rounds_most = 0;          ///< of the one that took most
  double seconds = 0;                   ///< of all, distilled and proved
  std::vector<std::string> failures{};  ///< of those that were not proved

  [[nodiscard]] std::size_t count() const { return reset.size(); }
  [[nodiscard]] std::size_t proved() const { return count() - failures.size(); }
  [[nodiscard]] double seconds_each() const { return seconds / static_cast<double>(count()); }
};

class Distillery {
 public:
  Distillery(const DistilledPriceOptions& options, const Teacher& teacher, const RunConfig& config,
             const MarketSteps& market)
      : options_(options), teacher_(teacher), config_(config), market_(market) {
    RunConfig seeded = config;
    for (int s = 0; s < options.seeds; ++s) {
      seeded.set_seed(seed_of(s));
      visited_.push_back(visited_inputs(teacher, market, seeded.battery, seeded.distil));
    }
  }

  [[nodiscard]] Students students(const std::string& name, const RuleSet& rules) const {
    RunConfig config = config_;
    use_rules(config, rules, teacher_.context.kind);
    Students students;
    for (int s = 0; s < options_.seeds; ++s) {
      config.set_seed(seed_of(s));
      const auto start = std::chrono::steady_clock::now();
      const CorrectionResult result = correct_and_prove(
          teacher_, visited_[static_cast<std::size_t>(s)], config.distil, interruption(),
          validation_score(market_, config.battery, config.initial_soc_frac));
      const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
      const StudentFile& student = student_of(result.verdict);
      students.seconds += took.count();
      students.rounds_most = std::max(students.rounds_most, result.rounds.size());
      students.states += student.certificate.states_checked;
      students.violations += student.certificate.violations();
      if (student.certificate.violations() > 0) {
        students.failures.push_back(
            describe_failed_proof(student, result.rounds, config.distil.method,
                                  fmt::format("\"{}\", seed {}: ", name, config.distil.seed)));
      }
      const std::unique_ptr<Policy> policy = exported_policy(student);
      const BothWays earned = run_both_ways(*policy, options_.days, config, market_);
      students.reset.push_back(earned.reset);
      students.carried.push_back(earned.carried);
      if (options_.keep.empty()) continue;
      save_student(std::filesystem::path(options_.keep) /
                       fmt::format("{}.seed-{}.json", name, config.distil.seed),
                   student);
    }
    return students;
  }

 private:
  [[nodiscard]] std::uint64_t seed_of(int student) const {
    return config_.distil.seed + static_cast<std::uint64_t>(student);
  }

  const DistilledPriceOptions& options_;
  const Teacher& teacher_;
  const RunConfig& config_;
  const MarketSteps& market_;
  std::vector<Matrix> visited_;  ///< by seed: where the teacher goes does not depend on the rules
};

std::string amount(double value) {
  return std::isfinite(value) ? fmt::format("{:.1f}", value) : "-";
}

void print_head(const DistilledPriceOptions& options, const Students& base) {
  if (options.json) return;
  fmt::print(
      "\n{} student{} distilled without them: {:.1f} EUR a day per MWh of capacity, with the SoC "
      "carried over {:.1f}; {} violations, {:.0f} s each.\nWhat learning rules changes, day by "
      "day; rounds: of the student that took most; s: to learn and prove one\n"
      "{:<30} {:>6} {:>6} {:>5} {:>10} {:>8} {:>6} {:>8} {:>7}  {:>8} {:>6} {:>8} {:>7}\n",
      options.seeds, options.seeds == 1 ? "" : "s",
      mean_of(base.reset).profit_eur_per_day_per_mwh(),
      mean_of(base.carried).profit_eur_per_day_per_mwh(), base.violations, base.seconds_each(),
      "rule", "proved", "rounds", "s", "violations", "reset", "s.e.", "by month", "spread",
      "carried", "s.e.", "by month", "spread");
}

void print_row(const DistilledPriceOptions& options, const std::string& name, const Students& base,
               const Students& ruled) {
  const SeededDifference reset = seeded_difference(ruled.reset, base.reset);
  const SeededDifference carried = seeded_difference(ruled.carried, base.carried);
  if (!options.json) {
    fmt::print(
        "{:<30} {:>6} {:>6} {:>5.0f} {:>10} {:>+8.1f} {:>6} {:>8} {:>7}  {:>+8.1f} {:>6} {:>8} "
        "{:>7}\n",
        name, fmt::format("{}/{}", ruled.proved(), ruled.count()), ruled.rounds_most,
        ruled.seconds_each(), ruled.violations, reset.mean, error_text(reset.standard_error, 1),
        error_text(reset.standard_error_by_month, 1), amount(reset.spread), carried.mean,
        error_text(carried.standard_error, 1), error_text(carried.standard_error_by_month, 1),
        amount(carried.spread));
  } else {
    const auto gain = [](const std::vector<Evaluation>& with,
                         const std::vector<Evaluation>& without,
                         const SeededDifference& difference) {
      return RuleGain{mean_of(with).profit_eur_per_day_per_mwh(),
                      mean_of(without).profit_eur_per_day_per_mwh(),
                      difference.mean,
                      difference.standard_error,
                      difference.standard_error_by_month,
                      difference.spread};
    };
    const RulePriceRow row{.rule = name,
                           .by = "distillation",
                           .gain_over = "students without rules",
                           .split = options.split,
                           .days = options.days.size(),
                           .reset = gain(ruled.reset, base.reset, reset),
                           .carried = gain(ruled.carried, base.carried, carried),
                           .seeds = options.seeds,
                           .states_checked = ruled.states,
                           .violations = ruled.violations,
                           .proved = ruled.proved(),
                           .rounds = ruled.rounds_most,
                           .seconds_per_student = ruled.seconds_each()};
    fmt::print("{}\n", rule_price_json(row).line());
  }
  std::fflush(stdout);  // each takes minutes
}

/// The rule, with the thresholds that the other rules set: some rules contradict the configured
/// ones.
RuleSet alone(const Rule& rule, const RuleSet& all) {
  RuleSet some{{rule}};
  for (const Rule& other : all.rules) {
    if (other.is_threshold && other.name != rule.name) some.rules.push_back(other);
  }
  return some;
}

}  // namespace

BothWays run_both_ways(Policy& policy, const std::vector<MarketDay>& days, const RunConfig& config,
                       const MarketSteps& market) {
  const auto evaluated = [&](bool carry_soc) {
    return evaluate(market, days, policy, {config.battery, config.initial_soc_frac, carry_soc});
  };
  return {evaluated(false), evaluated(true)};
}

SeededDifference seeded_difference(const std::vector<Evaluation>& with,
                                   const std::vector<Evaluation>& without) {
  const PairedDifference over_days = paired_difference(mean_of(with), mean_of(without));
  double squares = 0;
  for (std::size_t s = 0; s < with.size(); ++s) {
    const double off = paired_difference(with[s], without[s]).mean - over_days.mean;
    squares += off * off;
  }
  const double spread = with.size() > 1 ? std::sqrt(squares / static_cast<double>(with.size() - 1))
                                        : std::numeric_limits<double>::quiet_NaN();
  return {over_days.mean, over_days.standard_error, over_days.standard_error_by_month, spread};
}

void price_by_distilling(const DistilledPriceOptions& options, const Teacher& teacher,
                         const RunConfig& config, const MarketSteps& market) {
  const ContextKind kind = teacher.context.kind;
  const Distillery distillery(options, teacher, config, market);
  const Students base = distillery.students("without rules", {});
  print_head(options, base);
  std::vector<std::string> failures = base.failures;
  const auto price = [&](const std::string& name, const RuleSet& rules) {
    const Students ruled = distillery.students(name, rules);
    print_row(options, name, base, ruled);
    failures.insert(failures.end(), ruled.failures.begin(), ruled.failures.end());
  };
  const std::vector<Rule>& rules = options.rules.rules;
  for (const Rule& rule : rules) {
    if (!options.alone || rules.size() == 1) break;
    if (binds_student(rule, kind)) {
      price(rule.name, alone(rule, options.rules));
    } else if (!options.json) {
      fmt::print("{:<30} the guard's alone: a student by {} does not see where it holds\n",
                 rule.name, context_name(kind));
    }
  }
  price(rules.size() == 1 ? rules.front().name : kAllTogether, options.rules);
  if (!failures.empty()) fail("{}", fmt::join(failures, "\n"));
}

}  // namespace bess
