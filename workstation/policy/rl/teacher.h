// Teacher: action values over the five inputs, from a network that learned them (DQN) or their
// distributions (C51), or from the stochastic program (SDP). One file has everything needed to use
// it: method, support, price map, parameters.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "workstation/base/answer.h"
#include "workstation/data/env/plan_cache.h"
#include "workstation/data/env/policy.h"
#include "workstation/policy/nn/mlp.h"
#include "workstation/policy/planners/outlook_program.h"
#include "workstation/policy/planners/stochastic_program.h"
#include "workstation/policy/rl/c51.h"
#include "workstation/policy/rl/network_input.h"

namespace bess {

// Residual on the stochastic program (planners/stochastic_program.h): the network adds to the
// program's action values instead of relearning the market:
//
//   Q(s, a) = A(s, a) + E[Z(s, a)]    A(s, a) = Q_P(s, a) - V_P(s)    V_P(s) = max_b Q_P(s, b)
//
// Q_P are the program's action values, discounted by its gamma_P. Rewards shaped by V_P [Ng,
// Harada, Russell 1999], with a discount g <= gamma_P for the residual [Cheng, Kolobov, Swaminathan
// 2021, heuristic-guided learning], give
//
//   Q(s, a) = E[r - c + gamma_P V_P(s') - V_P(s) + g max_b Q(s', b)]
//
// With g = gamma_P this is the optimum, up to V_P; with a smaller g, the program's own values apply
// beyond the horizon of 1 / (1 - g) steps. Q = A + E[Z] on both sides, and V_P + A = Q_P, give
//
//   Z(s, a) =(in distribution) r' + g A(s', a*) + g Z(s', a*)
//   a* = argmax_b A(s', b) + E[Z(s', b)]
//   r' = r - c + gamma_P V_P(s') - Q_P(s, a)
//
// In Algorithm 1 [Bellemare, Dabney, Munos 2017] atom z_j of Z(s', a*) therefore moves to (r' + g
// A(s', a*)) + g z_j: the bracket replaces the reward. r' is the program's error in one step: zero
// on average where its model is correct, and so is Z. The constant c, equal for every action,
// removes the remaining mean.

/// Program that the residual adds to: by month or level, or planned on day-ahead prices.
struct BasePrograms {
  std::shared_ptr<const StochasticProgram> program = nullptr;
  std::shared_ptr<const OutlookProgram> outlook = nullptr;
  std::shared_ptr<const PlanCache> plan_cache = nullptr;  ///< with `outlook`

  explicit operator bool() const { return program != nullptr || outlook != nullptr; }
  [[nodiscard]] const BatteryParameters& battery() const {
    return outlook ? outlook->battery() : program->battery();
  }
  [[nodiscard]] double gamma() const { return outlook ? outlook->gamma() : program->gamma(); }
};

/// The program's action values at many steps, each for every SoC, in learned units. With the
/// outlook also the break-even price, which the network gets instead of a class.
class ProgramRows {
 public:
  /// For all steps of these days, which are in order of time.
  ProgramRows(BasePrograms base_programs, const MarketSteps& market,
              const std::vector<MarketDay>& days, int threads);

  /// Row of a step of these days.
  [[nodiscard]] std::uint32_t row_of(const MarketStep& step) const;

  struct Values {
    std::array<float, kActionCount> action;  ///< Q_P, discharge first
    float best;                              ///< V_P
  };
  [[nodiscard]] Values at(std::uint32_t row, double soc_frac) const;
  [[nodiscard]] double gamma() const { return base_programs_.gamma(); }
  [[nodiscard]] bool is_outlook() const { return base_programs_.outlook != nullptr; }
  /// With the outlook: EUR/MWh.
  [[nodiscard]] double break_even(std::uint32_t row, double soc_frac) const;
  /// With the outlook: the row is the first of its plan. Values of two plans have no common zero.
  [[nodiscard]] bool begins_plan(std::uint32_t row) const { return begins_plan_[row] != 0; }

 private:
  void fill_day(std::span<const MarketStep> steps, std::size_t row);
  void fill_break_even(const MarketStep& step, std::size_t row);

