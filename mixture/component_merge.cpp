#include "mixture/component_merge.hpp"

#include <Eigen/Cholesky>
#include <algorithm>

namespace modebank {

using Eigen::Index;

double log_determinant(const Eigen::MatrixXd& covariance) {
  return 2.0 * Eigen::LLT<Eigen::MatrixXd>(covariance).matrixLLT().diagonal().array().log().sum();
}

Component component_of(const GaussianMixture& mixture, Index k) {
  return {mixture.weights(k), mixture.means.col(k), mixture.covariances[static_cast<std::size_t>(k)]};
}

void put(const Component& component, Index k, GaussianMixture& mixture) {
  mixture.weights(k) = component.weight;
  mixture.means.col(k) = component.mean;
  mixture.covariances[static_cast<std::size_t>(k)] = component.covariance;
}

Component merged(const GaussianMixture& mixture, Index i, Index j) {
  const Component a = component_of(mixture, i), b = component_of(mixture, j);
  const double weight = a.weight + b.weight, share = weight > 0.0 ? b.weight / weight : 0.5;
  const Eigen::VectorXd gap = b.mean - a.mean;
  Component result{weight, a.mean + share * gap,
                   (1.0 - share) * a.covariance + share * b.covariance + share * (1.0 - share) * gap * gap.transpose()};
  if (mixture.type == CovarianceType::diagonal) {
    const Eigen::VectorXd variances = result.covariance.diagonal();
    result.covariance = variances.asDiagonal();
  }
  return result;
}

double merge_loss(const GaussianMixture& mixture, Index i, Index j, double log_determinant_i,
                  double log_determinant_j) {
  const Component both = merged(mixture, i, j);
  return 0.5 * (both.weight * log_determinant(both.covariance) - mixture.weights(i) * log_determinant_i -
                mixture.weights(j) * log_determinant_j);
}

std::vector<Merge> merges_by_loss(const GaussianMixture& mixture) {
  std::vector<double> log_determinants;
  for (const Eigen::MatrixXd& covariance : mixture.covariances) log_determinants.push_back(log_determinant(covariance));
  std::vector<Merge> merges;
  for (Index i = 0; i < mixture.components(); ++i)
    for (Index j = i + 1; j < mixture.components(); ++j)
      merges.push_back({i, j,
                        merge_loss(mixture, i, j, log_determinants[static_cast<std::size_t>(i)],
                                   log_determinants[static_cast<std::size_t>(j)])});
  std::stable_sort(merges.begin(), merges.end(), [](const Merge& a, const Merge& b) { return a.loss < b.loss; });
  return merges;
}

}  // namespace modebank
