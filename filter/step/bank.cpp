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
// One measurement does not determine all directions of the state. Undetermined directions start with this multiple of
// the largest variance of Q and R. It is wide compared with what the filter will learn, and small enough for accurate
// arithmetic.
constexpr double unobserved_variance_factor = 1e4;

void expect_size(const std::string& what, Index rows, Index cols, Index expected_rows, Index expected_cols) {
  if (rows == expected_rows && cols == expected_cols) return;
  throw std::invalid_argument(what + " is " + std::to_string(rows) + " x " + std::to_string(cols) + ", must be " +
                              std::to_string(expected_rows) + " x " + std::to_string(expected_cols));
}

void check_mode(const Mode& mode, const LinearStructure& s, Index terms, const std::string& name) {
  const Index n = s.dimension(), p = s.parameters();
  expect_size(name + " A", mode.model.A.rows(), mode.model.A.cols(), n, n);
  expect_size(name + " B", mode.model.B.rows(), mode.model.B.cols(), n, s.acting_inputs());
  expect_size(name + " c", mode.model.c.size(), 1, n, 1);
  expect_size(name + " Q", mode.Q.rows(), mode.Q.cols(), n, n);
  expect_size(name + " bend", mode.bend.rows(), mode.bend.cols(), terms > 0 ? s.states : 0, terms);
  if (mode.parameter_covariance.size() > 0)
    expect_size(name + " parameter covariance", mode.parameter_covariance.rows(), mode.parameter_covariance.cols(), p,
                p);
  if (mode.standard_error.size() > 0) expect_size(name + " standard error", mode.standard_error.size(), 1, p, 1);
}

void require(bool holds, const std::string& what) {
  if (!holds) throw std::invalid_argument("the bank's " + what);
}

void check_numbers(const Mode& mode, const std::string& of_mode) {
  require(mode.model.A.allFinite() && mode.model.B.allFinite() && mode.model.c.allFinite(),
          "model" + of_mode + " is not finite");
  require(mode.bend.allFinite(), "coefficients of terms" + of_mode + " are not finite");
  require(is_covariance(mode.Q),
          "Q" + of_mode + " is not a covariance matrix: expected a finite, symmetric, positive semidefinite one");
}

void check_logit_sizes(const Bank& bank) {
  const TransitionLogit& logit = bank.transition_logit;
  if (logit.empty() && logit.reference.size() == 0) return;
  const Index d = bank.structure.dimension() + bank.structure.acting_inputs();
  expect_size("weights of the transition", logit.weights.rows(), logit.weights.cols(), bank.mode_count(), d);
  expect_size("reference of the transition", logit.reference.size(), 1, d, 1);
}

void check_noise_factor(const Bank& bank) {
  const NoiseFactor& factor = bank.noise_factor;
  if (factor.empty() && factor.directions.size() == 0) return;
  expect_size("directions of the noise factor", factor.directions.rows(), factor.directions.cols(),
              factor.weights.size(), bank.structure.dimension() + bank.structure.acting_inputs());
  require(factor.directions.allFinite() && factor.weights.allFinite() && std::isfinite(factor.offset),
          "noise factor is not finite");
}

/// Drift requires exactly measured states.
void check_drift(const Bank& bank) {
  if (bank.drift.empty()) return;
  const LinearStructure& s = bank.structure;
  const DriftRates& rates = bank.drift.rates;
  const Wandering wandering = bank.drift.wandering;
  expect_size("scale of the drift", bank.drift.scale.size(), 1, s.regressors(), 1);
  require(bank.drift.scale.allFinite() && bank.drift.scale.minCoeff() > 0.0,
          "drift needs a finite positive scale for each regressor");
  require(rates.q >= 0.0 && rates.p0 >= 0.0 && std::isfinite(rates.q + rates.p0),
          "drift q and p0 must be finite and at least 0");
  require(rates.leak > 0.0 && rates.leak <= 1.0, "drift leak must be above 0 and at most 1");
  require((bank.R.array() == 0.0).all(), "drift needs exactly measured states: R must be 0");
  require(bank.C.isIdentity(0.0) && bank.C.rows() == s.states,
          "drift needs each state measured directly: C must be the identity");
  require(wandering != Wandering::constant || s.intercept, "structure has no constant that could drift");
  require(wandering != Wandering::gain || s.inputs > 0, "structure has no inputs whose gain could drift");
}

void check_running_noise(const Bank& bank) {
  const RunningNoise& noise = bank.running_noise;
  require(bank.drift.empty() == noise.empty(), "running noise and drift need each other");
  if (noise.empty()) return;
  const auto positive = [](const auto& x) { return x.allFinite() && (x.array() > 0.0).all(); };
  expect_size("least variance of the running noise", noise.floor.size(), 1, bank.structure.states, 1);
  require(positive(noise.floor), "running noise needs a positive least variance of each state");
  require(bank.mode_count() == 1, "running noise needs exactly one mode");
  require(positive(bank.noise_variance()), "running noise needs a positive diagonal of Q");
  require(noise.lam >= 0.0 && noise.lam <= 1.0, "running noise needs lam in [0, 1]");
  for (const auto& [ahead, factor] : noise.horizon_factor)
    require(ahead > 1 && factor > 0.0 && std::isfinite(factor),
            "horizon factors must be finite and positive, for horizons of at least 2");
  StudentNoise{noise.nu};
  if (noise.level.size() == 0 && noise.switching.size() == 0) return;
  const Index levels = noise.level.cols();
  expect_size("noise levels", noise.level.rows(), levels, bank.structure.states, levels);
  expect_size("transition matrix of the noise levels", noise.switching.rows(), noise.switching.cols(), levels, levels);
  require(positive(noise.level), "noise levels must be finite and positive");
  TransitionMatrix{noise.switching};
}

}  // namespace

