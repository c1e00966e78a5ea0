#pragma once

#include <Eigen/Core>
#include <stdexcept>
#include <string>
#include <vector>

#include "filter/step/bank.hpp"

namespace modebank {

/// Forms in which the archive stores structs whose own form is different. For each `store_` function there is a
/// `restore_` function that returns the same bits. Arrays have one window or mode per column; matrices within a column
/// are row-major. `store_` throws std::invalid_argument if sizes disagree. `restore_` throws DataError if content is
/// invalid.

/// Puts the modes' matrices into the columns of a (rows * cols) x count array. `what`: name of the matrices in
/// messages.
template <class Get>
Eigen::MatrixXd side_by_side(std::size_t count, Eigen::Index rows, Eigen::Index cols, const char* what, Get get) {
  Eigen::MatrixXd result(rows * cols, static_cast<Eigen::Index>(count));
  for (std::size_t k = 0; k < count; ++k) {
    const auto& matrix = get(k);
    if (matrix.rows() != rows || matrix.cols() != cols)
      throw std::invalid_argument(std::string(what) + " of mode " + std::to_string(k) + " is " +
                                  std::to_string(matrix.rows()) + " x " + std::to_string(matrix.cols()) + ", must be " +
                                  std::to_string(rows) + " x " + std::to_string(cols));
    result.col(static_cast<Eigen::Index>(k)) = matrix.template reshaped<Eigen::RowMajor>();
  }
  return result;
}
/// Matrix k from the columns that side_by_side returns.
Eigen::MatrixXd one_of(const Eigen::MatrixXd& columns, Eigen::Index k, Eigen::Index rows, Eigen::Index cols);

struct StoredChannels {
  std::vector<std::string> names;
  std::vector<std::string> units;
  std::vector<std::string> averaged = {};  ///< for recorded channels: names of the averaged channels
};

/// Names and units of a motion model's parameters. Start values of searches are not stored.
StoredChannels store_model_parameters(const std::vector<ModelParameter>& parameters);
std::vector<ModelParameter> restore_model_parameters(const StoredChannels& stored);

/// Throws DataError if there are names, but not one for each column.
void check_count(const std::string& what, const std::vector<std::string>& names, Eigen::Index named);

/// Completes a structure with its number of states, which follows from the dimension n. Throws DataError if p
/// parameters do not fit this structure.
LinearStructure restore_structure(LinearStructure stored, Eigen::Index dimension, Eigen::Index parameters);

/// Both functions throw DataError if lags do not fit the number of states, or if the number of parameters is wrong.
void check_lags(const LinearStructure& structure, Eigen::Index dimension);
[[noreturn]] void parameters_do_not_fit(Eigen::Index parameters, Eigen::Index states);

/// The K modes of a bank, one per column. Matrices are transposed, so their memory is row-major.
struct StoredBank {
  std::string model;
  LinearStructure structure;
  Eigen::MatrixXd motion_parameters;                                         ///< p_motion x K; empty for linear models
  Eigen::MatrixXd motion_standard_error;                                     ///< p_motion x K
  Eigen::VectorXd weight;                                                    ///< K
  Eigen::MatrixXd c;                                                         ///< n x K
  Eigen::MatrixXd A;                                                         ///< n*n x K
  Eigen::MatrixXd B;                                                         ///< n*m x K
  Eigen::MatrixXd Q;                                                         ///< n*n x K
  Eigen::MatrixXd parameters;                                                ///< p x K
  Eigen::MatrixXd parameter_covariance;                                      ///< p*p x K; may be empty
  Eigen::MatrixXd standard_error;                                            ///< p x K; may be empty
  Eigen::MatrixXd Q_standard_error;                                          ///< n*n x K; may be empty
  Eigen::MatrixXd steady_gain, response_time_s, settling_time_s, overshoot;  ///< n_y*inputs x K; may be empty
  Eigen::MatrixXd steady_gain_error, response_time_error_s, settling_time_error_s, overshoot_error;  ///< the same
  Eigen::MatrixXd largest_pole, largest_pole_error, never_settles;                                   ///< the same
  Eigen::MatrixXd R_standard_error, transition_standard_error;  ///< transposed; may be empty
  Eigen::MatrixXd transition_weights;    ///< K*d x K; equal for every previous mode; may be empty
  Eigen::VectorXd transition_reference;  ///< d; may be empty
  Eigen::VectorXi motion;                ///< K; may be empty
  Eigen::MatrixXd C, R, transition;      ///< transposed
  Eigen::VectorXd quantum;               ///< n_y; may be empty
  Eigen::VectorXd initial_probability;
  // Nonlinear terms. All arrays are empty if the bank has no terms.
  std::vector<std::string> term_kinds;             ///< T
  Eigen::MatrixXd term_variables;                  ///< 3 x T positions; -1: no variable
  Eigen::VectorXd term_knots;                      ///< T
  Eigen::MatrixXd term_directions;                 ///< q x V
  Eigen::VectorXd term_low, term_high, term_unit;  ///< V
  Eigen::MatrixXd bend, bend_standard_error;       ///< n_y*T x K
};
StoredBank store_bank(const Bank& bank);
/// Reads or writes the members of StoredBank, except names, `dt_s` and screened modes.
Bank restore_bank(const StoredBank& stored, Bank named);

/// The arrays of /drifting, a bank of one mode with running noise. Other banks have other arrays.
struct StoredDrifting {
  LinearStructure structure;
  Eigen::VectorXd parameters;       ///< p
  Eigen::VectorXd scale;            ///< r
  Eigen::VectorXd variance;         ///< n_y
  Eigen::VectorXd horizon, factor;  ///< H
  Eigen::MatrixXd level;            ///< J x n_y, transposed
  Eigen::MatrixXd switching;        ///< J x J, transposed
};
StoredDrifting store_drifting(const Bank& bank);
/// Reads or writes the members of StoredDrifting. Throws DataError if sizes disagree.
Bank restore_drifting(const StoredDrifting& stored, const Bank& rest);

}  // namespace modebank
