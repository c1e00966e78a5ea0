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

/// Checks that figures are never NaN, and that a status explains each missing fit.
void expect_stated(const Selection& result) {
  EXPECT_TRUE(is_finite(result.mixture));
  for (const Candidate& row : result.candidates) {
    for (const double value : {row.log_likelihood, row.bic, row.aic, row.bic_naive, row.effective_samples})
      EXPECT_FALSE(std::isnan(value)) << row.components;
    EXPECT_EQ(std::isfinite(row.log_likelihood), row.status == CandidateStatus::fitted) << row.components;
  }
  EXPECT_GE(chosen(result.candidates), 1);
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

TEST(Selection, WholeWeightsAreCopies) {
  const Eigen::MatrixXd points = draw(three_clusters(8.0), 200, 3);
  const Eigen::VectorXd twice = Eigen::VectorXd::Constant(200, 2.0);
  SelectionOptions options = from_one_to(1);  // the start has no effect on a single component
  const Candidate weighted = select(PointSet(points, twice), {}, options, 1).candidates[0];
  const Eigen::MatrixXd twofold = points.replicate(1, 2);
  const Candidate copied = select(twofold, {}, options, 1).candidates[0];
  EXPECT_NEAR(weighted.bic, copied.bic, 1e-9 * std::abs(copied.bic));
}

TEST(Selection, SamePartitionInAnyUnits) {
  const Eigen::MatrixXd points = draw(three_clusters(6.0), 400, 4);
  const Selection plain = select(points, {}, from_one_to(4), 1);
  const Eigen::MatrixXd memberships = responsibilities(plain.mixture, points);
  for (const double unit : {1e-6, 1e6}) {
    Eigen::MatrixXd scaled = points;
    scaled.row(1) *= unit;
    const Selection result = select(scaled, {}, from_one_to(4), 1);
    ASSERT_EQ(result.mixture.components(), plain.mixture.components());
    EXPECT_TRUE(near(responsibilities(result.mixture, scaled), memberships, 1e-6)) << unit;
    EXPECT_TRUE(near(result.mixture.means.row(1) / unit, plain.mixture.means.row(1), 1e-6)) << unit;
    for (std::size_t i = 0; i < plain.candidates.size(); ++i)
      EXPECT_NEAR(result.candidates[i].log_likelihood, plain.candidates[i].log_likelihood - 400.0 * std::log(unit),
                  1e-4);
  }
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

TEST(SelectionRobustness, BadCloudsGiveStatedRows) {
  Eigen::MatrixXd constant(3, 200);
  constant.topRows(2) = draw(three_clusters(10.0), 200, 1);
  constant.row(2).setConstant(7.0);
  Eigen::MatrixXd few(2, 60);
  for (Index i = 0; i < 60; ++i) few.col(i) << static_cast<double>(i % 3), static_cast<double>((i % 3) * 2);
  Eigen::MatrixXd outlier = draw(three_clusters(5.0), 200, 2);
  outlier.col(7).setConstant(1e100);
  for (const Eigen::MatrixXd& points : {constant, few, outlier, Eigen::MatrixXd(few.leftCols(1).replicate(1, 50))}) {
    for (const CovarianceType type : {CovarianceType::full, CovarianceType::diagonal}) {
      SelectionOptions options = from_one_to(6);
      options.em.covariance = type;
      expect_stated(select(points, {}, options, 1));
    }
  }
  const Selection three = select(few, {}, from_one_to(6), 1);
  EXPECT_EQ(three.candidates[2].status, CandidateStatus::fitted);
  EXPECT_EQ(three.candidates[3].status, CandidateStatus::too_few_points);
  SelectionOptions too_many;
  too_many.components = {4, 5};
  EXPECT_THROW(select(few, {}, too_many, 1), DataError);
  const Eigen::MatrixXd none(2, 0);
  EXPECT_THROW(select(none, {}, too_many, 1), DataError);
}

}  // namespace
}  // namespace modebank::test