TransitionMatrix::TransitionMatrix(Eigen::MatrixXd row_stochastic) : matrix_(std::move(row_stochastic)) {
  if (matrix_.rows() != matrix_.cols() || matrix_.rows() == 0)
    throw std::invalid_argument("transition matrix is " + std::to_string(matrix_.rows()) + " x " +
                                std::to_string(matrix_.cols()) + ", must be square and not empty");
  for (Index i = 0; i < matrix_.rows(); ++i) {
    const double sum = matrix_.row(i).sum();
    if (!(std::abs(sum - 1.0) <= sum_tolerance))
      throw std::invalid_argument("row " + std::to_string(i) + " of the transition matrix sums to " +
                                  std::to_string(sum) + ", must be 1");
    if (!(matrix_.row(i).minCoeff() >= 0.0))
      throw std::invalid_argument("row " + std::to_string(i) + " of the transition matrix holds the negative entry " +
                                  std::to_string(matrix_.row(i).minCoeff()));
    // A row that is already normalised stays bit-identical, so that a stored bank gives the same results as the
    // original.
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
  if (bank.structure.states < 1) throw std::invalid_argument("a bank needs at least one state");
  if (bank.modes.empty()) throw std::invalid_argument("a bank needs at least one mode");
  for (std::size_t j = 0; j < bank.modes.size(); ++j)
    check_mode(bank.modes[j], bank.structure, bank.terms.count(), "mode " + std::to_string(j));
  if (const LinearStructure& s = bank.structure; !s.centre.empty() && !s.intercept)
    throw std::invalid_argument("a centre of the bank needs an intercept");
  else if (!s.centre.empty())
    expect_size("centre", std::ssize(s.centre), 1, s.states + s.inputs, 1);
  const Index n_y = bank.C.rows(), K = bank.mode_count();
  if (n_y < 1) throw std::invalid_argument("C of the bank is empty");
  expect_size("C", n_y, bank.C.cols(), n_y, bank.structure.dimension());
  expect_size("R", bank.R.rows(), bank.R.cols(), n_y, n_y);
  if (bank.quantum.size() > 0) expect_size("quantum", bank.quantum.size(), 1, n_y, 1);
  expect_size("transition matrix", bank.transition.modes(), bank.transition.modes(), K, K);
  expect_size("initial probability", bank.initial_probability.size(), 1, K, 1);
  check_logit_sizes(bank);
  if (bank.structure.state_lags > 1 && n_y != bank.structure.states)
    throw std::invalid_argument("a bank with lagged states must measure each of its " +
                                std::to_string(bank.structure.states) + " states");
}

Bank one_mode_bank(const LinearStructure& structure, const Eigen::VectorXd& theta, const Eigen::VectorXd& variance) {
  const Index n = structure.states, dimension = structure.dimension(), p = structure.parameters();
  Bank bank;
  bank.structure = structure;
  bank.C = Eigen::MatrixXd::Identity(n, dimension);
  bank.R = Eigen::MatrixXd::Zero(n, n);
  Eigen::MatrixXd Q = Eigen::MatrixXd::Zero(dimension, dimension);
  Q.diagonal().head(n) = variance;
  bank.modes.push_back(
      {unpack(structure, theta), std::move(Q), Eigen::MatrixXd::Zero(p, p), Eigen::VectorXd::Zero(p), 1.0});
  bank.initial_probability = Eigen::VectorXd::Ones(1);
  return bank;
}

bool has_one_theta(const Bank& bank) {
  for (Index k = 1; k < bank.mode_count(); ++k)
    if (bank.theta(k) != bank.theta(0) || bank.modes[static_cast<std::size_t>(k)].bend != bank.modes.front().bend)
      return false;
  return bank.mode_count() > 1;
}

void validate(const Bank& bank) {
  const InputDelays& delay = bank.structure.input_delay;
  require(delay.earliest() >= 0 && delay.fits(bank.structure.inputs), "input delays are not one per input, each >= 0");
  check_sizes(bank);
  require(is_covariance(bank.R),
          "R is not a covariance matrix: expected a finite, symmetric, positive semidefinite one");
  require(bank.C.allFinite(), "C is not finite");
  require(bank.quantum.allFinite() && (bank.quantum.array() >= 0.0).all(), "quanta must be finite and at least 0");
  require(!bank.is_quantised() || bank.R.isDiagonal(0.0), "R is not diagonal, which quantised measurements require");
  require(bank.initial_probability.allFinite() && bank.initial_probability.minCoeff() >= 0.0 &&
              std::abs(bank.initial_probability.sum() - 1.0) <= sum_tolerance,
          "initial probabilities are not nonnegative numbers with sum 1");
  for (std::size_t j = 0; j < bank.modes.size(); ++j) check_numbers(bank.modes[j], " of mode " + std::to_string(j));
  require(bank.transition_logit.weights.allFinite() && bank.transition_logit.reference.allFinite(),
          "weights of the transition are not finite");
  check_terms(bank.terms, bank.structure.regressors());
  check_noise_factor(bank);
  check_drift(bank);
  check_running_noise(bank);
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