  BasePrograms base_programs_;
  SocGrid grid_, break_even_grid_;
  double unit_per_eur_;
  std::vector<float> continuation_;        ///< [row][SoC point], EUR
  std::vector<double> price_eur_per_mwh_;  ///< [row] expected
  std::vector<double> full_power_w_;       ///< [row]
  std::vector<float> break_even_;          ///< [row][SoC point], EUR/MWh
  std::vector<std::uint8_t> begins_plan_;  ///< [row]
  std::vector<std::int64_t> utc_s_;        ///< [row] time of the step
};

enum class Method { kC51, kDqn, kSdp };
Method parse_method(std::string_view name);  ///< "c51", "dqn", "sdp"; throws UserError otherwise
std::string_view method_name(Method method);

struct Teacher {
  Method method;
  Support support;  ///< C51 only; scaled units
  MlpShape shape;
  PriceMap price_map;
  Parameters parameters;
  std::string provenance;  ///< one line: prices, seed, steps
  /// SDP: replaces the network, shape and parameters are empty. With a network: program that its
  /// residual adds to.
  std::shared_ptr<const StochasticProgram> program = nullptr;
  ContextClasses context{};  ///< default: month
  Entries learnt_for{};      ///< market, battery, costs and prices; empty: unknown
  /// With the outlook: the program on day-ahead prices, instead of `program`, and its integer
  /// plans, which give the student its context.
  std::shared_ptr<const OutlookProgram> outlook = nullptr;
  std::shared_ptr<const PlanCache> plan_cache = nullptr;

  [[nodiscard]] BasePrograms base_programs() const { return {program, outlook, plan_cache}; }
  [[nodiscard]] bool has_program() const { return program != nullptr || outlook != nullptr; }
  [[nodiscard]] bool is_residual() const { return has_program() && method != Method::kSdp; }
  /// Action values, means of their distributions, [3 x samples] in units of 1e4 EUR/h for inputs [5
  /// x samples]. With the outlook they are no function of the inputs: three rows below the inputs
  /// contain them.
  [[nodiscard]] Matrix action_values(const MatrixRef& x, MlpTile& tile) const;
  /// The network's part. For a residual in whole millionths of the support's range: a point mass at
  /// zero is then exactly zero despite rounding.
  [[nodiscard]] Matrix network_values(const MatrixRef& x, MlpTile& tile) const;
  /// Residual: adds the network's part to the program's values of this step, EUR.
  void add_network(const MarketStep& step, double soc_frac, Matrix& x, MlpTile& tile,
                   std::array<double, kActionCount>& worth_eur) const;
  /// Writes the five inputs of a step. With the outlook the mapped break-even price replaces the
  /// student's class.
  void write_inputs(const MarketStep& step, double soc_frac, float* x) const {
    NetworkContext seen = network_context(step, price_map, context);
    if (plan_cache) {
      seen.context_class =
          price_map(double{plan_cache->break_even_centi(step, soc_frac) / double{kCentiPerEur}});
    }
    write_input(seen, soc_frac, x);
  }
};

/// Sets a network's parameters to a zero residual: C51's distributions are a point mass at the
/// middle atom, except for kPriorMass that the first steps can grow from.
void begin_at_zero(Method method, const Support& support, const MlpShape& shape,
                   Parameters& parameters);
inline constexpr double kPriorMass = 2.5e-3;

/// Shape of the network for a method.
MlpShape teacher_shape(Method method, const Support& support);

/// Versioned, checksummed, replaced atomically. load throws UserError if the file is not a teacher,
/// is damaged, or has another version.
void save_teacher(const std::filesystem::path& path, const Teacher& teacher);
Teacher load_teacher(const std::filesystem::path& path);
/// Sets the outlook of a teacher: program, integers and plan cache.
void set_outlook(std::shared_ptr<const OutlookProgram> program, Teacher& teacher);
/// Whether the file has a teacher's magic.
bool is_teacher_file(const std::filesystem::path& path);

/// Greedy by action value, ties to the lowest action.
class TeacherPolicy final : public Policy {
 public:
  explicit TeacherPolicy(const Teacher& teacher) : teacher_(teacher), x_(kNetworkInputs, 1) {
    if (teacher.outlook) outlook_.emplace(teacher.outlook);
  }
  [[nodiscard]] Action decide(const MarketStep& step, std::size_t index,
                              double soc_frac) const override;

 private:
  const Teacher& teacher_;
  std::optional<OutlookPolicy> outlook_;
  mutable Matrix x_;
  mutable MlpTile tile_;
};

}  // namespace bess
