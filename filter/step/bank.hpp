#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "filter/step/drift_rates.hpp"
#include "filter/step/noise_factor.hpp"
#include "filter/step/running_noise.hpp"
#include "filter/step/transition_logit.hpp"
#include "ident/model/linear_model.hpp"
#include "ident/model/motion_model.hpp"
#include "ident/model/terms.hpp"
#include "modebank/filter/screened_mode.hpp"

namespace modebank {

/// Row-stochastic mode transition matrix, T(i, j) = P(mode j next | mode i now). A type of its own, so that it can
/// never be handed over where mixing weights (columns sum to one) are meant. Checked once, at construction.
class TransitionMatrix {
 public:
  TransitionMatrix() : matrix_(Eigen::MatrixXd::Identity(1, 1)) {}
  /// Throws std::invalid_argument unless square with nonnegative rows that each sum to one within 1e-9 (rows are then
  /// normalised, unless they are already up to rounding: making one from its own matrix() keeps every bit).
  explicit TransitionMatrix(Eigen::MatrixXd row_stochastic);
  /// `stay` on the diagonal, the rest spread equally; K = 1 gives 1.
  static TransitionMatrix sticky(Eigen::Index modes, double stay);

  const Eigen::MatrixXd& matrix() const { return matrix_; }
  Eigen::Index modes() const { return matrix_.rows(); }

 private:
  Eigen::MatrixXd matrix_;
};

/// One mode of motion, in state space (with lags z and v of LinearStructure take the places of x and u): x[k+1] = x + A
/// x + B u + c + w, w ~ N(0, Q).
struct Mode {
  LinearModel model;               ///< A (n x n), B (n x m), c (n)
  Eigen::MatrixXd Q;               ///< n x n process noise covariance per step
  Eigen::MatrixXd spread;          ///< p x p covariance of theta over the windows of the mode
  Eigen::VectorXd standard_error;  ///< p, of theta itself
  double weight = 1.0;             ///< share of the windows
  /// Of banks of a motion model: its parameters and their standard errors; what stands above is then its linearisation.
  Eigen::VectorXd motion_theta = {};
  Eigen::VectorXd motion_standard_error = {};
  Eigen::MatrixXd Q_standard_error = {};  ///< n x n; of refined banks, empty otherwise
  /// Coefficients of the terms, measured states x T, empty without terms: their product with the terms is added to
  /// x[k+1].
  Eigen::MatrixXd bend = {};
  Eigen::MatrixXd bend_standard_error = {};  ///< in the same order; empty without terms
};

/// How fast the scale of the noise follows a run (filter/step/equations/noise_scale.hpp).
struct NoiseAdaptation {
  double forgetting = 0.98;  ///< per sample, in (0, 1]: 1 / (1 - forgetting) samples are remembered; 1: all of the run
  double prior_samples = 5;  ///< how many samples at scale one a run's start is worth, > 0
};

/// K modes, how they follow each other, and how the state is measured: y = C x + v, v ~ N(0, R).
struct Bank {
  std::string model = "linear";  ///< linear, varx, or the name of a motion model
  LinearStructure structure;
  std::vector<Mode> modes;  ///< K >= 1
  Eigen::MatrixXd C;        ///< n_y x n
  Eigen::MatrixXd R;        ///< n_y x n_y
  /// n_y, of what the measured values are multiples [state unit]: a value says no more than which interval C x + v lies
  /// in (equations/interval.hpp); 0: continuous; empty: all of them are.
  Eigen::VectorXd quantum = {};
  TransitionMatrix transition;          ///< K x K
  TransitionLogit transition_logit;     ///< how state and input change it; empty: not at all
  Eigen::VectorXd initial_probability;  ///< K
  std::vector<std::string> state_names;
  std::vector<std::string> input_names;
  double dt_s = 0.0;  ///< median sample period of the training data
  std::vector<ScreenedMode> screened;
  Shrinking shrinking;                            ///< of the modes as they were learned
  std::vector<ModelParameter> motion_parameters;  ///< of a motion model; empty for linear ones
  NoiseAdaptation noise_adaptation;               ///< for filters whose noise is adaptive
  BankDrift drift;                                ///< how theta of each mode wanders in a run; empty: not at all
  MotionTerms terms = {};                         ///< what bends the modes' motion, the same for all; empty: nothing
  NoiseFactor noise_factor = {};                  ///< how state and input scale every Q; empty: not at all
  RunningNoise running_noise = {};                ///< of one mode that drifts, the competitor `drifting`; empty: Q
  Eigen::MatrixXd R_standard_error;               ///< n_y x n_y; empty unless R was estimated with the bank
  Eigen::MatrixXd transition_standard_error;      ///< K x K; of refined banks, empty otherwise
  Eigen::MatrixXd transition_weight_error;        ///< K x d standard errors of the logit's weights; empty: not known

  Eigen::Index mode_count() const { return static_cast<Eigen::Index>(modes.size()); }
  bool is_quantised() const { return (quantum.array() > 0.0).any(); }
  /// Variances of what a recorded value differs from C x by: R's, and of rounding that is uniform within the quantum.
  Eigen::MatrixXd recording_noise() const;
  /// n_s, variances of the first mode's process noise.
  auto noise_variance() { return modes.front().Q.diagonal().head(structure.states); }
  Eigen::VectorXd noise_variance() const { return modes.front().Q.diagonal().head(structure.states); }
  Eigen::VectorXd theta(Eigen::Index mode) const { return pack(structure, modes[mode].model); }
};

/// One mode whose states are measured exactly: C takes the newest sample, R = 0, Q = diag(variance) of the measured
/// states.
Bank one_mode_bank(const LinearStructure& structure, const Eigen::VectorXd& theta, const Eigen::VectorXd& variance);

/// Whether these are several modes of the very same theta, which differ in noise alone.
bool has_one_theta(const Bank& bank);

/// Throws std::invalid_argument naming the first thing that no filter can work with: a size that does not fit the
/// others, a number that is not finite, a variance below zero, probabilities that are none, a noise adaptation out of
/// its range.
void validate(const Bank& bank);
/// The sizes alone: what an optimiser's candidates have in common, however far out their numbers are.
void check_sizes(const Bank& bank);

/// Directions of the state that one measurement leaves open start with this multiple of the largest variance of Q and
/// R: wide against what the filter will learn, and close enough to it to keep the arithmetic sound.
inline constexpr double unobserved_variance_factor = 1e4;

/// How a filter starts from its first measurement: x[0] = gain y[0]. With lagged states it starts from the measurements
/// of all of z: gain I, and R for each sample. Quantised values start as uniform within their interval.
struct StartMoments {
  Eigen::MatrixXd gain;        ///< n x n_y, the pseudo-inverse C+; n x n with lagged states
  Eigen::MatrixXd covariance;  ///< n x n, C+ R C+' (+ wide variance where C sees nothing); R itself for C = I
};

StartMoments start_moments(const Bank& bank);

}  // namespace modebank
