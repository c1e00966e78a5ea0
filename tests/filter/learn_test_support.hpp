#pragma once

#include <Eigen/Core>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "filter/learn.hpp"
#include "ident/fit_window.hpp"
#include "tests/support/paths.hpp"

namespace modebank::test {

inline nlohmann::json read_golden(const std::string& name) {
  std::ifstream file(golden_dir() / name);
  if (!file) throw std::runtime_error("no golden file " + name);
  return nlohmann::json::parse(file);
}

/// A list of numbers, or of equally long rows of numbers, as the matrix with these rows.
inline Eigen::MatrixXd golden_matrix(const nlohmann::json& rows) {
  Eigen::MatrixXd result;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const auto row = rows[i].is_array() ? rows[i].get<std::vector<double>>() : std::vector{rows[i].get<double>()};
    if (i == 0) result.resize(std::ssize(rows), std::ssize(row));
    result.row(static_cast<Index>(i)) = Eigen::RowVectorXd::Map(row.data(), std::ssize(row));
  }
  return result;
}

inline Recording empty_recording(Index n, Index m) {
  Recording recording;
  for (Index i = 0; i < n; ++i) recording.states.push_back({"x" + std::to_string(i), "m"});
  for (Index i = 0; i < m; ++i) recording.inputs.push_back({"u" + std::to_string(i), ""});
  return recording;
}

/// Adds a run of samples 0.1 s apart.
inline void add_run(Recording& recording, Eigen::MatrixXd state, Eigen::MatrixXd input, Role role = Role::train) {
  Trajectory run;
  run.run = "run" + std::to_string(recording.runs.size());
  run.role = role;
  run.time_s = Eigen::VectorXd::LinSpaced(state.cols(), 0.0, 0.1 * static_cast<double>(state.cols() - 1));
  run.state = std::move(state);
  run.input = std::move(input);
  recording.runs.push_back(std::move(run));
}

/// The training runs a golden file holds, x and u one sample per row.
inline Recording golden_recording(const nlohmann::json& runs) {
  Recording recording;
  for (const nlohmann::json& run : runs) {
    const Eigen::MatrixXd x = golden_matrix(run.at("x")), u = golden_matrix(run.at("u"));
    if (recording.runs.empty()) recording = empty_recording(x.cols(), u.cols());
    add_run(recording, x.transpose(), u.transpose());
  }
  return recording;
}

inline LinearStructure structure_of(const Recording& recording) {
  return {recording.state_count(), recording.input_count(), false};
}

/// Windows of every training run without any fit but the global one, as far as banks need them.
inline WindowFits windows_of(const Recording& recording, Index length, Index step) {
  WindowFits fits;
  fits.structure = structure_of(recording);
  fits.length = length;
  fits.step = step;
  fits.windows = make_windows(recording, length, step);
  fits.global = fit_global(recording, fits.structure);
  return fits;
}

/// A mixture of K components of equal weight around the global theta whose memberships are `responsibilities` (K x M,
/// NaN columns: not clustered).
inline MixtureResult mixture_of(const WindowFits& fits, const Eigen::MatrixXd& responsibilities) {
  const Index K = responsibilities.rows(), p = fits.parameter_count();
  MixtureResult result;
  result.mixture.weights = Eigen::VectorXd::Constant(K, 1.0 / static_cast<double>(K));
  result.mixture.means = fits.global.theta.replicate(1, K);
  result.mixture.covariances.assign(K, Eigen::MatrixXd::Identity(p, p));
  result.responsibilities = responsibilities;
  result.labels = Eigen::VectorXi::Constant(fits.count(), -1);
  for (Index i = 0; i < fits.count(); ++i)
    if (!std::isnan(responsibilities(0, i))) responsibilities.col(i).maxCoeff(&result.labels(i));
  return result;
}

}  // namespace modebank::test
