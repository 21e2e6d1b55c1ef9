// Distillation of the teacher into the 5-64-32-3 student through the correction layer [Paper, Eq.
// 11, 12]: losses, training states and loop. An epoch has 64 context lattices of 32 prices x 16
// SoCs, which the layer corrects, and 32,768 states that the teacher visits, which are not
// corrected. Adam takes several steps per epoch. The student decides without the layer.
#pragma once

#include <Eigen/Core>
#include <atomic>
#include <optional>
#include <string>
#include <vector>

#include "shared/battery_model.h"
#include "shared/features.h"
#include "workstation/base/random.h"
#include "workstation/correction/distillation/constraint_layer.h"
#include "workstation/correction/distillation/correction_layer.h"
#include "workstation/correction/rules/rule.h"
#include "workstation/policy/nn/mlp.h"
#include "workstation/policy/nn/thread_team.h"
#include "workstation/policy/rl/teacher.h"

namespace bess {

// Rules as rows of the constraint layer on one context lattice, for built-in and operator's rules
// alike. A rule on actions gives the rows of ScoreRows at each state of its box. A direction
// requires that u and v fall from each state to its neighbour in price or SoC. "Not idle" is not
// convex, and other directions leave the lattice: they give no rows; the proof finds violations.

/// `context` gives quarter-hour and class; state = price index * SoCs + SoC index. Rows carry the
/// rules' names. Without a rule in force the list is empty.
std::vector<DifferenceRow> lattice_rows(const RuleSet& rules, ContextKind kind,
                                        const LatticeState& context, const LatticeAxes& axes,
                                        const CorrectionOptions& options);

/// The paper's three properties, as in CorrectionLayer.
std::vector<DifferenceRow> property_rows(const CorrectionOptions& options, const LatticeAxes& axes);

/// How the student satisfies property 3.
enum class CorrectionMethod : std::uint8_t {
  kConstruction,  ///< by signs of weights (monotone_distil.h)
  kLayer,         ///< the paper's: training through the optimisation layer until the proof succeeds
};

struct DistilOptions {
  CorrectionMethod method = CorrectionMethod::kConstruction;
  bool correct = true;  ///< false: plain distillation, for comparison
  CorrectionOptions correction;
  RuleSet rules = {};   ///< operator's rules, consistent with the thresholds
  double fidelity = 1;  ///< construction: weight of the cross-entropy; the regret's is 1
  /// Construction: standard deviation of the shift of a visited day's prices.
  double level_shift_eur_per_mwh = 60;
  double omega = 1e-4;  ///< the paper's trade-off; larger follows the teacher and violates more
  double temperature_eur_per_h = 100;  ///< of the teacher's softmax over action values
  int epochs = 600;
  int steps_per_epoch = 16;  ///< Adam steps that share one epoch's states
  int lattices_per_epoch = 64;
  int lattice_prices = 32;
  int lattice_socs = 16;
  int visited_per_epoch = 32'768;
  double learning_rate = 5e-3;  ///< initial value; cosine decay
  int repair_rounds = 12;       ///< proofs, each followed by counterexample training if it fails
  int repair_epochs = 40;
  std::uint64_t seed = 1;
  int threads = 2;
};

inline constexpr MlpShape kStudentShape{kStudentInputs, kStudentHidden1, kStudentHidden2,
                                        kActionCount};

/// Teacher inputs (the student's five first) of states that the teacher's policy visits on the
/// training days, with some exploration. All passes but the first shift each day's prices if the
/// teacher is a stochastic program; a network does not know shifted prices.
Matrix visited_inputs(const Teacher& teacher, const MarketSteps& market,
                      const BatteryParameters& battery, const DistilOptions& options);

/// The teacher's logits: action values over the temperature of its softmax [3 x samples].
Eigen::MatrixXd teacher_logits(const Teacher& teacher, const DistilOptions& options,
                               const MatrixRef& x, MlpTile& tile);

/// Method construction has no lattices: their losses are 0, and the visited loss is the mean regret
/// over the temperature.
struct DistilPoint {
  int epoch;
  double teacher_loss;     ///< mean KL(pi || mu) over lattices
  double correction_loss;  ///< mean KL(pi' || pi) over lattices
  double visited_loss;     ///< mean KL(pi' || mu) over visited states

