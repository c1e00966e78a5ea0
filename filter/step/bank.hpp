#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "filter/transition_matrix.hpp"
#include "ident/model.hpp"
#include "ident/motion_model.hpp"

namespace modebank {

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
};

/// How fast the scale of the noise follows a run (filter/noise_scale.hpp).
struct NoiseAdaptation {
  double forgetting = 0.98;  ///< per sample, in (0, 1]: 1 / (1 - forgetting) samples are remembered; 1: all of the run
  double prior_samples = 5;  ///< how many samples at scale one a run's start is worth, > 0
};

/// A mode that was left out of the bank, and why.
struct ScreenedMode {
  Eigen::Index component = 0;  ///< position in the mixture
  double weight = 0.0;
  double spectral_radius = 0.0;
  std::string reason;
};

/// K modes, how they follow each other, and how the state is measured: y = C x + v, v ~ N(0, R).
struct Bank {
  std::string model = "linear";  ///< linear, varx, or the name of a motion model
  LinearStructure structure;
  std::vector<Mode> modes;              ///< K >= 1
  Eigen::MatrixXd C;                    ///< n_y x n
  Eigen::MatrixXd R;                    ///< n_y x n_y
  TransitionMatrix transition;          ///< K x K
  Eigen::VectorXd initial_probability;  ///< K
  std::vector<std::string> state_names;
  std::vector<std::string> input_names;
  double dt_s = 0.0;  ///< median sample period of the training data
  std::vector<ScreenedMode> screened;
  std::vector<ModelParameter> motion_parameters;  ///< of a motion model; empty for linear ones
  NoiseAdaptation noise_adaptation;               ///< for filters whose noise is adaptive
  Eigen::MatrixXd R_standard_error;               ///< n_y x n_y; empty unless R was estimated with the bank
  Eigen::MatrixXd transition_standard_error;      ///< K x K; of refined banks, empty otherwise

  Eigen::Index mode_count() const { return static_cast<Eigen::Index>(modes.size()); }
  Eigen::VectorXd theta(Eigen::Index mode) const { return pack(structure, modes[mode].model); }
};

/// Throws std::invalid_argument naming the first size that does not fit.
void check_sizes(const Bank& bank);

}  // namespace modebank
