#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <vector>

#include "ident/data/trajectory.hpp"

namespace modebank {

/// Lags of y[k] = sum A_j y[k-j] + sum b_ij u_i[k-d_i-j] + c + e[k] + sum C_j e[k-j]. j counts from 0 for inputs, from
/// 1 for states and noise. In differences, y and u are differences of successive samples, and c is absent.
struct ArmaxOrder {
  bool differences = false;
  Index state_lags = 1, input_lags = 1, noise_lags = 1;
  bool intercept = true;  ///< whether levels have the constant
  bool has_constant() const { return intercept && !differences; }
  bool operator==(const ArmaxOrder&) const = default;
};

/// A fit by prediction errors (Ljung 1999, section 7.2), started by Hannan & Rissanen (1982).
struct ArmaxFit {
  ArmaxOrder order;
  std::vector<Index> delays;   ///< m, of each input [samples]
  Eigen::MatrixXd theta;       ///< n x P: state lags (n columns each), input lags (m columns each), the constant
  Eigen::MatrixXd C;           ///< n columns for each lag
  Eigen::MatrixXd S;           ///< n x n, covariance of e
  Eigen::MatrixXd covariance;  ///< of the entries of [theta C], row by row
  Index rows = 0;              ///< number of samples predicted
};

struct ArmaxCandidate {
  ArmaxFit fit;
  Eigen::VectorXd left_out;  ///< log score of each part, predicted without the part's fold [nats]
  double lost = 0.0;         ///< score below the best candidate's, over all parts [nats]
  Index size = 0;            ///< number of entries of theta and C
};

/// One linear model of the training runs, with the evidence for its structure.
struct LinearStage {
  std::vector<ArmaxCandidate> candidates;  ///< empty where the data are too few or a state never moves
  std::size_t chosen = 0;
  Eigen::VectorXd rows;  ///< rows of each part that is left out
  bool by_runs = false;  ///< true: the parts are whole runs; false: stretches of runs

  const ArmaxFit& fit() const { return candidates[chosen].fit; }
};

/// A structure with the delay of each input.
struct ArmaxStructure {
  ArmaxOrder order;
  std::vector<Index> delays;  ///< m
  bool operator==(const ArmaxStructure&) const = default;
};

struct LinearStageOptions {
  std::optional<ArmaxStructure> only = {};  ///< the one candidate, if nothing is searched
  bool intercept = true;                    ///< whether levels have a constant
  std::vector<Index> least_delay = {};      ///< m, smallest delay of each input; empty: 1 for all
};

/// Finds each input's delay, by least squares and then by the likelihood of the chosen structure: the latest within 2
/// nats. Compares ARMAX and ARX structures in levels and in differences on the same rows of left-out runs, below four
/// runs on stretches, under Student's t. Chooses the fewest parameters within one standard error, 0.001 nats a row, or
/// 6 nats per state in all, whichever is largest. Lags do not reach across gaps or missing samples; the residuals
/// before a stretch are unknown. Outliers get Huber's weights. The result does not depend on the number of threads.
LinearStage find_linear_stage(const Recording& recording, const LinearStageOptions& options = {});

/// Variances of the measurement noise v and of the process noise w, n each.
struct ArmaxNoise {
  Eigen::VectorXd R, Q;
  Eigen::VectorXd R_error;  ///< standard errors, zero where R is stated
};

/// R and Q by non-negative least squares on the autocovariances of C(q) e = w + A(q) v. A stated R is held.
ArmaxNoise noises(const ArmaxFit& fit, const std::optional<Eigen::VectorXd>& stated_R = std::nullopt);

}  // namespace modebank
