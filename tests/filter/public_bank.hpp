#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <boost/random/normal_distribution.hpp>
#include <boost/random/uniform_01.hpp>
#include <cmath>
#include <random>

#include "modebank/base/eigen.hpp"
#include "modebank/base/recording.hpp"
#include "modebank/filter/bank_filter.hpp"

namespace modebank::test {

inline Matrix sticky_transition(Eigen::Index modes, double stay) {
  Eigen::MatrixXd result = Eigen::MatrixXd::Constant(modes, modes, (1.0 - stay) / static_cast<double>(modes - 1));
  result.diagonal().setConstant(modes == 1 ? 1.0 : stay);
  return to_matrix(result);
}

/// A well-conditioned bank of K modes. The modes differ in A, B, c and Q (by a factor of ten from mode to mode). R = r
/// I, C = I.
inline filter::BankDescription example_description(Eigen::Index n, Eigen::Index m, Eigen::Index K, double r = 1e-4) {
  filter::BankDescription bank;
  bank.inputs = m;
  bank.intercept = true;
  const Eigen::Index p = n * (n + m + 1);
  const Eigen::MatrixXd I = Eigen::MatrixXd::Identity(n, n);
  for (Eigen::Index j = 0; j < K; ++j) {
    const double d = static_cast<double>(j);
    Eigen::MatrixXd B = Eigen::MatrixXd::Constant(n, m, 0.1 + 0.05 * d);
    if (m > 1) B.col(0) *= -1.0;
    bank.modes.push_back({to_matrix(-(0.2 + 0.1 * d) * I + Eigen::MatrixXd::Constant(n, n, 0.03)), to_matrix(B),
                          to_vector(Eigen::VectorXd::Constant(n, 0.01 * d)),
                          to_matrix(std::pow(10.0, -4.0 + d) * (I + Eigen::MatrixXd::Constant(n, n, 0.3))),
                          to_matrix(1e-3 * (Eigen::MatrixXd::Identity(p, p) + Eigen::MatrixXd::Constant(p, p, 0.1))),
                          1.0 / static_cast<double>(K)});
  }
  bank.C = to_matrix(I);
  bank.R = to_matrix(r * I);
  bank.transition = sticky_transition(K, 0.9);
  bank.initial_probability.assign(static_cast<std::size_t>(K), 1.0 / static_cast<double>(K));
  return bank;
}

/// The bank with only mode `j`.
inline filter::BankDescription single_mode(filter::BankDescription bank, std::size_t j) {
  bank.modes = {bank.modes[j]};
  bank.transition = sticky_transition(1, 1.0);
  bank.initial_probability = {1.0};
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

/// A run of a bank's switching system, with y = C x + v as the filter assumes.
struct SimulatedRun {
  RecordedRun run;
  Eigen::MatrixXd truth;  ///< states
  Eigen::VectorXi mode;   ///< mode of the transition to each sample
};

inline SimulatedRun simulate_description(const filter::BankDescription& bank, Eigen::Index samples,
                                         std::uint64_t seed) {
  std::mt19937_64 generator(seed);
  boost::random::uniform_01<double> uniform;
  Eigen::MatrixXd input(bank.inputs, samples), state(bank.C.rows, samples);
  for (double& value : input.reshaped()) value = uniform(generator) - 0.5;
  SimulatedRun result{{}, Eigen::MatrixXd(bank.C.cols, samples), Eigen::VectorXi(samples)};
  Eigen::VectorXd x = Eigen::VectorXd::Zero(bank.C.cols);
  Eigen::Index s = draw_index(view(bank.initial_probability), generator);
  for (Eigen::Index k = 0; k < samples; ++k) {
    result.truth.col(k) = x;
    result.mode(k) = static_cast<int>(s);
    state.col(k) = view(bank.C) * x + draw_normal(view(bank.R), generator);
    s = draw_index(view(bank.transition).row(s), generator);
    const filter::Mode& mode = bank.modes[static_cast<std::size_t>(s)];
    x += view(mode.A) * x + view(mode.B) * input.col(k) + view(mode.c) + draw_normal(view(mode.Q), generator);
  }
  const Eigen::VectorXd time_s = Eigen::VectorXd::LinSpaced(samples, 0.0, static_cast<double>(samples - 1));
  result.run = {"simulated", false, to_vector(time_s), to_matrix(state), to_matrix(input)};
  return result;
}

/// K x N, mode probabilities before each measurement.
inline Eigen::MatrixXd predicted_probabilities(const filter::Bank& bank, const RecordedRun& run,
                                               const FilterOptions& options) {
  filter::BankFilter stepped(bank, options);
  Eigen::MatrixXd result(bank.modes(), std::ssize(run.time_s));
  for (Eigen::Index k = 0; k < result.cols(); ++k) {
    const Eigen::VectorXd u = view(run.input).col(k), y = view(run.state).col(k);
    result.col(k) = view(stepped.step(run.time_s[static_cast<std::size_t>(k)], u, y).mode_probability_predicted);
  }
  return result;
}

}  // namespace modebank::test
