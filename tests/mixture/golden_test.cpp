// Comparison with scikit-learn (fits) and mpmath (densities); tests/golden/generate/mixture.py generated the golden
// file.
#include "tests/support/golden.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "mixture/em.hpp"
#include "tests/support/matrix_compare.hpp"

namespace modebank::test {
namespace {

using nlohmann::json;

/// Allows sums of about a thousand terms in another order. The test compares algorithms, not rounding.
constexpr double parameter_tolerance = 1e-8;
constexpr double log_likelihood_tolerance = 1e-8;
/// Allows a few units in the last place of the log density, which reaches -1e12 at the outermost probe.
constexpr double relative_density_tolerance = 2e-15;
/// A responsibility other than 0 or 1 is the exponential of a difference of log densities, up to a few hundred.
constexpr double responsibility_tolerance = 1e-13;

GaussianMixture mixture(const json& values) {
  GaussianMixture result;
  result.weights = golden_rows(values["weights"]);
  result.means = golden_columns(values["means"]);
  for (const json& covariance : values["covariances"]) result.covariances.push_back(golden_rows(covariance));
  return result;
}

TEST(MixtureGolden, FitsAgreeWithScikitLearnFromTheSameStart) {
  const json file = read_golden("mixture");
  const Eigen::MatrixXd points = golden_columns(file["points"]);
  ASSERT_EQ(file["fits"].size(), 6u);
  for (const json& expected : file["fits"]) {
    SCOPED_TRACE(expected["covariance"].get<std::string>() + " " + expected["iterations"].dump());
    EmOptions options;
    options.covariance = expected["covariance"] == "full" ? CovarianceType::full : CovarianceType::diagonal;
    options.tolerance = -1.0;  // does not converge, so the number of iterations is fixed
    options.max_iterations = expected["iterations"].get<int>();
    options.covariance_floor = 1e-10;
    const EmResult fit = fit_em(points, Eigen::VectorXd(), mixture(file["start"]), options);
    EXPECT_FALSE(fit.floor_active);
    EXPECT_EQ(fit.iterations, options.max_iterations);
    EXPECT_NEAR(fit.log_likelihood, expected["log_likelihood"].get<double>(), log_likelihood_tolerance);
    const GaussianMixture reference = mixture(expected);
    EXPECT_TRUE(near(fit.mixture.weights, reference.weights, parameter_tolerance));
    // In units of each feature's standard deviation, because the standard deviations differ by a factor of 500.
    const Eigen::ArrayXd unit = reference.covariances[0].diagonal().array().sqrt();
    EXPECT_TRUE(near(fit.mixture.means.array().colwise() / unit, reference.means.array().colwise() / unit,
                     parameter_tolerance));
    for (Eigen::Index k = 0; k < reference.components(); ++k) {
      const Eigen::ArrayXXd difference = (fit.mixture.covariances[k] - reference.covariances[k]).array();
      const Eigen::ArrayXXd scaled = (difference.colwise() / unit).rowwise() / unit.transpose();
      EXPECT_TRUE(near(scaled, Eigen::Matrix3d::Zero(), parameter_tolerance)) << "component " << k;
    }
  }
}

TEST(MixtureGolden, DensitiesAndResponsibilitiesAgreeWithExtendedPrecision) {
  const json expected = read_golden("mixture")["density"];
  const GaussianMixture reference = mixture(expected);
  const Eigen::MatrixXd probes = golden_columns(expected["probes"]);
  const Eigen::VectorXd log_densities = golden_rows(expected["log_density"]);
  const Eigen::VectorXd relative =
      log_density(reference, probes).cwiseQuotient(log_densities) - Eigen::VectorXd::Ones(probes.cols());
  EXPECT_TRUE(near(relative, Eigen::VectorXd::Zero(probes.cols()), relative_density_tolerance));
  EXPECT_TRUE(near(responsibilities(reference, probes), golden_columns(expected["responsibilities"]),
                   responsibility_tolerance));
}

}  // namespace
}  // namespace modebank::test
