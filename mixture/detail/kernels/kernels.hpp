#pragma once

#include <cstddef>

/// Plain numbers and pointers that EM's host code passes to its vector kernels. Kernels are compiled once per
/// instruction set, so this file must not use classes with inline code.
namespace modebank {

/// Points per block. A block is long enough to make call overhead negligible, and with 12 components short enough to
/// stay in the L1 cache.
inline constexpr std::ptrdiff_t block_size = 128;

namespace em {

using Index = std::ptrdiff_t;

/// The largest number of doubles in a vector of any instruction set.
inline constexpr Index most_lanes = 8;

/// One block of points in columns of block_size entries, aligned to 64 bytes. Padding points are finite and have weight
/// zero.
struct Block {
  const double* points = nullptr;   ///< F columns
  const double* weights = nullptr;  ///< one column
  const double* errors = nullptr;   ///< F (F + 1) / 2 columns, lower triangles by rows; null without errors
  const double* noise = nullptr;    ///< one column, log of weight times density of the noise component; null without a
                                    ///< noise component
};

/// A mixture in the layout of the kernels: log w_k N(x; mu_k, Sigma_k) = log_constant_k - |W_k (x - mu_k)|^2 / 2. W_k
/// is the inverse of the lower Cholesky factor of Sigma_k. For a point with error covariance S the covariance is
/// Sigma_k + S = W_k^-1 (I + W_k S W_k') W_k^-T.
struct Components {
  int features = 0;
  int count = 0;
  bool diagonal = false;  ///< whether all Sigma_k are diagonal
  const double* means = nullptr;
  const double* whitening = nullptr;  ///< `stride` doubles per component, in the kernel's Packing
  Index stride = 0;
  const double* log_constants = nullptr;
  /// One flag per component: whether the component is central. The origin is then so near the mean (in standard
  /// deviations) that squares about the origin lose little to rounding.
  const bool* central = nullptr;
};

/// Layout of W in memory. `diagonal`: its diagonal. `affine`: A = W sqrt(log2(e) / 2), as its lower triangle by rows or
/// its diagonal, then -A mu. `whole`: all F x F entries, column by column. `tiles`: four rows at a time, column by
/// column, padded with zeros.
enum class Packing { diagonal, affine, whole, tiles };

/// Working memory of one thread, aligned to 64 bytes.
struct Scratch {
  double* relative = nullptr;     ///< block_size x K, and one more column for noise: w_k N_k(x), divided by its largest
                                  ///< value over k
  double* sum = nullptr;          ///< block_size: sum of `relative` over the components, at least one
  double* log_density = nullptr;  ///< block_size; at least about -1e300, never NaN
  double* lanes = nullptr;        ///< sums per lane: log-likelihood, noise, then `entries` for each component
  double* work = nullptr;
};

/// Kernels for one number of features. Each component has `entries` sums: r, r d (F entries), r d d' (lower triangle by
/// rows, or its diagonal). r is the weighted responsibility and d the offset x - mu_k.
/// With errors, d is W_k times the expected offset of the error-free point, and d d' is the expectation of that product
/// minus I. At zero error this is W_k' applied to the plain entries (density.cpp).
/// Kernels of Packing::affine sum x in place of d for central components.
struct Kernels {
  Packing packing = Packing::affine;
  Index entries = 0;
  Index work = 0;                                                                 ///< doubles of Scratch::work
  void (*evaluate)(const Components&, const Block&, const Scratch&) = nullptr;    ///< fills relative, sum and
                                                                                  ///< log_density
  void (*measure)(const Components&, const Block&, const Scratch&) = nullptr;     ///< like `evaluate`; also adds to the
                                                                                  ///< first two lane sums
  void (*accumulate)(const Components&, const Block&, const Scratch&) = nullptr;  ///< like `evaluate`; also adds to all
                                                                                  ///< lane sums
};

Kernels plain_kernels(int features, bool diagonal);
/// Kernels for points with errors. They are plain C++, compiled once for all instruction sets (points_with_errors.cpp).
Kernels error_kernels(int features, bool diagonal);

/// Number of doubles per vector in the kernels that this machine uses.
Index lanes();
/// Sums the lanes of `count` entries, in lane order.
void reduce_lanes(const double* lanes, Index count, double* sums);

}  // namespace em
}  // namespace modebank
