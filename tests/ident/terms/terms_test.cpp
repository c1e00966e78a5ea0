// Terms of a nonlinear motion: their values and slopes, and which of them the search finds.
#include "ident/model/terms.hpp"

#include <gmock/gmock.h>

#include "ident/model/equations.hpp"
#include "ident/terms/find_terms.hpp"
#include "ident/terms/stated_terms.hpp"
#include "modebank/base/error.hpp"
#include "tests/ident/ident_test_support.hpp"

namespace modebank::test {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Three terms of x, u0 and the direction .5 u0 - u1: a product, a magnitude and a hinge.
MotionTerms example_terms() {
  MotionTerms terms;
  terms.direction = MatrixXd::Zero(3, 3);
  terms.direction(0, 0) = terms.direction(1, 1) = 1.0;
  terms.direction.col(2) << 0.0, 0.5, -1.0;
  terms.low = Eigen::Vector3d(-1.0, -2.0, -1.0);
  terms.high = Eigen::Vector3d(1.0, 2.0, 1.0);
  terms.unit = Eigen::Vector3d(2.0, 1.0, 0.5);
  terms.terms = {{TermKind::product, {0, 0, 1}}, {TermKind::magnitude, {1}}, {TermKind::hinge, {2}, 0.5}};
  return terms;
}

/// The terms are computed by hand at two rows. Units and ranges come from the rows.
TEST(StatedTerms, AreTheFunctionsThatTheyName) {
  MatrixXd rows(2, 4);          // the regressors are v, v[k-1], u[k+1] and the constant
  rows << 2.0, -1.0, 0.5, 1.0,  //
      -3.0, 4.0, -0.25, 1.0;
  const auto stated = read_terms("v * v*u, |v[k-1]|, max(0, v - 1.5), max(0,u + 1)");
  ASSERT_EQ(stated.size(), 4);
  const MotionTerms terms = stated_terms(stated, {"v", "v[k-1]", "u[k+1]"}, rows);
  const MatrixXd columns = term_columns(terms, rows);
  const auto in_units = [&](Index t, double value) {
    double unit = 1.0;
    for (const Index v : terms.terms[t].variables) unit *= terms.unit(v);
    return value / unit;
  };
  const MatrixXd expected = (MatrixXd(2, 4) << 2.0, 1.0, 0.5, 1.5, -2.25, 4.0, 0.0, 0.75).finished();
  for (Index k = 0; k < 2; ++k)
    for (Index t = 0; t < 4; ++t) EXPECT_NEAR(columns(k, t), in_units(t, expected(k, t)), 1e-14) << k << ' ' << t;
}

TEST(StatedTerms, AnswerWhatIsNoTermWithItsName) {
  for (const char* text : {"v", "", "v*v*v*v", "sin(v)", "max(1, v)", "v * ", "|v| * u"})
    EXPECT_THROW(read_terms(text), std::invalid_argument) << text;
  try {
    stated_terms(read_terms("v * w"), {"v", "u"}, MatrixXd::Ones(3, 3));
    FAIL();
  } catch (const DataError& error) {
    EXPECT_THAT(error.what(), testing::AllOf(testing::HasSubstr("'w'"), testing::HasSubstr("v, u")));
  }
}

TEST(TermValues, AreTheFunctions) {
  const Eigen::Vector3d phi(0.8, -0.6, -0.9);  // direction: 0.6
  TermValues values;
  values.evaluate(example_terms(), phi);
  EXPECT_NEAR(values.value()(0), 0.4 * 0.4 * -0.6, 1e-15);
  EXPECT_NEAR(values.value()(1), 0.6, 1e-15);
  EXPECT_NEAR(values.value()(2), 0.6 / 0.5 - 0.5, 1e-15);
  EXPECT_FALSE(values.is_clipped());
  EXPECT_LT((term_columns(example_terms(), phi.transpose()) - values.value().transpose()).norm(), 1e-15);
}

TEST(TermValues, SlopesAreDerivatives) {
  const Eigen::Vector3d phi(0.8, -0.6, -0.9);
  TermValues values, moved;
  values.evaluate(example_terms(), phi);
  for (Index i = 0; i < 3; ++i) {
    constexpr double h = 1e-6;
    moved.evaluate(example_terms(), phi + h * Eigen::Vector3d::Unit(i));
    const VectorXd above = moved.value();
    moved.evaluate(example_terms(), phi - h * Eigen::Vector3d::Unit(i));
    EXPECT_LT(((above - moved.value()) / (2.0 * h) - values.slope().col(i)).norm(), 1e-9) << i;
  }
}

TEST(TermValues, AreClippedToTheTrainingRange) {
  TermValues values, at_edge;
  values.evaluate(example_terms(), Eigen::Vector3d(5.0, 1.0, 0.0));
  at_edge.evaluate(example_terms(), Eigen::Vector3d(1.0, 1.0, 0.0));
  EXPECT_TRUE(values.is_clipped());
  EXPECT_FALSE(at_edge.is_clipped());
  EXPECT_EQ(values.value(), at_edge.value());
  EXPECT_EQ(values.slope()(0, 0), 0.0);
  MatrixXd rows(2, 3);
  rows << 5.0, 1.0, 0.0, 1.0, 1.0, 0.0;
  EXPECT_DOUBLE_EQ(share_outside(example_terms(), rows), 0.5);
}

TEST(TermValues, RefusesVariablesThatItHasNot) {
  MotionTerms terms = example_terms();
  terms.terms[1].variables = {3};
  EXPECT_THROW(check_terms(terms, 3), std::invalid_argument);
  EXPECT_THROW(check_terms(example_terms(), 4), std::invalid_argument);
  EXPECT_NO_THROW(check_terms(example_terms(), 3));
}

TEST(Equations, AreInPhysicalUnits) {
  const LinearStructure structure{1, 2};
  LinearModel model = unpack(structure, Eigen::Vector3d(-0.3, 0.2, 0.0));
  MatrixXd bend(1, 3);
  bend << 4.0, -0.5, 0.1;
  const std::vector<std::string> lines = equations(structure, model, example_terms(), bend, {"wz"}, {"left", "right"});
  ASSERT_EQ(lines.size(), 4U);
  EXPECT_EQ(lines[0],
            "wz[k+1] = 0.7 wz[k] + 0.2 left[k] + 1 wz[k] * wz[k] * left[k] - 0.5 |left[k]| + 0.2 max(0, p1 - 0.25)");
  EXPECT_EQ(lines[3], "p1 = 0.5 left[k] - 1 right[k], p1 within -1 to 1");
}

/// Six runs of x[k+1] = .7 x[k] + bend(.2 u1 - .2 u0) + noise, with inputs held for some samples.
template <class Bend>
Recording bent_runs(Bend bend, std::uint64_t seed) {
  std::mt19937_64 generator(seed);
  boost::random::normal_distribution<double> normal;
  boost::random::uniform_real_distribution<double> uniform(-1.0, 1.0);
  std::vector<Trajectory> runs;
  for (Index r = 0; r < 6; ++r) {
    MatrixXd x = MatrixXd::Zero(1, 400), u(2, 400);
    for (Index k = 0; k < 400; ++k)
      u.col(k) = k % 7 == 0 ? Eigen::VectorXd(Eigen::Vector2d(uniform(generator), uniform(generator)))
                            : Eigen::VectorXd(u.col(k - 1));
    for (Index k = 0; k + 1 < 400; ++k)
      x(0, k + 1) = 0.7 * x(0, k) + bend(0.2 * (u(1, k) - u(0, k))) + 0.01 * normal(generator);
    runs.push_back(make_run(x, u));
    runs.back().run = "run" + std::to_string(r);
  }
  return make_recording(std::move(runs));
}

TEST(FindTerms, FindsASaturationOfTwoInputsTogether) {
  const FoundTerms found =
      find_terms(bent_runs([](double v) { return std::clamp(v, -0.1, 0.1); }, 1), {1, 2}, FitOptions());
  EXPECT_FALSE(found.terms.empty());
  EXPECT_GT(found.gain, 0.1);
  bool combined = false;  // whether some term has the direction of the inputs
  for (Index v = 0; v < found.terms.variables(); ++v)
    combined = combined || (found.terms.direction.col(v).array() != 0.0).count() == 2;
  EXPECT_TRUE(combined);
}

TEST(FindTerms, TakesNoneOfALinearMotion) {
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    const FoundTerms found = find_terms(bent_runs([](double v) { return v; }, seed), {1, 2}, FitOptions());
    EXPECT_TRUE(found.terms.empty()) << seed << ": " << found.gain << " +- " << found.gain_standard_error;
    EXPECT_LT(found.gain, least_terms_gain) << seed;
  }
}

TEST(FindTerms, TriesFewerLags) {
  const FoundTerms found =
      find_terms(bent_runs([](double v) { return std::clamp(v, -0.1, 0.1); }, 1), {1, 2, false, 5, 3}, FitOptions());
  ASSERT_EQ(found.tried.size(), 3U);
  EXPECT_EQ(found.tried[1].structure.state_lags, 2);
  EXPECT_EQ(found.tried[2].structure.input_lags, 3);
  EXPECT_EQ(found.structure.state_lags, 1);  // linear lags could replace the nonlinearity, so without such lags it is
                                             // found
}

}  // namespace
}  // namespace modebank::test
