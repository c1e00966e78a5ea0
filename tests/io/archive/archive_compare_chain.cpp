#include <cmath>

#include "tests/io/archive/archive_compare.hpp"

namespace modebank::test {
namespace {

void expect_same(const Candidate& a, const Candidate& e) {
  EXPECT_EQ(a.components, e.components);
  EXPECT_EQ(a.covariance, e.covariance);
  EXPECT_EQ(a.parameters, e.parameters);
  EXPECT_EQ(a.iterations, e.iterations);
  EXPECT_EQ(a.converged, e.converged);
  EXPECT_EQ(a.agreeing_restarts, e.agreeing_restarts);
  EXPECT_EQ(a.selected, e.selected);
  EXPECT_EQ(a.bic_naive, e.bic_naive);
  EXPECT_EQ(a.restarts, e.restarts);
  EXPECT_EQ(a.floor_active, e.floor_active);
  EXPECT_EQ(a.failed, e.failed);
  EXPECT_EQ(a.status, e.status);
  const auto reals = [](const Candidate& c) {
    return Eigen::Vector4d(c.log_likelihood, c.effective_samples, c.bic, c.aic);
  };
  EXPECT_TRUE(same_bits(reals(a), reals(e)));
}

}  // namespace

void expect_same(const ResidualTests& a, const ResidualTests& e) {
  EXPECT_EQ(a.samples, e.samples);
  EXPECT_EQ(a.level, e.level);
  EXPECT_EQ(a.autocorrelation_band, e.autocorrelation_band);
  EXPECT_TRUE(same_bits(a.autocorrelation, e.autocorrelation));
  EXPECT_TRUE(same_bits(a.cross_correlation, e.cross_correlation));
  EXPECT_TRUE(same_bits(a.cross_correlation_band, e.cross_correlation_band));
  EXPECT_TRUE(same_bits(a.ljung_box_p, e.ljung_box_p));
}

void expect_same(const Recording& actual, const Recording& expected) {
  const auto same_channels = [](const std::vector<Channel>& a, const std::vector<Channel>& e) {
    ASSERT_EQ(a.size(), e.size());
    for (std::size_t i = 0; i < a.size(); ++i) EXPECT_EQ(a[i].name, e[i].name);
    for (std::size_t i = 0; i < a.size(); ++i) EXPECT_EQ(a[i].unit, e[i].unit);
  };
  same_channels(actual.states, expected.states);
  same_channels(actual.inputs, expected.inputs);
  ASSERT_EQ(actual.runs.size(), expected.runs.size());
  for (std::size_t r = 0; r < actual.runs.size(); ++r) {
    const Trajectory &a = actual.runs[r], &e = expected.runs[r];
    EXPECT_EQ(a.run, e.run);
    EXPECT_EQ(a.role, e.role);
    EXPECT_EQ(a.lag_s, e.lag_s);
    EXPECT_TRUE(same_bits(a.time_s, e.time_s));
    EXPECT_EQ(a.time_origin_ns, e.time_origin_ns);
    EXPECT_TRUE(same_bits(a.state, e.state));
    EXPECT_TRUE(same_bits(a.input, e.input));
    EXPECT_TRUE(same_bits(a.truth, e.truth));
  }
}

void expect_same(const LagReport& actual, const LagReport& expected) {
  EXPECT_EQ(actual.correction, expected.correction);
  EXPECT_EQ(actual.lag.mean, expected.lag.mean);
  EXPECT_EQ(actual.lag.between_sd, expected.lag.between_sd);
  EXPECT_EQ(actual.lag.count, expected.lag.count);
  EXPECT_EQ(actual.lag.standard_error, expected.lag.standard_error);
  ASSERT_EQ(actual.scores.size(), expected.scores.size());
  EXPECT_EQ(actual.scores.back().correction, expected.scores.back().correction);
  EXPECT_EQ(actual.scores.back().gain_standard_error, expected.scores.back().gain_standard_error);
  ASSERT_EQ(actual.runs.size(), expected.runs.size());
  for (std::size_t r = 0; r < actual.runs.size(); ++r) {
    EXPECT_EQ(actual.runs[r].run, expected.runs[r].run);
    EXPECT_EQ(actual.runs[r].status, expected.runs[r].status);
    EXPECT_EQ(std::isnan(actual.runs[r].lag_s), std::isnan(expected.runs[r].lag_s));
    EXPECT_EQ(actual.runs[r].applied_lag_s, expected.runs[r].applied_lag_s);
  }
}

void expect_same(const WindowFits& actual, const WindowFits& expected) {
  EXPECT_EQ(actual.structure, expected.structure);
  EXPECT_EQ(actual.length, expected.length);
  EXPECT_EQ(actual.step, expected.step);
  EXPECT_EQ(actual.loss, expected.loss);
  ASSERT_EQ(actual.windows.size(), expected.windows.size());
  for (std::size_t i = 0; i < actual.windows.size(); ++i) {
    EXPECT_EQ(actual.windows[i].run, expected.windows[i].run);
    EXPECT_EQ(actual.windows[i].start, expected.windows[i].start);
  }
  EXPECT_TRUE(same_bits(actual.parameters, expected.parameters));
  EXPECT_TRUE(same_bits(actual.covariance, expected.covariance));
  EXPECT_TRUE(same_bits(actual.noise_variance, expected.noise_variance));
  EXPECT_TRUE(same_bits(actual.condition, expected.condition));
  EXPECT_EQ(actual.rank, expected.rank);
  EXPECT_TRUE(same_bits(actual.information, expected.information));
  EXPECT_TRUE(same_bits(actual.inlier_fraction, expected.inlier_fraction));
  EXPECT_EQ(actual.status, expected.status);
  EXPECT_TRUE(same_bits(actual.r_squared, expected.r_squared));
  EXPECT_TRUE(same_bits(actual.weighed_information, expected.weighed_information));
  EXPECT_EQ(actual.transitions, expected.transitions);
  EXPECT_TRUE(same_bits(actual.prior_sd, expected.prior_sd));
  EXPECT_TRUE(same_bits(actual.global.theta, expected.global.theta));
  EXPECT_TRUE(same_bits(actual.global.covariance, expected.global.covariance));
  EXPECT_TRUE(same_bits(actual.global.residual_covariance, expected.global.residual_covariance));
  EXPECT_EQ(actual.global.transitions, expected.global.transitions);
}

void expect_same(const MixtureResult& actual, const MixtureResult& expected) {
  EXPECT_TRUE(same_bits(actual.mixture.weights, expected.mixture.weights));
  EXPECT_TRUE(same_bits(actual.mixture.means, expected.mixture.means));
  ASSERT_EQ(actual.mixture.covariances.size(), expected.mixture.covariances.size());
  for (std::size_t k = 0; k < actual.mixture.covariances.size(); ++k)
    EXPECT_TRUE(same_bits(actual.mixture.covariances[k], expected.mixture.covariances[k]));
  EXPECT_EQ(actual.mixture.type, expected.mixture.type);
  EXPECT_EQ(actual.mixture.noise.weight, expected.mixture.noise.weight);
  EXPECT_TRUE(same_bits(actual.mixture.noise.lower, expected.mixture.noise.lower));
  EXPECT_TRUE(same_bits(actual.mixture.noise.upper, expected.mixture.noise.upper));
  EXPECT_EQ(actual.feature_names, expected.feature_names);
  EXPECT_EQ(actual.labels, expected.labels);
  EXPECT_TRUE(same_bits(actual.responsibilities.all(), expected.responsibilities.all()));
  ASSERT_EQ(actual.candidates.size(), expected.candidates.size());
  for (std::size_t i = 0; i < actual.candidates.size(); ++i) expect_same(actual.candidates[i], expected.candidates[i]);
}

}  // namespace modebank::test
