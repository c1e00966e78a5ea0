#pragma once

#include <string>

#include "io/archive/archive.hpp"
#include "tests/filter/filter_test_support.hpp"

namespace modebank::test {

/// The parts of an archive that the first screen reads: runs of 5 samples with a period of 0.1 s, their scores and a
/// finding. Consecutive modes of the bank differ equally, and their use decreases.
inline Archive screen_archive(Index states, Index inputs, Index modes, Role judged = Role::test) {
  Archive archive;
  Recording recording;
  for (Index i = 0; i < states; ++i) recording.states.push_back({i == 0 ? "wz" : "v" + std::to_string(i), "rad/s"});
  for (Index j = 0; j < inputs; ++j) recording.inputs.push_back({"vel" + std::to_string(j), "m/s"});
  for (const Role role : {Role::train, judged}) {
    Trajectory run;
    run.role = role;
    run.run = role == Role::train ? "00" : "01";
    run.time_s = Eigen::VectorXd::LinSpaced(5, 0.0, 0.4);
    run.state = Eigen::MatrixXd::Zero(states, 5);
    run.input = Eigen::MatrixXd::Zero(inputs, 5);
    recording.runs.push_back(run);
  }
  Bank bank = example_bank(states, inputs, modes);
  bank.dt_s = 0.1;
  for (Mode& mode : bank.modes) mode.standard_error = Eigen::VectorXd::Constant(bank.structure.parameters(), 1e-3);
  double use = 0.5;
  for (Index k = -1; k < modes; ++k) {
    DiagnosticsRow row{"bank", judged, k, 0, use, 0.0, 12.0};
    row.coverage_50 = 0.575, row.coverage_90 = 0.934, row.coverage_95 = 0.966, row.coverage_99 = 0.989;
    row.coverage_50_lower = 0.555, row.coverage_50_upper = 0.595;
    row.coverage_90_lower = 0.895, row.coverage_90_upper = 0.944;
    row.coverage_95_lower = 0.956, row.coverage_95_upper = 0.974;
    row.coverage_99_lower = 0.983, row.coverage_99_upper = 0.993;
    if (k >= 0) use *= 0.6;
    row.verdict = Calibration::calibrated;
    if (k < 0 || modes > 1) archive.diagnostics.push_back(row);
  }
  for (const auto& [filter, error] : {std::pair{"bank", 0.03}, {"drifting", 0.04}}) {
    const Eigen::VectorXd rmse = Eigen::VectorXd::Constant(states, error);
    archive.summary.push_back({filter, judged, "*", 0, 0.0, rmse});
    archive.horizons.push_back({filter, judged, "*", 10, 100, 0.0, 2.0 * rmse, 0.91});
  }
  archive.finding.emplace();
  archive.finding->answer = Answer::evidence;
  archive.finding->role = judged;
  archive.finding->runs = 1;
  archive.finding->best_competitor = "drifting";
  archive.finding->text = "1 held-out run shows evidence for modes of motion.";
  archive.recording = std::move(recording);
  archive.bank = std::move(bank);
  return archive;
}

}  // namespace modebank::test
