// Comparison with R's mclust; tests/golden/generate/mclust.R generated the golden file.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "mixture/criteria.hpp"
#include "mixture/em.hpp"
#include "tests/support/golden.hpp"
#include "tests/support/matrix_compare.hpp"

namespace modebank::test {
namespace {

using Eigen::Index;
using nlohmann::json;

constexpr double relative_tolerance = 1e-5;

EmOptions options_of(const json& fit) {
  EmOptions options;
  options.covariance = fit["model"] == "VVV" ? CovarianceType::full : CovarianceType::diagonal;
  options.tolerance = 1e-13;
  options.max_iterations = 20000;
  return options;
}

/// The moments of the classes from which mclust's EM starts.
GaussianMixture start_of(const json& fit, const Eigen::MatrixXd& points) {
  const auto labels = fit["classification"].get<std::vector<Index>>();
  const auto components = fit["components"].get<Index>();
  GaussianMixture start;
  start.weights.resize(components);
  start.means.resize(points.rows(), components);
  for (Index k = 0; k < components; ++k) {
    std::vector<Index> members;
    for (std::size_t i = 0; i < labels.size(); ++i)
      if (labels[i] == k) members.push_back(static_cast<Index>(i));
    const Eigen::MatrixXd own = points(Eigen::all, members);
    const auto count = static_cast<double>(members.size());
    start.weights(k) = count / static_cast<double>(points.cols());
    start.means.col(k) = own.rowwise().mean();
    const Eigen::MatrixXd offsets = own.colwise() - own.rowwise().mean();
    start.covariances.push_back(offsets * offsets.transpose() / count);
  }
  return start;
}

Candidate criteria_of(const EmResult& fit, const Eigen::MatrixXd& points) {
  Candidate row;
  row.log_likelihood = fit.log_likelihood;
  row.parameters = fit.mixture.parameter_count();
  row.effective_samples = static_cast<double>(points.cols());
  fill_criteria(row, row.effective_samples, classification_cost(fit.mixture, points));
  return row;
}

TEST(Mclust, SameMaximumFromTheSameClassification) {
  const json file = read_golden("mclust");
  ASSERT_EQ(file["fits"].size(), 8u);
  for (const json& expected : file["fits"]) {
    SCOPED_TRACE(expected["data"].get<std::string>() + " " + expected["model"].get<std::string>() + " " +
                 expected["components"].dump());
    const Eigen::MatrixXd points = golden_columns(file["data"][expected["data"].get<std::string>()]);
    const EmResult fit = fit_em(points, start_of(expected, points), options_of(expected));
    const Candidate row = criteria_of(fit, points);
    const auto near_golden = [&](double ours, const char* name, double sign) {
      const double value = sign * expected[name].get<double>();
      EXPECT_NEAR(ours, value, relative_tolerance * std::abs(value)) << name;
    };
    EXPECT_TRUE(fit.converged);
    EXPECT_EQ(row.parameters, expected["parameters"].get<Index>());
    near_golden(row.log_likelihood, "log_likelihood", 1.0);
    near_golden(row.bic, "bic", -1.0);
    near_golden(row.icl, "icl", -1.0);
    EXPECT_TRUE(near(fit.mixture.weights, golden_rows(expected["weights"]), 1e-4));
    EXPECT_TRUE(near(fit.mixture.means, golden_columns(expected["means"]), 1e-2));
  }
}

TEST(Mclust, OwnStartsReachAtLeastItsLikelihood) {
  const json file = read_golden("mclust");
  for (const json& expected : file["fits"]) {
    SCOPED_TRACE(expected["data"].get<std::string>() + " " + expected["model"].get<std::string>() + " " +
                 expected["components"].dump());
    const Eigen::MatrixXd points = golden_columns(file["data"][expected["data"].get<std::string>()]);
    EmOptions options = options_of(expected);
    options.tolerance = 1e-9;
    const double value = expected["log_likelihood"].get<double>();
    EXPECT_GE(fit_em(points, Eigen::VectorXd(), expected["components"].get<Index>(), options, 1).log_likelihood,
              value - relative_tolerance * std::abs(value));
  }
}

}  // namespace
}  // namespace modebank::test
