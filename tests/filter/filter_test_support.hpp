#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <boost/random/normal_distribution.hpp>
#include <boost/random/uniform_01.hpp>
#include <random>
#include <utility>
#include <vector>

#include "filter/step/bank.hpp"
#include "ident/data/trajectory.hpp"
#include "modebank/filter/options.hpp"

namespace modebank::test {

/// A well-conditioned bank of K modes. The modes differ in A, B, c and Q (by a factor of ten from mode to mode). R = r
/// I, C = I.
inline Bank example_bank(Eigen::Index n, Eigen::Index m, Eigen::Index K, double r = 1e-4) {
  Bank bank;
  bank.structure = {n, m, true};
  const Eigen::Index p = bank.structure.parameters();
  for (Eigen::Index j = 0; j < K; ++j) {
    Mode mode;
    const double d = static_cast<double>(j);
    mode.model.A = -(0.2 + 0.1 * d) * Eigen::MatrixXd::Identity(n, n) + Eigen::MatrixXd::Constant(n, n, 0.03);
    mode.model.B = Eigen::MatrixXd::Constant(n, m, 0.1 + 0.05 * d);
    if (m > 1) mode.model.B.col(0) *= -1.0;
    mode.model.c = Eigen::VectorXd::Constant(n, 0.01 * d);
    mode.Q = std::pow(10.0, -4.0 + d) * (Eigen::MatrixXd::Identity(n, n) + Eigen::MatrixXd::Constant(n, n, 0.3));
    mode.parameter_covariance = 1e-3 * (Eigen::MatrixXd::Identity(p, p) + Eigen::MatrixXd::Constant(p, p, 0.1));
    mode.weight = 1.0 / static_cast<double>(K);
    bank.modes.push_back(mode);
  }
  bank.C.setIdentity(n, n);
  bank.R = r * Eigen::MatrixXd::Identity(n, n);
  bank.transition = TransitionMatrix::sticky(K, 0.9);
  bank.initial_probability = Eigen::VectorXd::Constant(K, 1.0 / static_cast<double>(K));
  return bank;
}

inline Eigen::VectorXd draw_normal(const Eigen::MatrixXd& covariance, std::mt19937_64& generator) {
  boost::random::normal_distribution<double> normal;
  Eigen::VectorXd z(covariance.rows());
  for (double& value : z) value = normal(generator);
  const Eigen::LDLT<Eigen::MatrixXd> factor(covariance);  // LLT is unsuitable, because a covariance may be singular
  const Eigen::VectorXd scaled = factor.vectorD().cwiseMax(0.0).cwiseSqrt().asDiagonal() * z;
  return factor.transpositionsP().transpose() * (factor.matrixL() * scaled);
}

inline Eigen::Index draw_index(const Eigen::VectorXd& probability, std::mt19937_64& generator) {
  double u = boost::random::uniform_01<double>()(generator);
  Eigen::Index i = 0;
  while (i + 1 < probability.size() && (u -= probability(i)) > 0.0) ++i;
  return i;
}

/// A run of the bank's switching system, with y = C x + v as the filter assumes.
inline Trajectory simulate_bank(const Bank& bank, Eigen::Index samples, std::uint64_t seed) {
  std::mt19937_64 generator(seed);
  boost::random::uniform_01<double> uniform;
  Trajectory run;
  run.run = "simulated";
  run.time_s = Eigen::VectorXd::LinSpaced(samples, 0.0, static_cast<double>(samples - 1));
  run.state.resize(bank.C.rows(), samples);
  run.input.resize(bank.structure.inputs, samples);
  for (Eigen::Index i = 0; i < run.input.size(); ++i) run.input(i) = uniform(generator) - 0.5;
  Eigen::VectorXd x = Eigen::VectorXd::Zero(bank.structure.states);
  Eigen::Index s = draw_index(bank.initial_probability, generator);
  for (Eigen::Index k = 0; k < samples; ++k) {
    run.state.col(k) = bank.C * x + draw_normal(bank.R, generator);
    s = draw_index(bank.transition.matrix().row(s), generator);
    const Mode& mode = bank.modes[static_cast<std::size_t>(s)];
    x = mode.model.next(x, run.input.col(k)) + draw_normal(mode.Q, generator);
  }
  return run;
}

/// A run of the bank with its true states and modes.
struct SimulatedTruth {
  Trajectory run;
  Eigen::VectorXi mode;
};

inline SimulatedTruth simulate_truth(const Bank& bank, Eigen::Index samples, std::uint64_t seed) {
  SimulatedTruth result;
  Trajectory& run = result.run;
  std::mt19937_64 generator(seed);
  boost::random::uniform_01<double> uniform;
  run.run = "simulated";
  run.time_s = Eigen::VectorXd::LinSpaced(samples, 0.0, static_cast<double>(samples - 1));
  run.truth.resize(bank.structure.states, samples);
  run.state.resize(bank.C.rows(), samples);
  run.input.resize(bank.structure.inputs, samples);
  result.mode.resize(samples);
  for (double& value : run.input.reshaped()) value = uniform(generator) - 0.5;
  Eigen::VectorXd x = Eigen::VectorXd::Zero(bank.structure.states);
  Eigen::Index s = draw_index(bank.initial_probability, generator);
  for (Eigen::Index k = 0; k < samples; ++k) {
    run.truth.col(k) = x;
    result.mode(k) = static_cast<int>(s);  // mode of the transition to sample k
    run.state.col(k) = bank.C * x + draw_normal(bank.R, generator);
    s = draw_index(bank.transition.matrix().row(s), generator);
    const Mode& mode = bank.modes[static_cast<std::size_t>(s)];
    x = mode.model.next(x, run.input.col(k)) + draw_normal(mode.Q, generator);
  }
  return result;
}

/// The bank with only mode `j`.
inline Bank single_mode(Bank bank, std::size_t j) {
  bank.modes = {bank.modes[j]};
  bank.transition = TransitionMatrix();
  bank.initial_probability = Eigen::VectorXd::Ones(1);
  return bank;
}

/// The part of the bank that this variant can filter. For kf it is the first mode only.
inline Bank steppable(Bank bank, FilterVariant variant) {
  return variant == FilterVariant::kf ? single_mode(std::move(bank), 0) : bank;
}

}  // namespace modebank::test
