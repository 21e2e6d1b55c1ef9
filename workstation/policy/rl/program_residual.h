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
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "workstation/data/env/plan_cache.h"
#include "workstation/policy/planners/outlook_program.h"
#include "workstation/policy/planners/stochastic_program.h"

namespace bess {

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

}  // namespace bess
