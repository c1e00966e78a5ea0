#include <gtest/gtest.h>

#include <stdexcept>

#include "modebank/base/error.hpp"
#include "modebank/mixture/mixture.hpp"
#include "tests/mixture/mixture_test_support.hpp"
#include "tests/support/recorded_runs.hpp"

namespace modebank {
namespace {

TEST(MixtureDoor, GivesTheSameBits) {
  const Eigen::MatrixXd points = test::draw(test::three_clusters(8.0), 300, 9);
  const Eigen::MatrixXd errors = (0.05 * Eigen::Matrix2d::Identity()).reshaped().replicate(1, points.cols());
  const Eigen::VectorXd weights = Eigen::VectorXd::LinSpaced(points.cols(), 0.5, 1.5);
  constexpr double samples = 150.0;
  for (const bool noise : {false, true}) {
    SelectionOptions options;
    options.components = {2, 3, 4};
    options.em.restarts = 2;
    options.em.noise_component = noise;
    const PointSet set(points, weights, errors);
    const Selection internal = select(set, samples, options, 7);
    const mixture::Clusters converted =
        mixture::select({to_matrix(points), to_vector(weights), to_matrix(errors), samples}, options, 7);
    EXPECT_TRUE(test::same_bits(converted.mixture.weights, to_vector(internal.mixture.weights)));
    EXPECT_TRUE(test::same_bits(converted.mixture.means, to_matrix(internal.mixture.means)));
    ASSERT_EQ(converted.mixture.covariances.size(), internal.mixture.covariances.size());
    for (std::size_t k = 0; k < internal.mixture.covariances.size(); ++k)
      EXPECT_TRUE(test::same_bits(converted.mixture.covariances[k], to_matrix(internal.mixture.covariances[k])));
    EXPECT_EQ(converted.mixture.noise_weight, internal.mixture.noise.weight);
    EXPECT_TRUE(test::same_bits(converted.mixture.noise_lower, to_vector(internal.mixture.noise.lower)));
    EXPECT_TRUE(test::same_bits(converted.responsibilities, to_matrix(responsibilities(internal.mixture, set))));
    ASSERT_EQ(converted.candidates.size(), 3u);
    for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(converted.candidates[i].bic, internal.candidates[i].bic);
    // Conversion of a mixture to the public type and back.
    EXPECT_TRUE(test::same_bits(mixture::responsibilities(converted.mixture, to_matrix(points)),
                                to_matrix(responsibilities(internal.mixture, points))));
    EXPECT_TRUE(test::same_bits(mixture::log_density(converted.mixture, to_matrix(points)),
                                to_vector(log_density(internal.mixture, points))));
  }
}

TEST(MixtureDoor, BadArgumentsAreNamed) {
  const Matrix points = to_matrix(test::draw(test::three_clusters(8.0), 20, 9));
  const auto refusal = [&](mixture::Points given, const SelectionOptions& options) -> std::string {
    try {
      mixture::select(given, options);
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "";
  };
  mixture::Points bad{points, {}, {}};
  bad.values.rows = 3;
  EXPECT_EQ(refusal(bad, {}), "values is 3 x 20 but holds 40 numbers");
  EXPECT_EQ(refusal({points, {1.0}, {}, {}}, {}), "20 points have 1 weights; expected one weight per point, or none");
  SelectionOptions none;
  none.components.clear();
  EXPECT_EQ(refusal({points, {}, {}, {}}, none), "selection needs candidate numbers of components, each at least 1");
  SelectionOptions many;
  many.components = {30};
  EXPECT_THROW(mixture::select({points, {}, {}, {}}, many), DataError);
  EXPECT_THROW(mixture::log_density({}, points), std::invalid_argument);
  mixture::Mixture indefinite{{1.0}, {{0.0}, {0.0}}, {{{1.0, 2.0}, {2.0, 1.0}}}, 0.0, {}, {}};
  EXPECT_THROW(mixture::log_density(indefinite, points), std::invalid_argument);
}

}  // namespace
}  // namespace modebank
