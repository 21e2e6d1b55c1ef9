// The loss of the distillation and its gradients, per state [Paper, Eq. 12]:
//   L = omega KL(pi || mu) + KL(pi' || pi)
// pi' student, pi corrected student, mu teacher = softmax(action values / temperature).
#pragma once

#include <Eigen/Core>

namespace bess {

/// log softmax of each column.
Eigen::MatrixXd log_softmax(const Eigen::MatrixXd& logits);

/// Sum over columns of KL(p || q), from log probabilities.
double kl_divergence(const Eigen::MatrixXd& log_p, const Eigen::MatrixXd& log_q);

/// Gradient of KL(p || q) with respect to the logits of p:  p_k (log p_k - log q_k - KL).
Eigen::MatrixXd kl_gradient_first(const Eigen::MatrixXd& log_p, const Eigen::MatrixXd& log_q);
/// Gradient of KL(p || q) with respect to the logits of q:  q_k - p_k.
Eigen::MatrixXd kl_gradient_second(const Eigen::MatrixXd& log_p, const Eigen::MatrixXd& log_q);

}  // namespace bess
