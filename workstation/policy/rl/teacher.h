// The teacher: action values over the five inputs. A network that learnt them (DQN) or their
// distributions (C51), or the stochastic program that knows them for its model of the market (SDP).
// One file holds everything needed to use it again: method, support, price map, parameters.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "workstation/base/answer.h"
#include "workstation/data/env/outlook_book.h"
#include "workstation/data/env/policy.h"
#include "workstation/policy/nn/mlp.h"
#include "workstation/policy/planners/outlook_program.h"
#include "workstation/policy/planners/stochastic_program.h"
#include "workstation/policy/rl/c51.h"
#include "workstation/policy/rl/network_input.h"
#include "workstation/policy/rl/price_map.h"
#include "workstation/policy/rl/program_residual.h"

namespace bess {

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
  /// SDP: instead of a network, shape and parameters are empty. With a network: what it adds to
  /// (program_residual.h).
  std::shared_ptr<const StochasticProgram> program = nullptr;
  ContextClasses context{};  ///< by month unless said otherwise
  Entries learnt_for{};      ///< market, battery, costs and prices; empty: the file does not say
  /// By outlook: the program that plans on day-ahead prices, instead of `program`, and its plans in
  /// integers, which give the student its context.
  std::shared_ptr<const OutlookProgram> outlook = nullptr;
  std::shared_ptr<const OutlookBook> book = nullptr;

  [[nodiscard]] Foundation foundation() const { return {program, outlook, book}; }
  [[nodiscard]] bool is_residual() const { return foundation() && method != Method::kSdp; }
  /// By outlook the values are no function of the inputs: three rows below them hold them.
  /// Action values, means of their distributions, [3 x samples] in units of 1e4 EUR/h for inputs
  /// [5 x samples].
  [[nodiscard]] Matrix action_values(const MatrixRef& x, MlpTile& tile) const;
  /// The network's part of them. Of a residual in whole millionths of the support's reach: a point
  /// mass at zero then is zero exactly, however its exponentials are rounded.
  [[nodiscard]] Matrix network_values(const MatrixRef& x, MlpTile& tile) const;
  /// Of a residual: adds to the program's values of this step what the network does, EUR.
  void add_network(const MarketStep& step, double soc_frac, Matrix& x, MlpTile& tile,
                   std::array<double, kActionCount>& worth_eur) const;
  /// Writes the five inputs of a step. By outlook the break-even price, mapped as prices are,
  /// stands where the student sees its class.
  void write_inputs(const MarketStep& step, double soc_frac, float* x) const {
    NetworkContext seen = network_context(step, price_map, context);
    if (book) {
      seen.context_class =
          price_map(double{book->break_even_centi(step, soc_frac) / double{kCentiPerEur}});
    }
    write_input(seen, soc_frac, x);
  }
};

/// Makes of a network's parameters those of a residual that adds nothing: C51's distributions are a
/// point mass at the middle atom, but for kPriorMass that the first steps can grow from.
void begin_at_zero(Method method, const Support& support, const MlpShape& shape,
                   Parameters& parameters);
inline constexpr double kPriorMass = 2.5e-3;

/// Outputs of the network for a method.
MlpShape teacher_shape(Method method, const Support& support);

/// Versioned, checksummed, written beside and renamed. load throws UserError when the file is not a
/// teacher, is damaged, or is of another version.
void save_teacher(const std::filesystem::path& path, const Teacher& teacher);
Teacher load_teacher(const std::filesystem::path& path);
/// Makes `teacher` one by outlook: the program, its integers and the book of their plans.
void set_outlook(std::shared_ptr<const OutlookProgram> program, Teacher& teacher);
/// True when the file starts like a teacher's.
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
