#include "workstation/correction/policy_loss.h"

namespace bess {

Eigen::MatrixXd log_softmax(const Eigen::MatrixXd& logits) {
  Eigen::MatrixXd shifted = logits.rowwise() - logits.colwise().maxCoeff().eval();
  const Eigen::RowVectorXd log_sum = shifted.array().exp().colwise().sum().log();
  shifted.rowwise() -= log_sum;
  return shifted;
}

double kl_divergence(const Eigen::MatrixXd& log_p, const Eigen::MatrixXd& log_q) {
  return (log_p.array().exp() * (log_p - log_q).array()).sum();
}

Eigen::MatrixXd kl_gradient_first(const Eigen::MatrixXd& log_p, const Eigen::MatrixXd& log_q) {
  const Eigen::ArrayXXd p = log_p.array().exp();
  const Eigen::ArrayXXd difference = (log_p - log_q).array();
  const Eigen::RowVectorXd kl = (p * difference).colwise().sum();
  return p * (difference.rowwise() - kl.array());
}

Eigen::MatrixXd kl_gradient_second(const Eigen::MatrixXd& log_p, const Eigen::MatrixXd& log_q) {
  return log_q.array().exp() - log_p.array().exp();
}

}  // namespace bess
