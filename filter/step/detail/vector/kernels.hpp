#pragma once

#include <cstddef>

/// Between vector_imm.cpp and its kernels, which are compiled once per instruction set. Rows hold `stride` numbers, one
/// per mode, and begin at multiples of 64 bytes. Symmetric matrices are packed: entry (a, b), a >= b, is row
/// a (a + 1) / 2 + b. Places beyond the last mode hold zeros and are never reached.
namespace modebank::vector_imm {

struct ModeRows {
  std::size_t modes = 0, stride = 0, inputs = 0;
  // The bank.
  const double *F = nullptr, *B = nullptr, *c = nullptr, *Q = nullptr;  ///< n*n (row-major), n*inputs, n, packed n
  const double* transition = nullptr;                                   ///< a row per mode: from
  // The filter's state.
  double *mean = nullptr, *covariance = nullptr, *probability = nullptr;  ///< n, packed n, 1
  // Prepared from it for the next step's mixing.
  double share = 0.0;        ///< 1 / modes
  double* center = nullptr;  ///< n numbers, the mean of the means: what the mixing takes moments about
  double* parts = nullptr;   ///< n + packed n: what mixtures are sums of
  // What a step leaves behind.
  double* predicted_probability = nullptr;                            ///< 1
  double *predicted_mean = nullptr, *predicted_covariance = nullptr;  ///< n, packed n
  double *expected = nullptr, *innovation_covariance = nullptr;       ///< n_y: C x; packed n_y: S
  double *L = nullptr, *D = nullptr, *D_inverse = nullptr;            ///< packed n_y; n_y: S = L D L'
  double* decorrelated = nullptr;                                     ///< n_y: L^-1 (y - C x)
  double *exponent = nullptr, *weight = nullptr;  ///< 1: -e' S^-1 e / (2 log 2); unnormalised posterior
  /// Of quantised measurements alone: SignalLikelihood's numbers, n_y rows of each, of every signal given those before
  /// it, of which decorrelated and D then have the innovation and its variance.
  double* signal = nullptr;
};

inline constexpr std::size_t signal_numbers = 5;

/// C (n_y x n) and R (n_y x n_y), row-major, and how many of the n_y signals are there. `quantum`: n_y, zero of a
/// continuous signal (interval.hpp); null: all are.
struct Sensor {
  const double *C = nullptr, *R = nullptr;
  double signals = 0.0;
  const double* quantum = nullptr;
};

/// What an update finds.
struct UpdateResult {
  double log_density = 0.0;          ///< of n_y signals
  double share = 0.0, square = 0.0;  ///< sums of adapt_noise_scale (noise_scale.hpp), if asked for
};

struct CombinedMoments {
  double *mean, *covariance;  ///< n, packed n
};

struct CombinedExpectation {
  double *state, *innovation_covariance;  ///< n, packed n_y
  double spread = 0.0;                    ///< sum_j c_j |C x_j - C x|^2
};

/// Samples of which nothing is missing, each one step after the one before.
struct Stretch {
  const double *inputs = nullptr, *measurements = nullptr;  ///< acting inputs and n_y numbers per sample
  std::size_t samples = 0;
  double* log_density = nullptr;  ///< a number per sample: the result
};

/// The steps of one pair of sizes.
struct Kernels {
  /// After mean, covariance and probability were set: everything that the next prediction reads beside them.
  void (*prepare)(const ModeRows&) = nullptr;
  /// Mixing, prediction and what the sensor will say: all from predicted_probability to D_inverse. `v`: inputs.
  void (*predict)(const ModeRows&, const Sensor&, const double* v, double noise_scale) = nullptr;
  /// C x, S and its factor anew, of another sensor.
  void (*expect)(const ModeRows&, const Sensor&) = nullptr;
  /// The state after y; with noise_scale > 0 also share and square.
  UpdateResult (*update)(const ModeRows&, const Sensor&, const double* y, double noise_scale) = nullptr;
  /// predict and update through a stretch, at noise scale one; of what steps leave behind, only the state is there.
  void (*follow)(const ModeRows&, const Sensor&, const Stretch&) = nullptr;
  /// A prediction without a measurement is the state.
  void (*skip)(const ModeRows&) = nullptr;
  void (*merge)(const ModeRows&, CombinedMoments) = nullptr;
  void (*combine)(const ModeRows&, const Sensor&, CombinedExpectation&) = nullptr;
  /// The probability integral transform of the y that update took in: n_y.
  void (*transform)(const ModeRows&, const double* y, double* pit) = nullptr;
};

/// Null entries where there are no kernels for these sizes.
Kernels kernels(std::size_t states, std::size_t measurements);

/// Rows are padded to multiples of this, enough for any instruction set.
inline constexpr std::size_t row_multiple = 8;

}  // namespace modebank::vector_imm
