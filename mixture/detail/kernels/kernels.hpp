#pragma once

#include <cstddef>

/// What passes between EM's host code and its vector kernels: plain numbers and pointers, since a kernel is compiled
/// once per instruction set.
namespace modebank {

/// Points per block: long enough to hide call overhead, short enough that a block of 12 components stays in L1.
inline constexpr std::ptrdiff_t block_size = 128;

namespace em {

using Index = std::ptrdiff_t;

/// Most lanes of doubles that any instruction set has.
inline constexpr Index most_lanes = 8;

/// One block of points; columns of block_size entries, aligned to 64 bytes. Filling points are finite, of weight zero.
struct Block {
  const double* points = nullptr;   ///< F columns
  const double* weights = nullptr;  ///< one column
  const double* errors = nullptr;   ///< F (F + 1) / 2 columns, lower triangles by rows; null: no errors
  const double* noise = nullptr;    ///< one column, log of weight times density of the noise component; null: none
};

/// A mixture as kernels read it: log w_k N(x; mu_k, Sigma_k) = log_constant_k - |W_k (x - mu_k)|^2 / 2, where W_k is
/// the inverse of the lower Cholesky factor of Sigma_k. With an error S the covariance is Sigma_k + S, which is W_k^-1
/// (I + W_k S W_k') W_k^-T.
struct Components {
  int features = 0;
  int count = 0;
  bool diagonal = false;  ///< Sigma_k are diagonal
  const double* means = nullptr;
  const double* whitening = nullptr;  ///< `stride` doubles per component, in the kernel's Packing
  Index stride = 0;
  const double* log_constants = nullptr;
  /// The origin is so near, in standard deviations, that squares about it lose little to rounding.
  const bool* central = nullptr;
};

/// How a kernel wants W: its diagonal; A = W sqrt(log2(e) / 2), its lower triangle by rows or its diagonal, then -A mu;
/// all F x F entries, column by column; or four rows at a time, column by column, padded with zeros.
enum class Packing { diagonal, affine, whole, tiles };

/// Memory of one thread, aligned to 64 bytes.
struct Scratch {
  double* relative = nullptr;  ///< block_size x (K, and one more for noise): w_k N_k(x) over the largest of the point
  double* sum = nullptr;       ///< block_size, of `relative` over the components: at least one
  double* log_density = nullptr;  ///< block_size; at least about -1e300, never NaN
  double* lanes = nullptr;        ///< sums per lane: log-likelihood, noise, then `entries` per component
  double* work = nullptr;
};

/// One number of features' kernels. `entries` per component: sum of r, of r d (F), of r d d' (lower triangle by rows,
/// or the diagonal of it), where r is the weighted responsibility and d the offset x - mu_k. With errors d is W_k times
/// the expected offset of the point without its error, and d d' the expectation of that product less I (which leaves
/// W_k' of the plain entries where the error is zero; see density.cpp). Kernels of Packing::affine sum x in
/// place of d for components that are central.
struct Kernels {
  Packing packing = Packing::affine;
  Index entries = 0;
  Index work = 0;                                                                 ///< doubles of Scratch::work
  void (*evaluate)(const Components&, const Block&, const Scratch&) = nullptr;    ///< relative, sum, log_density
  void (*measure)(const Components&, const Block&, const Scratch&) = nullptr;     ///< and adds to the first two lanes
  void (*accumulate)(const Components&, const Block&, const Scratch&) = nullptr;  ///< and to all
};

Kernels plain_kernels(int features, bool diagonal);
/// These serve points with errors; they are plain text, not compiled once per instruction set (points_with_errors.cpp).
Kernels error_kernels(int features, bool diagonal);

/// Lanes of doubles of this machine's kernels.
Index lanes();
/// Sums the lanes of `count` entries, in lane order.
void reduce_lanes(const double* lanes, Index count, double* sums);
/// exp and log of `count` values (a multiple of 8; aligned) in place, as the kernels compute them: exp to 1e-15
/// relative on
/// [-690, 0], smaller values count as -690; log to 1e-15 on [1, 1e300].
void exp_in_place(double* values, Index count);
void log_in_place(double* values, Index count);

}  // namespace em
}  // namespace modebank
