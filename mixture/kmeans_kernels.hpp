#pragma once

#include "mixture/em_kernels.hpp"

/// Distances of k-means on blocks of points, vectorised like EM. Squared distances beyond 1e200 count as that.
namespace modebank::em {

struct KmeansKernels {
  /// out = min(nearest, squared distance to `center`) for a block's points, columns of block_size; returns the sum of
  /// weights times `out`. `out` may be `nearest`.
  double (*closer)(const Block&, int features, const double* center, const double* nearest, double* out);
  /// Index of every point's nearest centre (`features` x `count`, each centre together), the lower one on a tie.
  void (*nearest)(const Block&, int features, const double* centers, int count, int* labels);
};

KmeansKernels kmeans_kernels();

}  // namespace modebank::em
