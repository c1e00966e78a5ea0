#include "mixture/merge_components.hpp"

#include <stdexcept>
#include <string>
#include <utility>

#include "mixture/component_merge.hpp"

namespace modebank {
namespace {

using Eigen::Index;

/// Column or row `drop` gone, the later ones moved up.
template <class Matrix>
void drop_column(Matrix& matrix, Index drop) {
  const Index rest = matrix.cols() - drop - 1;
  matrix.middleCols(drop, rest) = matrix.rightCols(rest).eval();
  matrix.conservativeResize(Eigen::NoChange, matrix.cols() - 1);
}

void merge(MixtureResult& result, Index i, Index j) {
  GaussianMixture& m = result.mixture;
  put(merged(m, i, j), i, m);
  m.covariances.erase(m.covariances.begin() + j);
  drop_column(m.means, j);
  Eigen::RowVectorXd weights = m.weights.transpose();
  drop_column(weights, j);
  m.weights = weights.transpose();
  result.responsibilities = std::move(result.responsibilities).merged(i, j);
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
    const Merge closest = merges_by_loss(result.mixture).front();
    merge(result, closest.first, closest.second);
  }
  return result;
}

}  // namespace modebank