  [[nodiscard]] bool is_by_construction() const {
    return teacher_loss == 0 && correction_loss == 0;
  }
};

class Distiller {
 public:
  /// Keeps references: `teacher` and `visited` must outlive it. Rules that name states need the
  /// general layer, whose time grows with the cube of a lattice: lattices are then smaller and more
  /// numerous.
  Distiller(const Teacher& teacher, const Matrix& visited, const DistilOptions& options);

  /// Trains for `epochs`. Half of the lattices are around `counterexamples`, if any, and slope
  /// margins are multiplied by `margin_scale`.
  void run(int epochs, const std::vector<LatticeState>& counterexamples, double margin_scale,
           const std::atomic<bool>& interrupted);

  [[nodiscard]] const Parameters& parameters() const { return student_; }
  [[nodiscard]] const std::vector<DistilPoint>& curve() const { return curve_; }

 private:
  /// One context with its axes.
  struct Lattice {
    int minute_of_quarter_hour, quarter_hour, context_class;
    LatticeAxes axes;
  };
  struct Losses {
    double teacher = 0, correction = 0, visited = 0;
  };
  struct Worker {
    Parameters gradient;
    Losses losses;
    MlpTile teacher_tile, student_tile;
    Matrix seen;  ///< teacher inputs, possibly more than the student's
    Matrix x, z, dz;
    std::string complaint;  ///< error of the constraint layer, for the user
  };

  Lattice draw_lattice(const std::vector<LatticeState>& counterexamples, bool near_counterexample);
  void draw_axes(const LatticeState* centre, LatticeAxes& axes);
  void lattice_inputs(const Lattice& lattice, Matrix& x) const;
  Eigen::MatrixXd teacher_log_policy(const Matrix& seen, Worker& worker) const;
  void backward_student(Worker& worker) const;
  [[nodiscard]] std::optional<ConstraintLayer> layer_with_rules(
      const Lattice& lattice, const CorrectionOptions& correction) const;
  void learn_lattice(const Lattice& lattice, CorrectionLayer& layer, double weight, Worker& worker);
  void learn_visited(const std::vector<Eigen::Index>& columns, double weight, Worker& worker);
  Losses step(const std::vector<Lattice>& lattices, std::vector<CorrectionLayer>& layers,
              const std::vector<Eigen::Index>& visited, double learning_rate);

  const Teacher& teacher_;
  const Matrix& visited_;
  DistilOptions options_;
  Random random_;
  Parameters student_;
  Adam adam_;
  ThreadTeam team_;
  std::vector<Worker> workers_;
  std::vector<DistilPoint> curve_;
};

// Training states of a student with the outlook context: steps of the training days with the action
// values of the teacher (program on day-ahead prices plus residual). The values are no function of
// the student's five inputs, so they are stored below them.

/// [5 inputs and 3 action values x states], as Teacher::action_values() reads them: states that the
/// teacher's policy visits on the training days, and some at another price and SoC. All passes but
/// the first shift each day's prices and break-even prices equally, which leaves the decision
/// unchanged.
Matrix outlook_lessons(const Teacher& teacher, const MarketSteps& market,
                       const BatteryParameters& battery, const DistilOptions& options);

// Loss of the distillation and its gradients, per state [Paper, Eq. 12]:
//   L = omega KL(pi || mu) + KL(pi' || pi)
// pi' student, pi corrected student, mu teacher = softmax(action values / temperature).

/// log softmax of each column.
Eigen::MatrixXd log_softmax(const Eigen::MatrixXd& logits);

/// Sum over columns of KL(p || q), from log probabilities.
double kl_divergence(const Eigen::MatrixXd& log_p, const Eigen::MatrixXd& log_q);

/// Gradient of KL(p || q) with respect to the logits of p:  p_k (log p_k - log q_k - KL).
Eigen::MatrixXd kl_gradient_first(const Eigen::MatrixXd& log_p, const Eigen::MatrixXd& log_q);
/// Gradient of KL(p || q) with respect to the logits of q:  q_k - p_k.
Eigen::MatrixXd kl_gradient_second(const Eigen::MatrixXd& log_p, const Eigen::MatrixXd& log_q);

}  // namespace bess
