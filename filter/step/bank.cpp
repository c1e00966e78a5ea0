#include "filter/step/bank.hpp"

#include <Eigen/QR>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "filter/step/noise_density.hpp"
#include "ident/base/covariance.hpp"

namespace modebank {

namespace {

using Eigen::Index;

constexpr double sum_tolerance = 1e-9;  // of probabilities
// Directions of the state that one measurement does not determine start with this multiple of the largest variance of Q
// and R: wide compared with what the filter will learn, and small enough for accurate arithmetic.
constexpr double unobserved_variance_factor = 1e4;

template <class Part>
void expect_size(const std::string& what, const Part& part, Index rows, Index cols) {
  if (part.rows() == rows && part.cols() == cols) return;
  throw std::invalid_argument(what + " is " + std::to_string(part.rows()) + " x " + std::to_string(part.cols()) +
                              ", must be " + std::to_string(rows) + " x " + std::to_string(cols));
}

void require(bool holds, const std::string& what) {
  if (!holds) throw std::invalid_argument("the bank's " + what);
}

void check_mode(const Mode& mode, const Bank& bank, const std::string& name) {
  const LinearStructure& s = bank.structure;
  const Index n = s.dimension(), p = s.parameters(), terms = bank.terms.count();
  expect_size(name + " A", mode.model.A, n, n);
  expect_size(name + " B", mode.model.B, n, s.acting_inputs());
  expect_size(name + " c", mode.model.c, n, 1);
  expect_size(name + " Q", mode.Q, n, n);
  expect_size(name + " bend", mode.bend, terms > 0 ? s.states : 0, terms);
  if (mode.parameter_covariance.size() > 0)
    expect_size(name + " parameter covariance", mode.parameter_covariance, p, p);
  if (mode.standard_error.size() > 0) expect_size(name + " standard error", mode.standard_error, p, 1);
}

/// Drift requires exactly measured states.
void check_drift(const Bank& bank) {
  if (bank.drift.empty()) return;
  const LinearStructure& s = bank.structure;
  const auto& [rates, scale, tuning] = bank.drift;
  expect_size("scale of the drift", scale, s.regressors(), 1);
  require(scale.allFinite() && scale.minCoeff() > 0.0, "drift needs a finite positive scale for each regressor");
  require(rates.q >= 0.0 && rates.p0 >= 0.0 && std::isfinite(rates.q + rates.p0),
          "drift q and p0 must be finite and at least 0");
  require(rates.leak > 0.0 && rates.leak <= 1.0, "drift leak must be above 0 and at most 1");
  require(bank.R.isZero(0.0), "drift needs exactly measured states: R must be 0");
  require(bank.C.isIdentity(0.0) && bank.C.rows() == s.states,
          "drift needs each state measured directly: C must be the identity");
}

void check_running_noise(const Bank& bank) {
  const RunningNoise& noise = bank.running_noise;
  require(bank.drift.empty() == noise.empty(), "running noise and drift need each other");
  if (noise.empty()) return;
  const auto positive = [](const auto& x) { return x.allFinite() && (x.array() > 0.0).all(); };
  expect_size("least variance of the running noise", noise.floor, bank.structure.states, 1);
  require(positive(noise.floor), "running noise needs a positive least variance of each state");
  require(bank.mode_count() == 1, "running noise needs exactly one mode");
  require(positive(bank.noise_variance()), "running noise needs a positive diagonal of Q");
  require(noise.lam >= 0.0 && noise.lam <= 1.0, "running noise needs lam in [0, 1]");
  for (const auto& [ahead, factor] : noise.horizon_factor)
    require(ahead > 1 && factor > 0.0 && std::isfinite(factor),
            "horizon factors must be finite and positive, for horizons of at least 2");
  StudentNoise{noise.nu};
  if (noise.level.size() == 0 && noise.switching.size() == 0) return;
  expect_size("noise levels", noise.level, bank.structure.states, noise.level.cols());
  expect_size("transition matrix of the noise levels", noise.switching, noise.level.cols(), noise.level.cols());
  require(positive(noise.level), "noise levels must be finite and positive");
  TransitionMatrix{noise.switching};
}

}  // namespace

TransitionMatrix::TransitionMatrix(Eigen::MatrixXd row_stochastic) : matrix_(std::move(row_stochastic)) {
  if (matrix_.rows() != matrix_.cols() || matrix_.rows() == 0)
    throw std::invalid_argument("transition matrix is " + std::to_string(matrix_.rows()) + " x " +
                                std::to_string(matrix_.cols()) + ", must be square and not empty");
  for (Index i = 0; i < matrix_.rows(); ++i) {
    const double sum = matrix_.row(i).sum(), least = matrix_.row(i).minCoeff();
    const std::string row = "row " + std::to_string(i) + " of the transition matrix ";
    if (!(std::abs(sum - 1.0) <= sum_tolerance))
      throw std::invalid_argument(row + "sums to " + std::to_string(sum) + ", must be 1");
    if (!(least >= 0.0)) throw std::invalid_argument(row + "holds the negative entry " + std::to_string(least));
    // A row that is already normalised stays bit-identical, so that a stored bank gives the original's results.
    const double rounding = 2.0 * std::numeric_limits<double>::epsilon() * static_cast<double>(matrix_.cols());
    if (std::abs(sum - 1.0) > rounding) matrix_.row(i) /= sum;
  }
}

TransitionMatrix TransitionMatrix::sticky(Index modes, double stay) {
  if (modes < 1) throw std::invalid_argument("a transition matrix needs at least 1 mode, not " + std::to_string(modes));
  if (!(stay >= 0.0 && stay <= 1.0))
    throw std::invalid_argument("stay is " + std::to_string(stay) + ", must be a probability");
  if (modes == 1) return {};
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Constant(modes, modes, (1.0 - stay) / static_cast<double>(modes - 1));
  matrix.diagonal().setConstant(stay);
  return TransitionMatrix(std::move(matrix));
}

void check_sizes(const Bank& bank) {
  const LinearStructure& s = bank.structure;
  if (s.states < 1) throw std::invalid_argument("a bank needs at least one state");
  if (bank.modes.empty()) throw std::invalid_argument("a bank needs at least one mode");
  for (std::size_t j = 0; j < bank.modes.size(); ++j) check_mode(bank.modes[j], bank, "mode " + std::to_string(j));
  if (!s.centre.empty() && (!s.intercept || std::ssize(s.centre) != s.states + s.inputs))
    throw std::invalid_argument("a centre of the bank needs an intercept, and a number for each state and input");
  const Index n_y = bank.C.rows(), K = bank.mode_count(), d = s.dimension() + s.acting_inputs();
  if (n_y < 1) throw std::invalid_argument("C of the bank is empty");
  expect_size("C", bank.C, n_y, s.dimension());
  expect_size("R", bank.R, n_y, n_y);
  if (bank.quantum.size() > 0) expect_size("quantum", bank.quantum, n_y, 1);
  expect_size("transition matrix", bank.transition.matrix(), K, K);
  expect_size("initial probability", bank.initial_probability, K, 1);
  if (const auto& [weights, reference] = bank.transition_logit; weights.size() + reference.size() > 0) {
    expect_size("weights of the transition", weights, K, d);
    expect_size("reference of the transition", reference, d, 1);
  }
  if (s.state_lags > 1 && n_y != s.states)
    throw std::invalid_argument("a bank with lagged states must measure each of its " + std::to_string(s.states) +
                                " states");
}

const Bank& validate(const Bank& bank) {
  const LinearStructure& s = bank.structure;
  require(s.input_delay.earliest() >= 0 && s.input_delay.fits(s.inputs),
          "input delays are not one per input, each >= 0");
  check_sizes(bank);
  require(is_covariance(bank.R),
          "R is not a covariance matrix: expected a finite, symmetric, positive semidefinite one");
  require(bank.C.allFinite(), "C is not finite");
  require(bank.quantum.allFinite() && (bank.quantum.array() >= 0.0).all(), "quanta must be finite and at least 0");
  require(!bank.is_quantised() || bank.R.isDiagonal(0.0), "R is not diagonal, which quantised measurements require");
  const Eigen::VectorXd& start = bank.initial_probability;
  require(start.allFinite() && start.minCoeff() >= 0.0 && std::abs(start.sum() - 1.0) <= sum_tolerance,
          "initial probabilities are not nonnegative numbers with sum 1");
  for (std::size_t j = 0; j < bank.modes.size(); ++j) {
    const auto& [A, B, c] = bank.modes[j].model;
    const std::string of_mode = " of mode " + std::to_string(j);
    require(A.allFinite() && B.allFinite() && c.allFinite(), "model" + of_mode + " is not finite");
    require(bank.modes[j].bend.allFinite(), "coefficients of terms" + of_mode + " are not finite");
    require(is_covariance(bank.modes[j].Q),
            "Q" + of_mode + " is not a covariance matrix: expected a finite, symmetric, positive semidefinite one");
  }
  require(bank.transition_logit.weights.allFinite() && bank.transition_logit.reference.allFinite(),
          "weights of the transition are not finite");
  check_terms(bank.terms, s.regressors());
  check_drift(bank);
  check_running_noise(bank);
  return bank;
}

Bank one_mode_bank(const LinearStructure& structure, const Eigen::VectorXd& theta, const Eigen::VectorXd& variance) {
  const Index n = structure.states, dimension = structure.dimension(), p = structure.parameters();
  Bank bank;
  bank.structure = structure;
  bank.C = Eigen::MatrixXd::Identity(n, dimension);
  bank.R = Eigen::MatrixXd::Zero(n, n);
  bank.modes.push_back({unpack(structure, theta), Eigen::MatrixXd::Zero(dimension, dimension),
                        Eigen::MatrixXd::Zero(p, p), Eigen::VectorXd::Zero(p), 1.0});
  bank.noise_variance() = variance;
  bank.initial_probability = Eigen::VectorXd::Ones(1);
  return bank;
}

Eigen::VectorXd Bank::rounding_variance() const {
  return is_quantised() ? Eigen::VectorXd(quantum.array().square() / 12.0) : Eigen::VectorXd::Zero(C.rows());
}

Eigen::MatrixXd Bank::recording_noise() const {
  Eigen::MatrixXd noise = R;
  if (is_quantised()) noise.diagonal() = R.diagonal().cwiseMax(rounding_variance());
  return noise;
}

StartMoments start_moments(const Bank& bank) {
  const Index n = bank.structure.dimension(), n_y = bank.R.rows();
  const Eigen::MatrixXd R = bank.recording_noise();
  if (bank.structure.state_lags > 1) {
    StartMoments moments{Eigen::MatrixXd::Identity(n, n), Eigen::MatrixXd::Zero(n, n)};
    for (Index i = 0; i + n_y <= n; i += n_y) moments.covariance.block(i, i, n_y, n_y) = R;
    return moments;
  }
  double largest = R.diagonal().maxCoeff();
  for (const Mode& mode : bank.modes) largest = std::max(largest, mode.Q.diagonal().maxCoeff());
  const Eigen::MatrixXd C_pinv = bank.C.completeOrthogonalDecomposition().pseudoInverse();
  Eigen::MatrixXd P = C_pinv * R * C_pinv.transpose();
  if (n_y < n) P += unobserved_variance_factor * largest * (Eigen::MatrixXd::Identity(n, n) - C_pinv * bank.C);
  return {C_pinv, 0.5 * (P + P.transpose())};
}

}  // namespace modebank
