#include "app/report/page/folded_transition.hpp"

#include <algorithm>

namespace modebank {

Eigen::MatrixXd folded_transition(const Eigen::MatrixXd& transition, const std::vector<Eigen::Index>& told,
                                  const Eigen::VectorXd& use) {
  const auto shown = static_cast<Eigen::Index>(told.size()), K = transition.rows();
  const Eigen::Index groups = shown < K ? shown + 1 : shown;
  // into: K x groups, which modes make up each group; share: of its use within the group.
  Eigen::MatrixXd into = Eigen::MatrixXd::Zero(K, groups);
  for (Eigen::Index k = 0; k < K; ++k) {
    const auto place = std::find(told.begin(), told.end(), k) - told.begin();
    into(k, place) = 1.0;
  }
  Eigen::MatrixXd share = into;
  for (Eigen::Index g = 0; g < groups; ++g) {
    const double total = into.col(g).dot(use);
    share.col(g) = total > 0.0 ? Eigen::VectorXd(into.col(g).cwiseProduct(use) / total)
                               : Eigen::VectorXd(into.col(g) / into.col(g).sum());
  }
  return share.transpose() * transition * into;
}

}  // namespace modebank
