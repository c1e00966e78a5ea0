#pragma once

#include <cstddef>

/// Interface between vector_imm.cpp and its kernels, which are compiled once per instruction set. Rows hold `stride`
/// numbers, one per mode, and begin at multiples of 64 bytes. Symmetric matrices are packed: entry (a, b), a >= b, is
/// row a (a + 1) / 2 + b. Entries beyond the last mode are zero; no mode can switch to one of them.
namespace modebank::vector_imm {

struct ModeRows {
  std::size_t modes = 0, stride = 0, inputs = 0;
  // The bank.
  const double *F = nullptr, *B = nullptr, *c = nullptr, *Q = nullptr;  ///< number of rows: n*n (row-major), n*inputs,
                                                                        ///< n, packed n
  const double* transition = nullptr;                                   ///< one row per previous mode

  // The filter's state.
  double *mean = nullptr, *covariance = nullptr, *probability = nullptr;  ///< number of rows: n, packed n, 1

  // Numbers derived from the state, for mixing in the next step.
  double share = 0.0;        ///< 1 / modes
  double* center = nullptr;  ///< n numbers, the mean of the modes' means; moments for mixing are computed about it
  double* parts = nullptr;   ///< number of rows: n + packed n; summands of the mixtures

  // Results of a step.
  double* predicted_probability = nullptr;                            ///< 1
  double *predicted_mean = nullptr, *predicted_covariance = nullptr;  ///< number of rows: n, packed n
  double *expected = nullptr, *innovation_covariance = nullptr;       ///< n_y rows: C x; packed n_y rows: S
  double *L = nullptr, *D = nullptr, *D_inverse = nullptr;            ///< number of rows: packed n_y, n_y, n_y; S = L D
                                                                      ///< L'
  double* decorrelated = nullptr;                                     ///< n_y rows: L^-1 (y - C x)
  double *exponent = nullptr, *weight = nullptr;  ///< exponent of each mode, -e' S^-1 e / (2 log 2), one row; posterior
                                                  ///< before normalisation, one row

  /// Only for quantised measurements. Holds the numbers of SignalLikelihood for every signal given the previous
  /// signals, n_y rows per number. `decorrelated` and `D` then hold the innovation and its variance given the previous
  /// signals.
  double* signal = nullptr;
};

inline constexpr std::size_t signal_numbers = 5;

/// C (n_y x n) and R (n_y x n_y), row-major, and the number of available signals. `quantum`: n_y, zero for a continuous
/// signal (interval.hpp). Null if all are continuous.
struct Sensor {
  const double *C = nullptr, *R = nullptr;
  double signals = 0.0;
  const double* quantum = nullptr;
};

/// Result of an update.
struct UpdateResult {
  double log_density = 0.0;          ///< log density of n_y signals
  double share = 0.0, square = 0.0;  ///< sums for adapt_noise_scale (noise_scale.hpp), if requested
};

struct CombinedMoments {
  double *mean, *covariance;  ///< number of entries: n, packed n
};

struct CombinedExpectation {
  double *state, *innovation_covariance;  ///< number of entries: n, packed n_y
};

/// Complete samples; each is one step after the previous one.
struct CompleteSamples {
  const double *inputs = nullptr, *measurements = nullptr;  ///< acting inputs and n_y measurements per sample
  std::size_t samples = 0;
  double* log_density = nullptr;  ///< result, one number per sample
};

/// The kernels for one pair of sizes.
struct Kernels {
  /// Call after setting mean, covariance and probability. Computes all other values that the next prediction reads.
  void (*prepare)(const ModeRows&) = nullptr;
  /// Computes everything from `predicted_probability` to `D_inverse`: mixing, prediction and predicted measurement.
  /// `v`: inputs.
  void (*predict)(const ModeRows&, const Sensor&, const double* v, double noise_scale) = nullptr;
  /// Recomputes C x, S and its factor for another sensor.
  void (*expect)(const ModeRows&, const Sensor&) = nullptr;
  /// Computes the state after y. If noise_scale > 0, also computes `share` and `square`.
  UpdateResult (*update)(const ModeRows&, const Sensor&, const double* y, double noise_scale) = nullptr;
  /// Calls `predict` and `update` for a stretch of samples, with noise scale 1. Afterwards only the state is valid.
  void (*follow)(const ModeRows&, const Sensor&, const CompleteSamples&) = nullptr;
  /// For a sample without measurement: the prediction becomes the state.
  void (*skip)(const ModeRows&) = nullptr;
  void (*merge)(const ModeRows&, CombinedMoments) = nullptr;
  void (*combine)(const ModeRows&, const Sensor&, CombinedExpectation) = nullptr;
  /// The probability integral transform of the measurement y of the last update, n_y.
  void (*transform)(const ModeRows&, const double* y, double* pit) = nullptr;
};

/// Kernels for these sizes. Entries are null if no kernels exist for the sizes.
Kernels kernels(std::size_t states, std::size_t measurements);

/// Rows are padded to multiples of this number, which is enough for any instruction set.
inline constexpr std::size_t row_multiple = 8;

}  // namespace modebank::vector_imm
