#pragma once

#include <Eigen/Core>
#include <cmath>

#include "modebank/base/eigen.hpp"
#include "modebank/base/recording.hpp"

namespace modebank::test {

/// A run with samples 1 s apart.
inline RecordedRun public_run(const Eigen::MatrixXd& state, const Eigen::MatrixXd& input, bool held_out = false) {
  const Eigen::VectorXd time_s = Eigen::VectorXd::LinSpaced(state.cols(), 0.0, static_cast<double>(state.cols() - 1));
  return {"run", held_out, to_vector(time_s), to_matrix(state), to_matrix(input)};
}

/// An exact run of one state and two inputs with these parameters. Its signals are so large that it alone decides the
/// global model, and so the mean of the default prior.
inline RecordedRun run_that_decides(const Eigen::Vector3d& theta) {
  constexpr Eigen::Index samples = 26;
  Eigen::MatrixXd x = Eigen::MatrixXd::Zero(1, samples), u(2, samples);
  for (Eigen::Index k = 0; k < samples; ++k) {
    const double phase = static_cast<double>(k * k);
    u.col(k) = 1e9 * Eigen::Vector2d(std::sin(phase), std::cos(1.7 * phase));
    if (k + 1 < samples) x(k + 1) = x(k) + theta(0) * x(k) + theta.tail<2>().dot(u.col(k));
  }
  return public_run(x, u);
}

}  // namespace modebank::test
