#include "mixture/merge_components.hpp"

#include <Eigen/Cholesky>
#include <limits>
#include <stdexcept>
#include <string>

namespace modebank {
namespace {

using Eigen::Index;

double log_determinant(const Eigen::MatrixXd& positive_definite) {
  return 2.0 * positive_definite.llt().matrixLLT().diagonal().array().log().sum();
}

/// Covariance of two components taken together.
Eigen::MatrixXd merged_covariance(const GaussianMixture& m, Index i, Index j) {
  const double share = m.weights(i) / (m.weights(i) + m.weights(j));
  const Eigen::VectorXd apart = m.means.col(i) - m.means.col(j);
  Eigen::MatrixXd merged =
      share * m.covariances[i] + (1.0 - share) * m.covariances[j] + share * (1.0 - share) * apart * apart.transpose();
  if (m.type == CovarianceType::diagonal) merged = Eigen::MatrixXd(merged.diagonal().asDiagonal());
  return merged;
}

double cost(const GaussianMixture& m, Index i, Index j) {
  return 0.5 * ((m.weights(i) + m.weights(j)) * log_determinant(merged_covariance(m, i, j)) -
                m.weights(i) * log_determinant(m.covariances[i]) - m.weights(j) * log_determinant(m.covariances[j]));
}

/// Column or row `drop` gone, the later ones moved up.
template <class Matrix>
void drop_column(Matrix& matrix, Index drop) {
  const Index rest = matrix.cols() - drop - 1;
  matrix.middleCols(drop, rest) = matrix.rightCols(rest).eval();
  matrix.conservativeResize(Eigen::NoChange, matrix.cols() - 1);
}

void merge(MixtureResult& result, Index i, Index j) {
  GaussianMixture& m = result.mixture;
  m.covariances[i] = merged_covariance(m, i, j);
  m.means.col(i) = (m.weights(i) * m.means.col(i) + m.weights(j) * m.means.col(j)) / (m.weights(i) + m.weights(j));
  m.weights(i) += m.weights(j);
  result.responsibilities.row(i) += result.responsibilities.row(j);

  m.covariances.erase(m.covariances.begin() + j);
  drop_column(m.means, j);
  Eigen::RowVectorXd weights = m.weights.transpose();
  drop_column(weights, j);
  m.weights = weights.transpose();
  Eigen::MatrixXd by_window = result.responsibilities.transpose();
  drop_column(by_window, j);
  result.responsibilities = by_window.transpose();
  for (int& label : result.labels)
    if (label == j)
      label = static_cast<int>(i);
    else if (label > j)
      --label;
}

}  // namespace

MixtureResult merge_components(MixtureResult result, Index most) {
  if (most < 1) throw std::invalid_argument("a mixture cannot be merged into " + std::to_string(most) + " components");
  while (result.mixture.components() > most) {
    Index first = 0, second = 1;
    double least = std::numeric_limits<double>::infinity();
    for (Index i = 0; i < result.mixture.components(); ++i)
      for (Index j = i + 1; j < result.mixture.components(); ++j)
        if (const double loss = cost(result.mixture, i, j); loss < least) {
          least = loss;
          first = i;
          second = j;
        }
    merge(result, first, second);
  }
  return result;
}

}  // namespace modebank
