// The part of archive_fixture.cpp that fills evaluations and scores.
#include "ident/base/not_a_number.hpp"
#include "tests/io/archive/archive_fixture.hpp"

namespace modebank::test {

namespace {

RunEvaluation make_evaluation(Index n, Index samples, Index count) {
  RunEvaluation evaluation;
  evaluation.prediction = pattern(n, samples, 70.0);
  evaluation.innovation = pattern(n, samples, 71.0);
  evaluation.innovation_covariance = spread_pattern(n, samples, 72.0);
  evaluation.state = pattern(n, samples, 73.0);
  evaluation.covariance = spread_pattern(n, samples, 74.0);
  evaluation.nis = pattern(samples, 1, 75.0);
  evaluation.nis(0) = not_a_number;
  evaluation.pit = share_pattern(n, samples, 76.0);
  evaluation.log_density = pattern(samples, 1, 77.0);
  evaluation.mode_probability_predicted = probability_pattern(count, samples, 78.0);
  evaluation.mode_probability = probability_pattern(count, samples, 79.0);
  if (count == 1) return evaluation;
  evaluation.viterbi_mode.resize(samples);
  for (Index s = 0; s < samples; ++s) evaluation.viterbi_mode(s) = static_cast<int>(s % (count + 1)) - 1;
  return evaluation;
}

ResidualTests make_residual_tests(Index n, Index m, Index run) {
  constexpr Index lags = 4;
  ResidualTests tests;
  tests.samples = 10 + run;
  tests.autocorrelation = pattern(n, lags, 90.0 + static_cast<double>(run));
  tests.cross_correlation = pattern(n * m, lags, 91.0);
  tests.autocorrelation_band = 0.25;
  tests.cross_correlation_band = pattern(m, n, 92.0);
  tests.ljung_box_p = share_pattern(n, 1, 93.0);
  return tests;
}

SummaryRow make_row(const std::string& filter, Role role, const std::string& run, Index n) {
  return {filter, role, run,  23,    2.5, pattern(n, 1, 80.0), 0.9, 0.02, 0.03, 0.01, 0.04,
          0.51,   0.91, 0.96, 0.995, 0.1, not_a_number};
}

FreeRun make_free_run(Index n, Index samples, Index count) {
  FreeRun run;
  run.mean = pattern(n, samples, 60.0);
  run.deviation = pattern(n, samples, 61.0);
  run.lower = pattern(n, samples, 62.0);
  run.upper = pattern(n, samples, 63.0);
  run.mode = Eigen::VectorXi::Constant(samples, static_cast<int>(count) - 1);
  return run;
}

FreeRunRow make_free_run_row(const std::string& filter, Index n) {
  return {filter,
          Role::test,
          "*",
          8,
          18,
          1.5,
          pattern(n, 1, 64.0),
          pattern(n, 1, 65.0),
          pattern(n, 1, 66.0),
          share_pattern(n, 1, 67.0),
          share_pattern(n, 1, 68.0),
          share_pattern(n, 1, 69.0),
          share_pattern(n, 1, 70.0),
          3};
}

DiagnosticsRow make_diagnostics(const std::string& filter, Index mode, Index n) {
  DiagnosticsRow row{filter, Role::test, mode, 23,    0.25, 0.5, 12.5, 20.0, 0.51, 0.47, 0.55,  0.91, 0.88, 0.93,
                     0.96,   0.94,       0.97, 0.995, 0.98, 1.0, 0.03, 0.01, 0.06, 0.02, 0.005, 0.05, 1.1,  2.1};
  row.state_rmse = pattern(n, 1, 85.0);
  row.whiteness_p = 0.4;
  row.autocorrelation = 0.63;
  row.autocorrelation_lag = 5;
  row.verdict = Calibration::overconfident;
  row.reason = CalibrationReason::band;
  row.flags = "probabilities flat; heavy tails";
  return row;
}

Finding make_finding() {
  Finding finding;
  finding.answer = Answer::no_evidence;
  finding.role = Role::test;
  finding.runs = 3;
  finding.modes = 3;
  finding.gains = {{"baseline", 30, 1.25, 0.25, 5.0, 0.5, false, 0.03125},
                   {"one_motion", 29, -0.125, 0.0625, 11.0, 0.125, true, 0.75}};
  finding.best_competitor = "one_motion";
  finding.gain = -0.125;
  finding.standard_error = 0.0625;
  finding.description = Description::one_linear_motion;
  finding.stay = 7.5;
  finding.stay_asked = 5.0;
  finding.terms_asked = true;
  finding.pattern = {0.015625, 0.0078125};
  finding.better_description = "noise_only";
  finding.better_means = {{"noise_only", 10, "wz", 0.5, 0.25}};
  finding.text = "3 held-out runs show no evidence for modes of motion.";
  return finding;
}

}  // namespace

void add_evaluation(Archive& archive) {
  const Index n = archive.recording->state_count(), m = archive.recording->input_count();
  archive.finding = make_finding();
  for (const char* filter : {"bank", "baseline", "noise_only", "one_motion"}) {
    FilterEvaluation evaluation{filter, {}};
    const Index count = evaluation.filter == "baseline" ? 1 : archive.bank->mode_count();
    for (const Trajectory& run : archive.recording->runs)
      evaluation.runs.push_back(make_evaluation(n, run.samples(), count));
    archive.evaluations.push_back(evaluation);
    archive.summary.push_back(make_row(filter, Role::train, "run 2", n));
    archive.summary.push_back(make_row(filter, Role::test, "*", n));
    for (const Trajectory& run : archive.recording->runs)
      archive.evaluations.back().free_runs.push_back(make_free_run(n, run.samples(), count));
    archive.free_runs.push_back(make_free_run_row(filter, n));
    archive.horizons.push_back({filter, Role::test, "*", 5, 18, 1.5, pattern(n, 1, 84.0), 0.93});
    archive.diagnostics.push_back(make_diagnostics(filter, count - 1, n));
  }
  archive.horizons.push_back({"combined", Role::test, "*", 5, 18, 1.75, pattern(n, 1, 85.0), 0.94});
  archive.combination = {{Role::test, 5, "bank", 0.75, 0.5}, {Role::test, 5, "baseline", 0.25, 0.5}};
  archive.left_out = {{"bank", 5, 17, 1.25, pattern(n, 1, 86.0), 0.5},
                      {"baseline", 5, 17, 1.0, pattern(n, 1, 87.0), 0.5}};
  for (const char* model : {"global", "bank"}) {
    archive.residual_tests.push_back({model, {}});
    for (Index r = 0; r < 3; ++r) archive.residual_tests.back().runs.push_back(make_residual_tests(n, m, r));
  }
}

}  // namespace modebank::test
