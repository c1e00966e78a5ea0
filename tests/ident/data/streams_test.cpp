#include "ident/data/streams.hpp"

#include <gtest/gtest.h>

#include "modebank/base/error.hpp"
#include "tests/support/matrix_compare.hpp"

namespace modebank {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double time_tolerance_s = 1e-12;  // allows rounding in sums and products of a few times

Stream counting(const VectorXd& time_s) {
  return {time_s, VectorXd::LinSpaced(time_s.size(), 0, static_cast<double>(time_s.size() - 1)).transpose()};
}

VectorXd vector(std::initializer_list<double> values) {
  return Eigen::Map<const VectorXd>(values.begin(), static_cast<Eigen::Index>(values.size()));
}

TEST(Interpolate, IsExactOnKnotsAndTakesAllChannels) {
  const Stream stream{vector({0, 0.1, 0.3}), (MatrixXd(2, 3) << 1, 2, 3, -1, 5, 7).finished()};
  EXPECT_EQ(interpolate(stream, stream.time_s), stream.values);
  EXPECT_TRUE(test::near(interpolate(stream, vector({0.2})), (MatrixXd(2, 1) << 2.5, 6).finished(), 1e-15));
}

TEST(Interpolate, OneKnotIsConstant) {
  const Stream stream{vector({1}), MatrixXd::Constant(1, 1, 4)};
  EXPECT_EQ(interpolate(stream, vector({0, 1, 2})), MatrixXd::Constant(1, 3, 4));
}

TEST(Hold, TakesTheLastSampleBefore) {
  const Stream stream = counting(vector({0, 1, 2.5}));
  EXPECT_EQ(hold(stream, vector({0, 0.99, 1, 2.4, 2.5, 9})), (MatrixXd(1, 6) << 0, 0, 1, 1, 2, 2).finished());
}

TEST(Hold, RoundingDoesNotCostASample) {
  const Stream stream = counting(vector({0.1, 0.2, 0.1 + 0.2}));  // 0.30000000000000004
  EXPECT_EQ(hold(stream, vector({0.3})), MatrixXd::Constant(1, 1, 2));
  const double epoch_s = 1432235498.0;
  const Stream stamped = counting((VectorXd::LinSpaced(100, 0, 0.99).array() + epoch_s).matrix());
  const VectorXd shifted = (stamped.time_s.array() + 0.3) - 0.3;
  EXPECT_EQ(hold(stamped, shifted), stamped.values);
}

TEST(JointTimes, AreTheInputsTimesInsideTheStatesSpan) {
  const VectorXd states = vector({1, 2, 4});
  EXPECT_EQ(joint_times(states, vector({0, 0.9, 1, 3, 4, 4.1}), {}), vector({1, 3, 4}));
  EXPECT_EQ(joint_times(states, vector({5, 6}), {}).size(), 0);
  EXPECT_EQ(joint_times(states, vector({0, 0.5}), {}).size(), 0);
}

TEST(JointTimes, DropSamplesWithoutInput) {
  const VectorXd time_s = VectorXd::LinSpaced(11, 0, 1);
  EXPECT_EQ(joint_times(time_s, time_s, {0, 0.3}), time_s.tail(8)) << "u(t - 0.3) is known from 0.3 on";
  EXPECT_EQ(joint_times(time_s, time_s, {0, -0.3}), time_s.head(8)) << "u(t + 0.3) is known until 0.7";
  EXPECT_EQ(joint_times(time_s, time_s, {0, 0.25}), time_s.tail(8)) << "the first time is 0.3, after 0.25";
  EXPECT_EQ(joint_times(time_s, time_s, {0, 2}).size(), 0);
}

TEST(JointTimes, UniformGridFromTheFirstCommonTime) {
  const VectorXd states = vector({0.5, 1, 2}), inputs = vector({0, 0.7, 1.9});
  EXPECT_TRUE(
      test::near(joint_times(states, inputs, {4, 0}), vector({0.5, 0.75, 1, 1.25, 1.5, 1.75}), time_tolerance_s));
  EXPECT_TRUE(
      test::near(joint_times(states, inputs, {4, 0.6}), vector({0.6, 0.85, 1.1, 1.35, 1.6, 1.85}), time_tolerance_s));
  EXPECT_EQ(joint_times(states, vector({2.5, 3}), {4, 0}).size(), 0);
}

TEST(JointTimes, UniformGridKeepsItsEnd) {
  const VectorXd time_s = VectorXd::LinSpaced(101, 0, 100) / 6.5;
  EXPECT_TRUE(test::near(joint_times(time_s, time_s, {6.5, 0}), time_s, time_tolerance_s));
}

/// Stamps in another unit than the configured one. A grid of such times would need too much memory.
TEST(JointTimes, NoGridIsFarFinerThanItsStreams) {
  const VectorXd time_s = vector({0, 1e9, 2e9, 3e9});
  EXPECT_THROW(joint_times(time_s, time_s, {1000, 0}), DataError);
}

}  // namespace
}  // namespace modebank
