// Selection of the number of components, with and without windows; its warnings, and unusable clouds.
#include "mixture/select.hpp"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <limits>

#include "ident/base/not_a_number.hpp"
#include "mixture/criteria.hpp"
#include "modebank/base/error.hpp"
#include "tests/mixture/mixture_test_support.hpp"
#include "tests/support/matrix_compare.hpp"

namespace modebank::test {
namespace {

using Eigen::Index;

SelectionOptions up_to(Index most) {
  SelectionOptions options;
  options.components.clear();
  for (Index k = 1; k <= most; ++k) options.components.push_back(k);
  return options;
}

/// Number of components of the candidate that is selected. Exactly one is.
Index selected(const std::vector<Candidate>& candidates) {
  EXPECT_EQ(std::ranges::count(candidates, true, &Candidate::selected), 1);
  return std::ranges::find(candidates, true, &Candidate::selected)->components;
}

TEST(EffectiveSamples, CountsByHand) {
  FeatureCloud cloud;
  // N_eff for runs of 100, 10 and 30 windows with L = 25 and step 1: 4 + max(1, 0.4) + 1.2.
  for (const auto& [run, windows] : {std::pair<Index, int>{0, 100}, {3, 10}, {5, 30}})
    cloud.runs.insert(cloud.runs.end(), static_cast<std::size_t>(windows), run);
  EXPECT_DOUBLE_EQ(effective_samples(cloud, 25, 1), 4.0 + 1.0 + 1.2);
  EXPECT_DOUBLE_EQ(effective_samples(cloud, 25, 5), 20.0 + 2.0 + 6.0);
  EXPECT_DOUBLE_EQ(effective_samples(cloud, 25, 50), 140.0);  // windows do not overlap, so each one counts as
                                                              // independent
}

TEST(Criteria, FormulasByHand) {
  Candidate row;
  row.log_likelihood = -1000.0;
  row.parameters = 11;
  row.effective_samples = 50.0;
  fill_criteria(row, 200);
  EXPECT_DOUBLE_EQ(row.bic, 500.0 + 11.0 * std::log(50.0));
  EXPECT_DOUBLE_EQ(row.aic, 500.0 + 22.0);
  EXPECT_DOUBLE_EQ(row.bic_naive, 2000.0 + 11.0 * std::log(200.0));
}

TEST(Criteria, TiesGoToTheFirstAndNonFiniteRowsAreSkipped) {
  std::vector<Candidate> rows(4);
  rows[0].bic = not_a_number;
  rows[1].bic = 5.0;
  rows[2].bic = 5.0;
  rows[3].bic = -std::numeric_limits<double>::infinity();
  EXPECT_EQ(best_candidate(rows), 1);
  rows.resize(1);
  EXPECT_EQ(best_candidate(rows), -1);
}

TEST(Select, TableRowsAgreeWithTheMixtures) {
  const FeatureCloud cloud = cloud_of(draw(three_clusters(3.0), 600, 2), 4);
  const MixtureResult result = select_mixture(fits_of(cloud, 25, 1), cloud, up_to(3), 1);
  ASSERT_EQ(result.candidates.size(), 3u);
  for (const Candidate& row : result.candidates) {
    EXPECT_DOUBLE_EQ(row.effective_samples, 24.0);  // 4 runs of 150 windows with L = 25: 4 x 150 / 25
    EXPECT_EQ(row.parameters, row.components - 1 + 5 * row.components);
    const double share = 24.0 / 600.0, q = static_cast<double>(row.parameters);
    EXPECT_NEAR(row.bic, -2.0 * share * row.log_likelihood + q * std::log(24.0), 1e-9);
    EXPECT_NEAR(row.aic, -2.0 * share * row.log_likelihood + 2.0 * q, 1e-9);
    EXPECT_TRUE(row.converged);
    if (row.selected) {
      EXPECT_NEAR(row.log_likelihood, log_density(result.mixture, cloud.points).sum(), 1e-7);
    }
  }
}

TEST(Select, MembershipsCoverClusteredWindowsOnly) {
  FeatureCloud cloud = cloud_of(draw(three_clusters(12.0), 300, 3), 3);
  WindowFits fits = fits_of(cloud, 1, 1);
  for (Index& window : cloud.windows) window = 2 * window;  // only every other window is in the cloud
  fits.windows.resize(600);
  const MixtureResult result = select_mixture(fits, cloud, up_to(4), 1);
  ASSERT_EQ(result.labels.size(), 600);
  ASSERT_EQ(result.responsibilities.windows(), 600);
  const Eigen::MatrixXd responsibilities = result.responsibilities.all();
  EXPECT_EQ(responsibilities.middleCols(298, 4).leftCols(1), result.responsibilities.block(298, 4).leftCols(1));
  for (Index i = 0; i < 300; ++i) {
    Index most_likely = -1;
    responsibilities.col(2 * i).maxCoeff(&most_likely);
    EXPECT_EQ(result.labels(2 * i), most_likely);
    EXPECT_NEAR(responsibilities.col(2 * i).sum(), 1.0, 1e-14);
    EXPECT_EQ(result.labels(2 * i + 1), -1);
    EXPECT_TRUE(responsibilities.col(2 * i + 1).array().isNaN().all());
  }
}

/// Windows that are not clustered get the posterior probabilities under N(mean, covariance + error). This test computes
/// these probabilities independently.
TEST(Select, AssignedWindowsGetTheComponentsThatSuitThem) {
  FeatureCloud cloud = cloud_of(draw(three_clusters(6.0), 300, 3), 3);
  for (Index i = 0; i < 300; ++i) cloud.windows[i] = i + 2;
  FeatureCloud assigned;
  assigned.points = (Eigen::MatrixXd(2, 2) << 6.0, 0.0, 50.0, 1.0).finished();
  assigned.covariances = Eigen::MatrixXd::Zero(4, 2);
  assigned.covariances(3, 0) = 1e4;  // an error so large that this feature is unknown
  assigned.windows = {0, 302};
  assigned.runs = {0, 2};
  WindowFits fits = fits_of(cloud, 25, 1);
  fits.windows.resize(303, {2, 0});
  const MixtureResult result = select_mixture(fits, cloud, up_to(3), 1, nullptr, assigned);
  const MixtureResult without = select_mixture(fits, cloud, up_to(3), 1);
  EXPECT_EQ(result.clustered, 300);
  EXPECT_EQ(result.mixture.means, without.mixture.means) << "they take no part";
  EXPECT_EQ(without.labels(0), -1);
  const Eigen::MatrixXd all = result.responsibilities.all();
  EXPECT_TRUE(all.col(1).array().isNaN().all()) << "neither clustered nor assigned";
  EXPECT_EQ(all.middleCols(2, 300), without.responsibilities.all().middleCols(2, 300));
  for (const Index i : {Index{0}, Index{1}}) {
    Eigen::VectorXd expected(result.mixture.components());
    for (Index k = 0; k < expected.size(); ++k) {
      const Eigen::Matrix2d S =
          result.mixture.covariances[k] + Eigen::Matrix2d(assigned.covariances.col(i).reshaped(2, 2));
      const Eigen::Vector2d d = assigned.points.col(i) - result.mixture.means.col(k);
      expected(k) = result.mixture.weights(k) * std::exp(-0.5 * d.dot(S.inverse() * d)) / std::sqrt(S.determinant());
    }
    expected /= expected.sum();
    const Index window = assigned.windows[i];
    EXPECT_TRUE(near(all.col(window), expected, 1e-12));
    Index most_likely = -1;
    expected.maxCoeff(&most_likely);
    EXPECT_EQ(result.labels(window), most_likely);
  }
}

TEST(Select, OtherCandidatesDoNotChangeARow) {
  const FeatureCloud cloud = cloud_of(draw(three_clusters(1.0), 300, 4), 3);
  SelectionOptions alone;
  alone.components = {4};
  const MixtureResult all = select_mixture(fits_of(cloud, 25, 1), cloud, up_to(5), 9);
  const MixtureResult one = select_mixture(fits_of(cloud, 25, 1), cloud, alone, 9);
  EXPECT_EQ(one.candidates[0].log_likelihood, all.candidates[3].log_likelihood);
  EXPECT_EQ(one.candidates[0].iterations, all.candidates[3].iterations);
}

/// 120,000 points of three clusters. The number of components is chosen on a part of the points, and the mixture is
/// fitted to all points. The number of threads has no effect.
TEST(Select, OfManyPointsAPartIsComparedAndAllAreFitted) {
  const FeatureCloud cloud = cloud_of(draw(three_clusters(6.0), 120'000, 8), 4);
  SelectionOptions options = up_to(4);
  options.em.restarts = 2;
  const auto chosen = [&](std::size_t threads, std::uint64_t seed) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    return select_mixture(fits_of(cloud, 25, 1), cloud, options, seed);
  };
  const MixtureResult result = chosen(1, 1), again = chosen(2, 1), other = chosen(1, 2);
  EXPECT_EQ(selected(result.candidates), 3);
  EXPECT_EQ(result.mixture.components(), 3);
  EXPECT_EQ(result.clustered, 120'000);
  EXPECT_GT(result.compared, 45'000);
  EXPECT_LE(result.compared, 50'000);
  EXPECT_EQ(result.mixture.means, again.mixture.means);
  EXPECT_EQ(result.candidates[1].bic, again.candidates[1].bic);
  EXPECT_NE(result.candidates[1].bic, other.candidates[1].bic) << "another part";
  EXPECT_DOUBLE_EQ(result.candidates[0].effective_samples, 4800.0) << "what all windows are worth";
  // The result must be a maximum for all points, so more EM steps must not gain anything.
  const double found = log_density(result.mixture, cloud.points).sum();
  const EmResult on = fit_em(PointSet(cloud.points), result.mixture, options.em);
  EXPECT_LT(on.log_likelihood - found, 0.01);
  EXPECT_TRUE(near(result.mixture.means, other.mixture.means, 1e-3));
}

TEST(Select, AHundredThousandPointsAreAllCompared) {
  const FeatureCloud cloud = cloud_of(draw(three_clusters(6.0), 100'000, 8), 4);
  SelectionOptions options;
  options.components = {1};
  EXPECT_EQ(select_mixture(fits_of(cloud, 25, 1), cloud, options, 1).compared, 0);
}

TEST(Select, CandidatesAboveTheNumberOfPointsSaySo) {
  const FeatureCloud cloud = cloud_of(draw(three_clusters(3.0), 4, 5), 2);
  SelectionOptions options;
  options.components = {9, 2, 4, 2};
  const MixtureResult result = select_mixture(fits_of(cloud, 1, 1), cloud, options, 1);
  ASSERT_EQ(result.candidates.size(), 3u);
  EXPECT_EQ(result.candidates[0].components, 2);
  EXPECT_EQ(result.candidates[1].components, 4);
  EXPECT_EQ(result.candidates[1].status, CandidateStatus::fitted);
  EXPECT_EQ(result.candidates[2].components, 9);
  EXPECT_EQ(result.candidates[2].status, CandidateStatus::too_few_points);
  EXPECT_FALSE(result.candidates[2].selected);
}

TEST(Select, ImpossibleRequestsSayWhatWouldBeRight) {
  const FeatureCloud cloud = cloud_of(draw(three_clusters(3.0), 4, 5), 1);
  SelectionOptions options;
  options.components = {9};
  try {
    select_mixture(fits_of(cloud, 1, 1), cloud, options, 1);
    FAIL() << "no exception";
  } catch (const DataError& error) {
    EXPECT_NE(std::string(error.what()).find("9"), std::string::npos) << error.what();
    EXPECT_NE(std::string(error.what()).find("at most 4 components"), std::string::npos) << error.what();
  }
  EXPECT_THROW(select_mixture(fits_of(cloud, 1, 1), cloud_of(Eigen::MatrixXd(2, 0), 1), up_to(3), 1), DataError);
  options.components = {0, 1};
  EXPECT_THROW(select_mixture(fits_of(cloud, 1, 1), cloud, options, 1), std::invalid_argument);
  options.components.clear();
  EXPECT_THROW(select_mixture(fits_of(cloud, 1, 1), cloud, options, 1), std::invalid_argument);
}

TEST(Selection, FindsThreeClustersAmongIndependentPoints) {
  const Eigen::MatrixXd points = draw(three_clusters(12.0), 600, 1);
  const Selection result = select(points, {}, up_to(5), 1);
  EXPECT_EQ(selected(result.candidates), 3);
  // If points are independent, N_eff = N, so BIC equals bic_naive.
  for (const Candidate& row : result.candidates) {
    EXPECT_DOUBLE_EQ(row.effective_samples, 600.0);
    EXPECT_DOUBLE_EQ(row.bic, row.bic_naive);
  }
}

TEST(Selection, OverlapTakesEvidenceAway) {
  // 600 independent points reveal these clusters. The same points do not, if they are worth only 30 independent points.
  const Eigen::MatrixXd points = draw(three_clusters(3.0), 600, 2);
  EXPECT_EQ(selected(select(points, {}, up_to(4), 1).candidates), 3);
  EXPECT_LT(selected(select(points, 30.0, up_to(4), 1).candidates), 3);
}

TEST(Selection, StartsFromAGivenMixture) {
  const Eigen::MatrixXd points = draw(three_clusters(12.0), 300, 5);
  SelectionOptions options = up_to(3);
  options.em.restarts = 1;
  options.em.split_merge = 0;
  options.em.max_iterations = 0;  // without iterations the result equals the start
  const GaussianMixture start = three_clusters(12.0);
  const Selection result = select(points, {}, options, 1, &start);
  EXPECT_NEAR(result.candidates[2].log_likelihood, log_density(three_clusters(12.0), points).sum(), 1e-8);
}

/// A candidate whose fit throws must become a row with a failed status. The cause here is a start that is singular in
/// double precision.
TEST(Selection, ACandidateThatFailsIsARow) {
  const Eigen::MatrixXd points = draw(three_clusters(12.0), 300, 5);
  GaussianMixture start = three_clusters(12.0);
  start.covariances[1].setConstant(1e308);
  const std::vector<Candidate> rows = select(points, {}, up_to(4), 1, &start).candidates;
  ASSERT_EQ(rows.size(), 4u);
  EXPECT_EQ(rows[2].status, CandidateStatus::failed);
  EXPECT_NE(rows[2].failed.find("not positive definite"), std::string::npos) << rows[2].failed;
  EXPECT_EQ(rows[2].bic, std::numeric_limits<double>::infinity());
  EXPECT_EQ(selected(rows), 4);
  for (const std::size_t i : {0u, 1u, 3u}) EXPECT_EQ(rows[i].failed, "");
}

TEST(SelectionWarnings, NameWhatSpeaksAgainstTheChoice) {
  std::vector<Candidate> rows(3);
  for (std::size_t i = 0; i < 3; ++i) {
    rows[i].components = static_cast<Index>(i) + 1;
    rows[i].restarts = rows[i].agreeing_restarts = 5;
    rows[i].converged = true;
    rows[i].bic = rows[i].aic = i == 1 ? 1.0 : 2.0;
  }
  rows[1].selected = true;
  EXPECT_TRUE(selection_warnings(rows).empty());
  rows[1].agreeing_restarts = 2;
  rows[1].converged = false;
  rows[2].aic = 0.0;  // a better AIC, which must be ignored
  const std::vector<std::string> warnings = selection_warnings(rows);
  ASSERT_EQ(warnings.size(), 2u);
  EXPECT_NE(warnings[0].find("2 of 5 restarts"), std::string::npos);
  EXPECT_NE(warnings[1].find("did not converge"), std::string::npos);
}

/// Because its likelihood depends on the covariance floor, a fit at this floor is chosen only if all fits are at the
/// floor. The selection then has a warning.
TEST(SelectionWarnings, TheFloorIsNamedWhereNothingElseIsLeft) {
  std::vector<Candidate> rows(3);
  for (std::size_t i = 0; i < 3; ++i) {
    rows[i].components = static_cast<Index>(i) + 1;
    rows[i].converged = true;
    rows[i].bic = -static_cast<double>(i);
    rows[i].floor_active = i > 0;
  }
  EXPECT_EQ(best_candidate(rows), 0);
  rows[0].floor_active = true;
  EXPECT_EQ(best_candidate(rows), 2);
  rows[2].selected = true;
  bool named = false;
  for (const std::string& text : selection_warnings(rows))
    named = named || text.find("covariance_floor") != std::string::npos;
  EXPECT_TRUE(named);
}

/// Twenty windows at one point, as at standstill. By BIC they would justify a component of their own, for any floor.
TEST(Selection, AClusterWithoutExtentIsNotChosen) {
  Eigen::MatrixXd points(2, 220);
  points.leftCols(200) = draw(three_clusters(0.0), 200, 6);
  points.rightCols(20).colwise() = Eigen::Vector2d(1.0, -1.0);
  const Eigen::VectorXd error = Eigen::Vector2d(0.5, 0.25);
  for (const double floor : {1e-8, 1e-6, 1e-4}) {
    SelectionOptions options = up_to(4);
    options.em.covariance_floor = floor;
    const PointSet set(points, detail::no_weights, detail::no_covariances, error);
    const std::vector<Candidate> rows = select(set, {}, options, 1).candidates;
    EXPECT_TRUE(rows[1].floor_active);
    EXPECT_LT(rows[1].bic, rows[0].bic);
    EXPECT_EQ(selected(rows), 1);
  }
}

TEST(SelectionWarnings, TheEdgeOfTheRange) {
  std::vector<Candidate> rows(2);
  for (std::size_t i = 0; i < 2; ++i) {
    rows[i].components = static_cast<Index>(i) + 1;
    rows[i].converged = true;
    rows[i].bic = rows[i].aic = i == 0 ? 1.0 : 2.0;
  }
  rows[0].selected = true;
  EXPECT_TRUE(selection_warnings(rows).empty());  // fewer than one component cannot be suggested
  rows[0].components = 2;
  rows[1].components = 3;
  EXPECT_NE(selection_warnings(rows).at(0).find("fewest"), std::string::npos);
}

}  // namespace
}  // namespace modebank::test
