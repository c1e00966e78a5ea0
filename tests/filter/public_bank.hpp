#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <boost/random/normal_distribution.hpp>
#include <boost/random/uniform_01.hpp>
#include <cmath>
#include <random>

#include "filter/step/bank.hpp"
#include "modebank/base/eigen.hpp"
#include "modebank/base/recording.hpp"
#include "modebank/filter/bank_filter.hpp"

namespace modebank::test {

using Eigen::Index;

/// A well-conditioned bank of K modes. The modes differ in A, B, c and Q (by a factor of ten from mode to mode). R = r
/// I, C = I.
inline filter::BankDescription example_description(Index n, Index m, Index K, double r = 1e-4) {
  filter::BankDescription bank;
  bank.inputs = m;
  bank.intercept = true;
  const Index p = n * (n + m + 1);
  const Eigen::MatrixXd I = Eigen::MatrixXd::Identity(n, n);
  for (Index j = 0; j < K; ++j) {
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
  bank.transition = to_matrix(TransitionMatrix::sticky(K, 0.9).matrix());
  bank.initial_probability.assign(K, 1.0 / static_cast<double>(K));
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

inline Index draw_index(const Eigen::VectorXd& probability, std::mt19937_64& generator) {
  double u = boost::random::uniform_01<double>()(generator);
  Index i = 0;
  while (i + 1 < probability.size() && (u -= probability(i)) > 0.0) ++i;
  return i;
}

/// A run of a bank's switching system, with y = C x + v as the filter assumes.
struct SimulatedRun {
  RecordedRun run;
  Eigen::MatrixXd truth;  ///< states
  Eigen::VectorXi mode;   ///< mode of the transition to each sample
};

inline SimulatedRun simulate_description(const filter::BankDescription& bank, Index samples, std::uint64_t seed) {
  std::mt19937_64 generator(seed);
  boost::random::uniform_01<double> uniform;
  Eigen::MatrixXd input(bank.inputs, samples), state(bank.C.rows, samples);
  for (double& value : input.reshaped()) value = uniform(generator) - 0.5;
  SimulatedRun result{{}, Eigen::MatrixXd(bank.C.cols, samples), Eigen::VectorXi(samples)};
  Eigen::VectorXd x = Eigen::VectorXd::Zero(bank.C.cols);
  Index s = draw_index(view(bank.initial_probability), generator);
  for (Index k = 0; k < samples; ++k) {
    result.truth.col(k) = x;
    result.mode(k) = static_cast<int>(s);
    state.col(k) = view(bank.C) * x + draw_normal(view(bank.R), generator);
    s = draw_index(view(bank.transition).row(s), generator);
    const filter::Mode& mode = bank.modes[s];
    x += view(mode.A) * x + view(mode.B) * input.col(k) + view(mode.c) + draw_normal(view(mode.Q), generator);
  }
  const Eigen::VectorXd time_s = Eigen::VectorXd::LinSpaced(samples, 0.0, static_cast<double>(samples - 1));
  result.run = {"simulated", false, to_vector(time_s), to_matrix(state), to_matrix(input)};
  return result;
}

}  // namespace modebank::test
