#pragma once

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <boost/random/normal_distribution.hpp>
#include <boost/random/uniform_real_distribution.hpp>
#include <cstring>
#include <nlohmann/json.hpp>
#include <random>
#include <string>

#include "ident/data/trajectory.hpp"
#include "ident/fit/fit_window.hpp"
#include "ident/fit/fit_windows.hpp"
#include "ident/fit/global_model.hpp"
#include "tests/support/golden.hpp"
#include "tests/support/paths.hpp"

namespace modebank::test {

/// One yaw-rate state, two wheels: the layout of the real logs.
inline const LinearStructure skid_structure{1, 2, false};
inline const Eigen::Vector3d skid_theta(-0.3, -0.4, 0.5);

/// One case of tests/golden/data/ident_fits.json (written by ident_fits.py).
inline nlohmann::json golden_fit(const std::string& name) { return read_golden("ident_fits").at(name); }

inline const std::vector<Loss> all_losses{Loss::trivial,  Loss::huber, Loss::cauchy,
                                          Loss::softlone, Loss::tukey, Loss::arctan};

inline bool same_bits(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  if (a.size() != b.size()) return false;
  return a.size() == 0 || std::memcmp(a.data(), b.data(), static_cast<std::size_t>(a.size()) * sizeof(double)) == 0;
}

inline Trajectory make_run(const Eigen::MatrixXd& state, const Eigen::MatrixXd& input, Role role = Role::train) {
  Trajectory run;
  run.run = "00";
  run.role = role;
  run.time_s = Eigen::VectorXd::LinSpaced(state.cols(), 0.0, static_cast<double>(state.cols() - 1));
  run.state = state;
  run.input = input;
  return run;
}

inline Recording make_recording(std::vector<Trajectory> runs) {
  Recording recording;
  for (Index i = 0; i < runs.at(0).state.rows(); ++i) recording.states.push_back({"x" + std::to_string(i), ""});
  for (Index i = 0; i < runs.at(0).input.rows(); ++i) recording.inputs.push_back({"u" + std::to_string(i), ""});
  recording.runs = std::move(runs);
  return recording;
}

/// Uniform inputs in +-1, Gaussian process noise, state from zero; n and m from the structure.
inline Trajectory gaussian_run(const LinearStructure& structure, const Eigen::VectorXd& theta, double noise_sd,
                               Index samples, std::mt19937_64& generator) {
  boost::random::uniform_real_distribution<double> level(-1.0, 1.0);
  boost::random::normal_distribution<double> noise(0.0, 1.0);
  const LinearModel model = unpack(structure, theta);
  Eigen::MatrixXd x = Eigen::MatrixXd::Zero(structure.states, samples), u(structure.inputs, samples);
  for (double& value : u.reshaped()) value = level(generator);
  for (Index k = 0; k + 1 < samples; ++k) {
    x.col(k + 1) = model.next(x.col(k), u.col(k));
    for (Index i = 0; i < x.rows(); ++i) x(i, k + 1) += noise_sd * noise(generator);
  }
  return make_run(x, u);
}

/// A window over the whole run.
inline FitOptions whole_run(const Trajectory& run, Loss loss) {
  FitOptions options;
  options.length = run.transitions();
  options.loss = loss;
  return options;
}

}  // namespace modebank::test
