// What a network may add to the stochastic program (planners/stochastic_program.h), so that it
// stands on the program's shoulders instead of learning the market anew:
//
//   Q(s, a) = A(s, a) + E[Z(s, a)]    A(s, a) = Q_P(s, a) - V_P(s)    V_P(s) = max_b Q_P(s, b)
//
// Q_P are the program's action values, discounted by its gamma_P. Rewards shaped by V_P
// [Ng, Harada, Russell 1999], with a discount g <= gamma_P for what is learned
// [Cheng, Kolobov, Swaminathan 2021, heuristic-guided learning], lead to
//
//   Q(s, a) = E[r - c + gamma_P V_P(s') - V_P(s) + g max_b Q(s', b)]
//
// With g = gamma_P that is the optimum, up to V_P; with less, the program's own values stand beyond
// the reach 1 / (1 - g) steps. Q = A + E[Z] on both sides, and V_P + A = Q_P, give
//
//   Z(s, a) =(in distribution) r' + g A(s', a*) + g Z(s', a*)
//   a* = argmax_b A(s', b) + E[Z(s', b)]
//   r' = r - c + gamma_P V_P(s') - Q_P(s, a)
//
// So in Algorithm 1 [Bellemare, Dabney, Munos 2017] atom z_j of Z(s', a*) moves to
// (r' + g A(s', a*)) + g z_j: the reward's place is taken by what stands in brackets. r' is the
// program's own error in one step: where its model is right it is zero on average, and so is Z. The
// constant c, one for every action, takes away what is left of a mean.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "workstation/data/env/outlook_book.h"
#include "workstation/policy/planners/outlook_program.h"
#include "workstation/policy/planners/stochastic_program.h"
#include "workstation/policy/rl/price_map.h"

namespace bess {

/// What a network adds to: a program by month or level, or one that plans on day-ahead prices.
struct Foundation {
  std::shared_ptr<const StochasticProgram> program = nullptr;
  std::shared_ptr<const OutlookProgram> outlook = nullptr;
  std::shared_ptr<const OutlookBook> book = nullptr;  ///< with `outlook`

  explicit operator bool() const { return program != nullptr || outlook != nullptr; }
  [[nodiscard]] const BatteryParameters& battery() const {
    return outlook ? outlook->battery() : program->battery();
  }
  [[nodiscard]] double gamma() const { return outlook ? outlook->gamma() : program->gamma(); }
};

/// The program's action values in many steps, each for every SoC, in the unit that rewards are
/// learned in. By outlook also the break-even price, which the network sees instead of a class.
class ProgramRows {
 public:
  explicit ProgramRows(Foundation foundation);

  /// By outlook, before any step is added: plans all steps that will be, on so many threads.
  void plan(const MarketSteps& market, const std::vector<MarketDay>& days, int threads);
  /// The row of this step. Asked for steps in the order of time: the successor of one is mostly the
  /// next one asked for, and shares its row.
  std::uint32_t add(const MarketStep& step);

  struct Values {
    std::array<float, kActionCount> action;  ///< Q_P, discharge first
    float best;                              ///< V_P
  };
  [[nodiscard]] Values at(std::uint32_t row, double soc_frac) const;
  [[nodiscard]] double gamma() const { return foundation_.gamma(); }
  [[nodiscard]] bool is_outlook() const { return foundation_.outlook != nullptr; }
  /// By outlook: EUR/MWh.
  [[nodiscard]] double break_even(std::uint32_t row, double soc_frac) const;
  /// By outlook: the row is the first of its plan. Values of two plans have no common zero.
  [[nodiscard]] bool begins_plan(std::uint32_t row) const { return begins_plan_[row] != 0; }

 private:
  void plan_day(std::span<const MarketStep> steps, std::size_t row);

  Foundation foundation_;
  SocGrid grid_, break_even_grid_;
  double unit_per_eur_;
  std::vector<float> continuation_;        ///< [row][SoC point], EUR
  std::vector<double> price_eur_per_mwh_;  ///< [row] expected
  std::vector<double> full_power_w_;       ///< [row]
  std::vector<float> break_even_;          ///< [row][SoC point], EUR/MWh
  std::vector<std::uint8_t> begins_plan_;  ///< [row]
  std::vector<std::int64_t> utc_s_;        ///< [row] step
};

}  // namespace bess
