// Selection without windows, its warnings, and its results for unusable clouds.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "mixture/criteria.hpp"
#include "modebank/base/error.hpp"
#include "tests/mixture/mixture_test_support.hpp"
#include "tests/support/matrix_compare.hpp"

namespace modebank::test {
namespace {

using Eigen::Index;

SelectionOptions from_one_to(Index most) {
  SelectionOptions options;
  options.components.clear();
  for (Index k = 1; k <= most; ++k) options.components.push_back(k);
  return options;
}

Index chosen(const std::vector<Candidate>& candidates) {
  for (const Candidate& row : candidates)
    if (row.selected) return row.components;
  return 0;
}

TEST(Selection, FindsThreeClustersAmongIndependentPoints) {
  const Eigen::MatrixXd points = draw(three_clusters(12.0), 600, 1);
  const Selection result = select(points, {}, from_one_to(5), 1);
  EXPECT_EQ(chosen(result.candidates), 3);
  // If points are independent, N_eff = N, so BIC equals bic_naive.
  for (const Candidate& row : result.candidates) {
    EXPECT_DOUBLE_EQ(row.effective_samples, 600.0);
    EXPECT_DOUBLE_EQ(row.bic, row.bic_naive);
  }
}

TEST(Selection, OverlapTakesEvidenceAway) {
  // 600 independent points reveal these clusters. The same points do not, if they are worth only 30 independent points.
  const Eigen::MatrixXd points = draw(three_clusters(3.0), 600, 2);
  EXPECT_EQ(chosen(select(points, {}, from_one_to(4), 1).candidates), 3);
  EXPECT_LT(chosen(select(points, 30.0, from_one_to(4), 1).candidates), 3);
}

TEST(Selection, StartsFromAGivenMixture) {
  const Eigen::MatrixXd points = draw(three_clusters(12.0), 300, 5);
  SelectionOptions options = from_one_to(3);
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
  const std::vector<Candidate> rows = select(points, {}, from_one_to(4), 1, &start).candidates;
  ASSERT_EQ(rows.size(), 4u);
  EXPECT_EQ(rows[2].status, CandidateStatus::failed);
  EXPECT_NE(rows[2].failed.find("not positive definite"), std::string::npos) << rows[2].failed;
  EXPECT_EQ(rows[2].bic, std::numeric_limits<double>::infinity());
  EXPECT_EQ(chosen(rows), 4);
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
    SelectionOptions options = from_one_to(4);
    options.em.covariance_floor = floor;
    const PointSet set(points, detail::no_weights, detail::no_covariances, error);
    const std::vector<Candidate> rows = select(set, {}, options, 1).candidates;
    EXPECT_TRUE(rows[1].floor_active);
    EXPECT_LT(rows[1].bic, rows[0].bic);
    EXPECT_EQ(chosen(rows), 1);
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
