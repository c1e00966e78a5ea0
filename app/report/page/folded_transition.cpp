#include "app/report/page/folded_transition.hpp"

namespace modebank {

Eigen::MatrixXd folded_transition(const Eigen::MatrixXd& transition,
                                  const std::vector<std::vector<Eigen::Index>>& groups, const Eigen::VectorXd& use) {
  const auto shown = static_cast<Eigen::Index>(groups.size()), K = transition.rows();
  // into: K x groups, 1 if the mode belongs to the group. The last column is for modes without a group. share: share of
  // the mode in the use of its group.
  Eigen::MatrixXd into = Eigen::MatrixXd::Zero(K, shown + 1);
  for (Eigen::Index g = 0; g < shown; ++g)
    for (const Eigen::Index k : groups[static_cast<std::size_t>(g)]) into(k, g) = 1.0;
  into.col(shown) = (1.0 - into.rowwise().sum().array()).matrix();
  if (into.col(shown).sum() == 0.0) into.conservativeResize(K, shown);
  Eigen::MatrixXd share = into;
  for (Eigen::Index g = 0; g < into.cols(); ++g) {
    const double total = into.col(g).dot(use);
    share.col(g) = total > 0.0 ? Eigen::VectorXd(into.col(g).cwiseProduct(use) / total)
                               : Eigen::VectorXd(into.col(g) / into.col(g).sum());
  }
  return share.transpose() * transition * into;
}

}  // namespace modebank
