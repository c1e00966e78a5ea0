#include "tests/io/archive/archive_compare.hpp"

#include <cstring>
#include <tuple>

namespace modebank::test {

namespace {

using test::expect_same;  // needed in addition to the overloads in this file

void expect_same(const SummaryRow& a, const SummaryRow& e) {
  EXPECT_EQ(a.filter, e.filter);
  EXPECT_EQ(a.role, e.role);
  EXPECT_EQ(a.run, e.run);
  EXPECT_EQ(a.samples, e.samples);
  EXPECT_TRUE(same_bits(a.rmse, e.rmse));
  const auto reals = [](const SummaryRow& r) {
    Eigen::VectorXd values(12);
    values << r.log_score, r.nis_mean, r.nis_above, r.nis_below, r.too_far, r.too_close, r.pit_distance, r.whiteness_p,
        r.coverage_50, r.coverage_90, r.coverage_95, r.coverage_99;
    return values;
  };
  EXPECT_TRUE(same_bits(reals(a), reals(e)));
}

void expect_same(const PairedGain& actual, const PairedGain& expected) {
  EXPECT_EQ(actual.competitor, expected.competitor);
  EXPECT_EQ(actual.samples, expected.samples);
  EXPECT_EQ(actual.gain, expected.gain);
  EXPECT_EQ(actual.standard_error, expected.standard_error);
  EXPECT_EQ(actual.degrees_of_freedom, expected.degrees_of_freedom);
  EXPECT_EQ(actual.margin, expected.margin);
  EXPECT_EQ(actual.by_blocks, expected.by_blocks);
  EXPECT_EQ(actual.rank_p, expected.rank_p);
}

void expect_same_drifting(const Bank& actual, const Bank& expected) {
  EXPECT_EQ(actual.structure, expected.structure);
  EXPECT_EQ(actual.state_names, expected.state_names);
  EXPECT_EQ(actual.input_names, expected.input_names);
  EXPECT_EQ(actual.dt_s, expected.dt_s);
  EXPECT_TRUE(same_bits(actual.theta(0), expected.theta(0)));
  EXPECT_TRUE(same_bits(actual.noise_variance(), expected.noise_variance()));
  EXPECT_TRUE(same_bits(actual.drift.scale, expected.drift.scale));
  EXPECT_EQ(actual.drift.rates, expected.drift.rates);
  EXPECT_EQ(actual.drift.wandering, expected.drift.wandering);
  EXPECT_EQ(actual.drift.tuning.log_score, expected.drift.tuning.log_score);
  EXPECT_EQ(actual.drift.tuning.samples, expected.drift.tuning.samples);
  EXPECT_EQ(actual.running_noise.lam, expected.running_noise.lam);
  EXPECT_EQ(actual.running_noise.nu, expected.running_noise.nu);
  EXPECT_TRUE(same_bits(actual.running_noise.floor, expected.running_noise.floor));
  EXPECT_EQ(actual.running_noise.horizon_factor, expected.running_noise.horizon_factor);
}

void expect_same(const Finding& actual, const Finding& expected) {
  EXPECT_EQ(actual.answer, expected.answer);
  EXPECT_EQ(actual.role, expected.role);
  EXPECT_EQ(actual.runs, expected.runs);
  EXPECT_EQ(actual.modes, expected.modes);
  EXPECT_EQ(actual.modes_differ, expected.modes_differ);
  EXPECT_EQ(actual.best_competitor, expected.best_competitor);
  EXPECT_EQ(actual.gain, expected.gain);
  EXPECT_EQ(actual.standard_error, expected.standard_error);
  EXPECT_EQ(actual.description, expected.description);
  EXPECT_EQ(actual.stay, expected.stay);
  EXPECT_EQ(actual.stay_asked, expected.stay_asked);
  EXPECT_EQ(actual.terms_asked, expected.terms_asked);
  EXPECT_EQ(actual.pattern.gain, expected.pattern.gain);
  EXPECT_EQ(actual.pattern.standard_error, expected.pattern.standard_error);
  EXPECT_EQ(actual.better_description, expected.better_description);
  EXPECT_EQ(actual.equations, expected.equations);
  EXPECT_EQ(actual.text, expected.text);
  ASSERT_EQ(actual.gains.size(), expected.gains.size());
  for (std::size_t i = 0; i < actual.gains.size(); ++i) expect_same(actual.gains[i], expected.gains[i]);
  ASSERT_EQ(actual.better_means.size(), expected.better_means.size());
  for (std::size_t i = 0; i < actual.better_means.size(); ++i) {
    EXPECT_EQ(actual.better_means[i].competitor, expected.better_means[i].competitor);
    EXPECT_EQ(actual.better_means[i].horizon, expected.better_means[i].horizon);
    EXPECT_EQ(actual.better_means[i].state, expected.better_means[i].state);
    EXPECT_EQ(actual.better_means[i].rmse_bank, expected.better_means[i].rmse_bank);
    EXPECT_EQ(actual.better_means[i].rmse, expected.better_means[i].rmse);
  }
}

void expect_same(const FreeRun& actual, const FreeRun& expected) {
  EXPECT_TRUE(same_bits(actual.mean, expected.mean));
  EXPECT_TRUE(same_bits(actual.deviation, expected.deviation));
  EXPECT_TRUE(same_bits(actual.lower, expected.lower));
  EXPECT_TRUE(same_bits(actual.upper, expected.upper));
  EXPECT_EQ(actual.mode, expected.mode);
}

void expect_same(const FreeRunRow& actual, const FreeRunRow& expected) {
  EXPECT_EQ(actual.filter, expected.filter);
  EXPECT_EQ(actual.role, expected.role);
  EXPECT_EQ(actual.run, expected.run);
  EXPECT_EQ(actual.method, expected.method);
  EXPECT_EQ(actual.start, expected.start);
  EXPECT_EQ(actual.samples, expected.samples);
  EXPECT_EQ(actual.log_score, expected.log_score);
  for (const auto member : {&FreeRunRow::rmse, &FreeRunRow::nrmse, &FreeRunRow::fit, &FreeRunRow::coverage_50,
                            &FreeRunRow::coverage_90, &FreeRunRow::coverage_95, &FreeRunRow::coverage_99})
    EXPECT_TRUE(same_bits(actual.*member, expected.*member));
  EXPECT_EQ(actual.lost_paths, expected.lost_paths);
}

void expect_same(const HorizonRow& actual, const HorizonRow& expected) {
  EXPECT_EQ(actual.filter, expected.filter);
  EXPECT_EQ(actual.role, expected.role);
  EXPECT_EQ(actual.run, expected.run);
  EXPECT_EQ(actual.horizon, expected.horizon);
  EXPECT_EQ(actual.samples, expected.samples);
  EXPECT_EQ(actual.log_score, expected.log_score);
  EXPECT_TRUE(same_bits(actual.rmse, expected.rmse));
  EXPECT_EQ(actual.coverage_95, expected.coverage_95);
}

void expect_same(const DiagnosticsRow& actual, const DiagnosticsRow& expected) {
  EXPECT_EQ(actual.filter, expected.filter);
  EXPECT_EQ(actual.role, expected.role);
  EXPECT_EQ(actual.mode, expected.mode);
  EXPECT_EQ(actual.samples, expected.samples);
  for (const auto member : {&DiagnosticsRow::usage,
                            &DiagnosticsRow::entropy,
                            &DiagnosticsRow::dwell,
                            &DiagnosticsRow::dwell_model,
                            &DiagnosticsRow::coverage_50,
                            &DiagnosticsRow::coverage_50_lower,
                            &DiagnosticsRow::coverage_50_upper,
                            &DiagnosticsRow::coverage_90,
                            &DiagnosticsRow::coverage_90_lower,
                            &DiagnosticsRow::coverage_90_upper,
                            &DiagnosticsRow::coverage_95,
                            &DiagnosticsRow::coverage_95_lower,
                            &DiagnosticsRow::coverage_95_upper,
                            &DiagnosticsRow::coverage_99,
                            &DiagnosticsRow::coverage_99_lower,
                            &DiagnosticsRow::coverage_99_upper,
                            &DiagnosticsRow::too_far,
                            &DiagnosticsRow::too_far_lower,
                            &DiagnosticsRow::too_far_upper,
                            &DiagnosticsRow::too_close,
                            &DiagnosticsRow::too_close_lower,
                            &DiagnosticsRow::too_close_upper,
                            &DiagnosticsRow::nis_mean,
                            &DiagnosticsRow::nees_mean,
                            &DiagnosticsRow::whiteness_p,
                            &DiagnosticsRow::autocorrelation})
    EXPECT_EQ(actual.*member, expected.*member);
  EXPECT_TRUE(same_bits(actual.state_rmse, expected.state_rmse));
  EXPECT_EQ(actual.autocorrelation_lag, expected.autocorrelation_lag);
  EXPECT_EQ(actual.verdict, expected.verdict);
  EXPECT_EQ(actual.flags, expected.flags);
}

void expect_same(const Provenance& actual, const Provenance& expected) {
  EXPECT_EQ(actual.modebank_version, expected.modebank_version);
  EXPECT_EQ(actual.created, expected.created);
  EXPECT_EQ(actual.command_line, expected.command_line);
  EXPECT_EQ(actual.config_hash, expected.config_hash);
  EXPECT_EQ(actual.data_hash, expected.data_hash);
  EXPECT_EQ(actual.versions, expected.versions);
  ASSERT_EQ(actual.inputs.size(), expected.inputs.size());
  for (std::size_t i = 0; i < actual.inputs.size(); ++i) {
    EXPECT_EQ(actual.inputs[i].path, expected.inputs[i].path);
    EXPECT_EQ(actual.inputs[i].bytes, expected.inputs[i].bytes);
    EXPECT_EQ(actual.inputs[i].sha256, expected.inputs[i].sha256);
  }
}

template <class T>
void expect_same_part(const std::optional<T>& actual, const std::optional<T>& expected, const char* part) {
  SCOPED_TRACE(part);
  ASSERT_EQ(actual.has_value(), expected.has_value());
  if (actual) expect_same(*actual, *expected);
}

}  // namespace

::testing::AssertionResult same_bits(const Eigen::MatrixXd& actual, const Eigen::MatrixXd& expected) {
  if (actual.rows() != expected.rows() || actual.cols() != expected.cols())
    return ::testing::AssertionFailure() << "shape " << actual.rows() << " x " << actual.cols() << ", expected "
                                         << expected.rows() << " x " << expected.cols();
  for (Index j = 0; j < actual.cols(); ++j)
    for (Index i = 0; i < actual.rows(); ++i)
      if (std::memcmp(&actual(i, j), &expected(i, j), sizeof(double)) != 0)
        return ::testing::AssertionFailure()
               << "at (" << i << ", " << j << "): " << actual(i, j) << ", expected " << expected(i, j);
  return ::testing::AssertionSuccess();
}

void expect_same(const RunEvaluation& a, const RunEvaluation& e) {
  EXPECT_TRUE(same_bits(a.prediction, e.prediction));
  EXPECT_TRUE(same_bits(a.innovation, e.innovation));
  EXPECT_TRUE(same_bits(a.innovation_covariance, e.innovation_covariance));
  EXPECT_TRUE(same_bits(a.state, e.state));
  EXPECT_TRUE(same_bits(a.covariance, e.covariance));
  EXPECT_TRUE(same_bits(a.nis, e.nis));
  EXPECT_TRUE(same_bits(a.pit, e.pit));
  EXPECT_TRUE(same_bits(a.log_density, e.log_density));
  EXPECT_TRUE(same_bits(a.mode_probability_predicted, e.mode_probability_predicted));
  EXPECT_TRUE(same_bits(a.mode_probability, e.mode_probability));
  EXPECT_TRUE(same_bits(a.spread_share, e.spread_share));
  EXPECT_TRUE(same_bits(a.smoothed_state, e.smoothed_state));
  EXPECT_TRUE(same_bits(a.smoothed_covariance, e.smoothed_covariance));
  EXPECT_EQ(a.viterbi_mode, e.viterbi_mode);
}

void expect_same(const Bank& actual, const Bank& expected) {
  EXPECT_EQ(actual.structure, expected.structure);
  ASSERT_EQ(actual.modes.size(), expected.modes.size());
  for (std::size_t k = 0; k < actual.modes.size(); ++k) {
    const Mode &a = actual.modes[k], &e = expected.modes[k];
    EXPECT_TRUE(same_bits(a.model.A, e.model.A));
    EXPECT_TRUE(same_bits(a.model.B, e.model.B));
    EXPECT_TRUE(same_bits(a.model.c, e.model.c));
    EXPECT_TRUE(same_bits(a.Q, e.Q));
    EXPECT_TRUE(same_bits(a.parameter_covariance, e.parameter_covariance));
    EXPECT_TRUE(same_bits(a.standard_error, e.standard_error));
    EXPECT_TRUE(same_bits(a.Q_standard_error, e.Q_standard_error));
    EXPECT_TRUE(same_bits(a.bend, e.bend));
    EXPECT_TRUE(same_bits(a.bend_standard_error, e.bend_standard_error));
    EXPECT_EQ(a.weight, e.weight);
  }
  EXPECT_EQ(actual.terms.terms, expected.terms.terms);
  EXPECT_TRUE(same_bits(actual.terms.direction, expected.terms.direction));
  EXPECT_TRUE(same_bits(actual.terms.low, expected.terms.low));
  EXPECT_TRUE(same_bits(actual.terms.high, expected.terms.high));
  EXPECT_TRUE(same_bits(actual.terms.unit, expected.terms.unit));
  EXPECT_TRUE(same_bits(actual.C, expected.C));
  EXPECT_TRUE(same_bits(actual.R, expected.R));
  EXPECT_TRUE(same_bits(actual.transition.matrix(), expected.transition.matrix()));
  EXPECT_TRUE(same_bits(actual.transition_logit.weights, expected.transition_logit.weights));
  EXPECT_TRUE(same_bits(actual.transition_logit.reference, expected.transition_logit.reference));
  EXPECT_TRUE(same_bits(actual.transition_weight_error, expected.transition_weight_error));
  EXPECT_TRUE(same_bits(actual.initial_probability, expected.initial_probability));
  EXPECT_TRUE(same_bits(actual.R_standard_error, expected.R_standard_error));
  EXPECT_TRUE(same_bits(actual.transition_standard_error, expected.transition_standard_error));
  EXPECT_EQ(actual.noise_adaptation.forgetting, expected.noise_adaptation.forgetting);
  EXPECT_EQ(actual.noise_adaptation.prior_samples, expected.noise_adaptation.prior_samples);
  EXPECT_TRUE(same_bits(actual.noise_factor.directions, expected.noise_factor.directions));
  EXPECT_TRUE(same_bits(actual.noise_factor.weights, expected.noise_factor.weights));
  EXPECT_EQ(actual.noise_factor.offset, expected.noise_factor.offset);
  EXPECT_TRUE(same_bits(actual.drift.scale, expected.drift.scale));
  EXPECT_EQ(actual.drift.rates, expected.drift.rates);
  EXPECT_EQ(actual.state_names, expected.state_names);
  EXPECT_EQ(actual.input_names, expected.input_names);
  EXPECT_EQ(actual.dt_s, expected.dt_s);
  ASSERT_EQ(actual.screened.size(), expected.screened.size());
  for (std::size_t i = 0; i < actual.screened.size(); ++i) {
    EXPECT_EQ(actual.screened[i].component, expected.screened[i].component);
    EXPECT_EQ(actual.screened[i].weight, expected.screened[i].weight);
    EXPECT_EQ(actual.screened[i].spectral_radius, expected.screened[i].spectral_radius);
    EXPECT_EQ(actual.screened[i].reason, expected.screened[i].reason);
  }
}

namespace {

void expect_same_labels(const Archive& actual, const Archive& expected) {
  ASSERT_EQ(actual.labels.has_value(), expected.labels.has_value());
  if (actual.labels) {
    EXPECT_EQ(actual.labels->names, expected.labels->names);
    EXPECT_EQ(actual.labels->of_runs, expected.labels->of_runs);
  }
  const auto row = [](const ConfusionRow& r) {
    return std::tuple(r.filter, r.role, r.label, r.mode, r.samples, r.share);
  };
  ASSERT_EQ(actual.confusion.size(), expected.confusion.size());
  for (std::size_t i = 0; i < actual.confusion.size(); ++i)
    EXPECT_EQ(row(actual.confusion[i]), row(expected.confusion[i]));
}

}  // namespace

void expect_same(const Archive& actual, const Archive& expected) {
  expect_same(actual.provenance, expected.provenance);
  EXPECT_EQ(actual.config, expected.config);
  expect_same_part(actual.recording, expected.recording, "recording");
  expect_same_part(actual.lag, expected.lag, "lag");
  expect_same_part(actual.windows, expected.windows, "windows");
  expect_same_part(actual.mixture, expected.mixture, "mixture");
  expect_same_part(actual.bank, expected.bank, "bank");
  EXPECT_EQ(actual.measured_fit, expected.measured_fit);
  EXPECT_EQ(actual.learned_transitions, expected.learned_transitions);
  EXPECT_EQ(actual.mode_names, expected.mode_names);
  expect_same_labels(actual, expected);
  expect_same_part(actual.unrefined, expected.unrefined, "unrefined");
  expect_same_part(actual.baseline, expected.baseline, "baseline");
  expect_same_part(actual.noise_only, expected.noise_only, "noise_only");
  expect_same_part(actual.one_motion, expected.one_motion, "one_motion");
  EXPECT_EQ(actual.drifting.has_value(), expected.drifting.has_value());
  if (actual.drifting && expected.drifting) expect_same_drifting(*actual.drifting, *expected.drifting);
  expect_same_part(actual.nonlinear, expected.nonlinear, "nonlinear");
  expect_same_part(actual.finding, expected.finding, "finding");
  ASSERT_EQ(actual.evaluations.size(), expected.evaluations.size());
  for (std::size_t f = 0; f < actual.evaluations.size(); ++f) {
    EXPECT_EQ(actual.evaluations[f].filter, expected.evaluations[f].filter);
    ASSERT_EQ(actual.evaluations[f].runs.size(), expected.evaluations[f].runs.size());
    for (std::size_t r = 0; r < actual.evaluations[f].runs.size(); ++r)
      expect_same(actual.evaluations[f].runs[r], expected.evaluations[f].runs[r]);
    ASSERT_EQ(actual.evaluations[f].free_runs.size(), expected.evaluations[f].free_runs.size());
    for (std::size_t r = 0; r < actual.evaluations[f].free_runs.size(); ++r)
      expect_same(actual.evaluations[f].free_runs[r], expected.evaluations[f].free_runs[r]);
  }
  ASSERT_EQ(actual.residual_tests.size(), expected.residual_tests.size());
  for (std::size_t s = 0; s < actual.residual_tests.size(); ++s) {
    EXPECT_EQ(actual.residual_tests[s].model, expected.residual_tests[s].model);
    ASSERT_EQ(actual.residual_tests[s].runs.size(), expected.residual_tests[s].runs.size());
    for (std::size_t r = 0; r < actual.residual_tests[s].runs.size(); ++r)
      expect_same(actual.residual_tests[s].runs[r], expected.residual_tests[s].runs[r]);
  }
  ASSERT_EQ(actual.summary.size(), expected.summary.size());
  for (std::size_t i = 0; i < actual.summary.size(); ++i) expect_same(actual.summary[i], expected.summary[i]);
  ASSERT_EQ(actual.free_runs.size(), expected.free_runs.size());
  for (std::size_t i = 0; i < actual.free_runs.size(); ++i) expect_same(actual.free_runs[i], expected.free_runs[i]);
  ASSERT_EQ(actual.horizons.size(), expected.horizons.size());
  for (std::size_t i = 0; i < actual.horizons.size(); ++i) expect_same(actual.horizons[i], expected.horizons[i]);
  const auto combined = [](const CombinationRow& r) {
    return std::tuple(r.role, r.horizon, r.filter, r.weight, r.start);
  };
  ASSERT_EQ(actual.combination.size(), expected.combination.size());
  for (std::size_t i = 0; i < actual.combination.size(); ++i)
    EXPECT_EQ(combined(actual.combination[i]), combined(expected.combination[i]));
  const auto left_out = [](const LeftOutRow& r) {
    return std::tuple(r.filter, r.horizon, r.samples, r.log_score, r.rmse, r.start);
  };
  ASSERT_EQ(actual.left_out.size(), expected.left_out.size());
  for (std::size_t i = 0; i < actual.left_out.size(); ++i)
    EXPECT_EQ(left_out(actual.left_out[i]), left_out(expected.left_out[i]));
  ASSERT_EQ(actual.diagnostics.size(), expected.diagnostics.size());
  for (std::size_t i = 0; i < actual.diagnostics.size(); ++i)
    expect_same(actual.diagnostics[i], expected.diagnostics[i]);
}

}  // namespace modebank::test
