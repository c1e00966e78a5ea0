#pragma once

#include <gtest/gtest.h>

#include <boost/random/normal_distribution.hpp>
#include <cmath>
#include <random>

#include "filter/learn/from_mixture/bank.hpp"
#include "filter/learn/refine/refine.hpp"
#include "tests/filter/learn/learn_test_support.hpp"

namespace modebank::test {

struct Truth {
  Eigen::MatrixXd theta{{-0.2, -0.2, -0.6}, {0.3, 1.0, 0.6}};  // coefficients a and b of three modes, one mode per
                                                               // column
  Eigen::Vector3d Q{0.0025, 0.01, 0.04};
  Eigen::Matrix3d T{{0.96, 0.03, 0.01}, {0.02, 0.96, 0.02}, {0.02, 0.02, 0.96}};
};

/// x[k+1] = x + a x + b u + w with switching modes, exactly measured. `rough` multiplies the standard deviation of w.
inline void simulate(const Truth& truth, Index runs, Index samples, double rough, Role role, std::mt19937_64& generator,
                     Recording& recording) {
  boost::random::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  for (Index i = 0; i < runs; ++i) {
    Eigen::MatrixXd x = Eigen::MatrixXd::Zero(1, samples), u(1, samples);
    Index mode = i % 3;
    for (Index k = 0; k < samples; ++k) {
      u(k) = normal(generator);
      double draw = uniform(generator);
      Index next = 0;
      while (next < 2 && (draw -= truth.T(mode, next)) > 0.0) ++next;
      mode = next;
      if (k + 1 < samples)
        x(k + 1) = x(k) + truth.theta(0, mode) * x(k) + truth.theta(1, mode) * u(k) +
                   rough * std::sqrt(truth.Q(mode)) * normal(generator);
    }
    add_run(recording, x, u, role);
  }
}

/// A bank with modes near the true ones.
inline Bank start_bank(const Recording& recording, const Eigen::MatrixXd& theta) {
  const LinearStructure structure = structure_of(recording);
  Bank bank = bank_frame(recording, structure, Eigen::MatrixXd::Zero(1, 1));
  for (Index j = 0; j < theta.cols(); ++j)
    bank.modes.push_back(make_mode(structure, theta.col(j), Eigen::MatrixXd::Constant(1, 1, 0.02), {}, {}, 1.0));
  set_mode_sequence(bank, TransitionMatrix::sticky(theta.cols(), 0.9));
  return bank;
}

inline RefineOptions quick() {
  RefineOptions options;
  options.restarts = 0;
  options.folds = 1;
  options.max_iterations = 100;
  options.tolerance = 1e-8;
  return options;
}

/// Runs of a system with known modes for learning.
class RefineTest : public testing::Test {
 protected:
  Truth truth;
  std::mt19937_64 generator{17};
  Recording recording = empty_recording(1, 1);
  const Recording& learn_from(Index runs, Index samples) {
    simulate(truth, runs, samples, 1.0, Role::train, generator, recording);
    return recording;
  }
};

}  // namespace modebank::test
