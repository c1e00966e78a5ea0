// Comparison with scikit-learn, R's mclust and an independent extreme deconvolution (fits), and with mpmath
// (densities); tests/golden/generate/{mixture.py,mclust.R,extreme_deconvolution.py} generated the golden files.
#include <numeric>

#include "modebank/base/eigen.hpp"
#include "modebank/mixture/mixture.hpp"
#include "tests/mixture/golden_mixture.hpp"

namespace modebank::test {
namespace {

using Eigen::Index;
using nlohmann::json;

/// Allows a few units in the last place of the log density, which reaches -1e12 at the outermost probe.
constexpr double relative_density_tolerance = 2e-15;
/// A responsibility other than 0 or 1 is the exponential of a difference of log densities, up to a few hundred.
constexpr double responsibility_tolerance = 1e-13;
constexpr double mclust_tolerance = 1e-5;  // relative

CovarianceType type_of(const std::string& name) {
  return name == "full" || name == "VVV" ? CovarianceType::full : CovarianceType::diagonal;
}

mixture::Mixture mixture_of(const json& golden) {
  mixture::Mixture result{
      to_vector(golden_rows(golden["weights"])), to_matrix(golden_columns(golden["means"])), {}, 0.0, {}, {}};
  for (const json& covariance : golden["covariances"]) result.covariances.push_back(to_matrix(golden_rows(covariance)));
  return result;
}

/// A fit with its components in our order, by decreasing weight.
json by_weight(const json& golden) {
  std::vector<std::size_t> order(golden["weights"].size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::sort(order, std::greater<>(), [&](std::size_t k) { return golden["weights"][k].get<double>(); });
  json result = golden;
  for (const char* key : {"weights", "means", "covariances"})
    for (std::size_t k = 0; k < order.size(); ++k) result[key][k] = golden[key][order[k]];
  return result;
}

/// The best fit of K components.
mixture::Clusters fit(const mixture::Points& points, Index components, EmOptions em) {
  return mixture::select(points, {{components}, em});
}

/// Fits after fewer iterations: em_test.cpp.
TEST(MixtureGolden, OptimaAreThoseOfIndependentPrograms) {
  for (const auto& [name, unit] : golden_mixtures) {
    const json file = read_golden(name);
    mixture::Points points{to_matrix(golden_columns(file["points"])), {}, {}, {}};
    if (file.contains("errors")) {
      points.weights = to_vector(golden_rows(file["importance"]));
      points.errors = to_matrix(golden_columns(file["errors"]));
    }
    for (const json& expected : file["fits"]) {
      if (expected["iterations"] < 300) continue;
      SCOPED_TRACE(name + expected["covariance"].get<std::string>());
      const EmOptions em{.covariance = type_of(expected["covariance"]),
                         .restarts = 2,
                         .split_merge = 0,
                         .tolerance = -1.0,
                         .covariance_floor = 1e-10};
      const mixture::Clusters found = fit(points, 3, em);
      std::vector<Eigen::MatrixXd> covariances;
      for (const Matrix& covariance : found.mixture.covariances) covariances.emplace_back(view(covariance));
      EXPECT_FALSE(found.candidates.at(0).floor_active);
      expect_golden_fit(by_weight(expected), found.candidates.at(0).log_likelihood, view(found.mixture.weights),
                        view(found.mixture.means), covariances, unit);
    }
  }
}

TEST(MixtureGolden, DensitiesAndResponsibilitiesAgreeWithExtendedPrecision) {
  const json expected = read_golden("mixture")["density"];
  const mixture::Mixture reference = mixture_of(expected);
  const Matrix probes = to_matrix(golden_columns(expected["probes"]));
  const Eigen::VectorXd log_densities = golden_rows(expected["log_density"]);
  const Eigen::VectorXd relative =
      view(mixture::log_density(reference, probes)).cwiseQuotient(log_densities) - Eigen::VectorXd::Ones(probes.cols);
  EXPECT_TRUE(near(relative, Eigen::VectorXd::Zero(probes.cols), relative_density_tolerance));
  EXPECT_TRUE(near(view(mixture::responsibilities(reference, probes)), golden_columns(expected["responsibilities"]),
                   responsibility_tolerance));
}

/// mclust's fits, which are local maxima of the likelihood and in half of the cases its largest one.
TEST(Mclust, MaximaAreStationaryHereAndNotHigher) {
  const json file = read_golden("mclust");
  int same_maxima = 0;
  for (const json& fitted : file["fits"]) {
    const json expected = by_weight(fitted);
    SCOPED_TRACE(expected["data"].get<std::string>() + " " + expected["model"].get<std::string>() + " " +
                 expected["components"].dump());
    const Eigen::MatrixXd points = golden_columns(file["data"][expected["data"].get<std::string>()]);
    const Eigen::VectorXd weights = golden_rows(expected["weights"]);
    const Eigen::MatrixXd means = golden_columns(expected["means"]);
    const auto near_golden = [&](double ours, const char* name, double sign) {
      const double value = sign * expected[name].get<double>();
      EXPECT_NEAR(ours, value, mclust_tolerance * std::abs(value)) << name;
    };
    const mixture::Mixture reference = mixture_of(expected);
    const Matrix responsibilities = mixture::responsibilities(reference, to_matrix(points));
    const Eigen::VectorXd members = view(responsibilities).rowwise().sum();
    near_golden(view(mixture::log_density(reference, to_matrix(points))).sum(), "log_likelihood", 1.0);
    EXPECT_TRUE(near(members / static_cast<double>(points.cols()), weights, 1e-4));
    EXPECT_TRUE(near(points * view(responsibilities).transpose() * members.cwiseInverse().asDiagonal(), means, 1e-2));

    const EmOptions em{.covariance = type_of(expected["model"]), .tolerance = 1e-13, .max_iterations = 20000};
    const mixture::Clusters found = fit({to_matrix(points), {}, {}}, weights.size(), em);
    const Candidate& row = found.candidates.at(0);
    const double slack = mclust_tolerance * std::abs(row.log_likelihood);
    EXPECT_EQ(row.parameters, expected["parameters"].get<Index>());
    EXPECT_GE(row.log_likelihood, expected["log_likelihood"].get<double>() - slack);
    if (row.log_likelihood > expected["log_likelihood"].get<double>() + slack) continue;
    ++same_maxima;
    EXPECT_TRUE(row.converged);
    near_golden(row.bic, "bic", -1.0);
    EXPECT_TRUE(near(view(found.mixture.weights), weights, 1e-4));
    EXPECT_TRUE(near(view(found.mixture.means), means, 1e-2));
  }
  EXPECT_EQ(same_maxima, 4);
}

}  // namespace
}  // namespace modebank::test
