#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "filter/bank.hpp"
#include "ident/local_model.hpp"
#include "ident/trajectory.hpp"
#include "mixture/select.hpp"

namespace modebank {

/// Forms in which the archive stores values whose structs are shaped otherwise. Each `store_` has a `restore_` that
/// gives back the same bits. Arrays hold one window or mode per column; matrices within a column are row-major.
/// store_ throws std::invalid_argument for sizes that disagree, restore_ DataError for content that cannot be.

struct StoredChannels {
  std::vector<std::string> names;
  std::vector<std::string> units;
};
StoredChannels store_channels(const std::vector<Channel>& channels);
std::vector<Channel> restore_channels(const StoredChannels& stored);

/// Windows by the name of their run.
struct StoredWindows {
  std::vector<std::string> run;                          ///< M
  Eigen::Matrix<std::int64_t, Eigen::Dynamic, 1> start;  ///< M
};
StoredWindows store_windows(const std::vector<Window>& windows, const std::vector<Trajectory>& runs);
/// Every window must lie within its run.
std::vector<Window> restore_windows(const StoredWindows& stored, const std::vector<Trajectory>& runs, Index length);

/// Names and units of a motion model's parameters; where a search starts is not kept.
StoredChannels store_model_parameters(const std::vector<ModelParameter>& parameters);
std::vector<ModelParameter> restore_model_parameters(const StoredChannels& stored);

/// The structure with the states that its dimension n says. Throws DataError when p parameters do not fit.
LinearStructure restore_structure(LinearStructure stored, Index dimension, Index parameters);
/// The same for windows, whose arrays have one entry per measured state; p is that of the motion model if there is one.
void restore_window_structure(WindowFits& fits, Index states, Index parameters);

/// The components' covariances, F*F x K.
Eigen::MatrixXd store_covariances(const std::vector<Eigen::MatrixXd>& covariances);
std::vector<Eigen::MatrixXd> restore_covariances(const Eigen::MatrixXd& stored, Index features);

/// A bank's modes side by side (K columns) and its matrices so that their memory is row-major.
struct StoredBank {
  std::string model;
  LinearStructure structure;
  Eigen::MatrixXd motion_parameters;          ///< p_motion x K, empty for linear models
  Eigen::MatrixXd motion_standard_error;      ///< p_motion x K
  Eigen::VectorXd weight;                     ///< K
  Eigen::MatrixXd c;                          ///< n x K
  Eigen::MatrixXd A;                          ///< n*n x K
  Eigen::MatrixXd B;                          ///< n*m x K
  Eigen::MatrixXd Q;                          ///< n*n x K
  Eigen::MatrixXd parameters;                 ///< p x K
  Eigen::MatrixXd spread;                     ///< p*p x K, empty without
  Eigen::MatrixXd standard_error;             ///< p x K, empty without
  Eigen::MatrixXd Q_standard_error;           ///< n*n x K, empty without
  Eigen::MatrixXd R_standard_error;           ///< transposed, empty without
  Eigen::MatrixXd transition_standard_error;  ///< transposed, empty without
  Eigen::MatrixXd C;                          ///< transposed
  Eigen::MatrixXd R;                          ///< transposed
  Eigen::MatrixXd transition;                 ///< transposed
  Eigen::VectorXd initial_probability;
};
StoredBank store_bank(const Bank& bank);
/// Fills what StoredBank holds and leaves names, dt_s and the screened modes as they are.
Bank restore_bank(const StoredBank& stored, Bank named);

}  // namespace modebank
