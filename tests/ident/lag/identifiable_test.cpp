#include "ident/lag/identifiable.hpp"

#include <cmath>

#include "tests/ident/ident_test_support.hpp"

namespace modebank {
namespace {

using Eigen::MatrixXd;

constexpr double quantum = 1e-3, gain = 2.0;
enum class Input { held, follows_set_point };
enum class SetPoint { logged, hidden };

/// x[k+1] = .9 x[k] + .1 u[k] + noise, the last of the columns: rounded x, u and perhaps the set point.
Recording plant(Input kind, SetPoint set_point, double swing, Index samples = 3000) {
  std::mt19937_64 generator(1);
  boost::random::normal_distribution<double> normal(0.0, 1.0);
  const auto rounded = [](double value) { return quantum * std::round(value / quantum); };
  MatrixXd x = MatrixXd::Constant(1, samples, 20.0), u(set_point == SetPoint::logged ? 2 : 1, samples);
  double target = 20.0, held = 1.0;
  for (Index k = 0; k < samples; ++k) {
    if (k > 0) x(k) = rounded(20.0 + 0.9 * (x(k - 1) - 20.0) + 0.1 * u(0, k - 1) + 0.02 * normal(generator));
    if (k % 7 == 0) target = rounded(20.0 + swing * normal(generator)), held = normal(generator) > 0.0 ? 1.0 : -1.0;
    u(0, k) = kind == Input::held ? held : rounded(gain * (target - x(k)));
    if (set_point == SetPoint::logged) u(1, k) = target;
  }
  return test::make_recording({test::make_run(x, u)});
}

Identifiability look(const Recording& recording) {
  return identifiable(recording, Eigen::VectorXd::Constant(1 + recording.input_count(), quantum));
}

TEST(Identifiable, NamesTheLawOfALoggedSetPoint) {
  const Identifiability found = look(plant(Input::follows_set_point, SetPoint::logged, 1.0));
  ASSERT_EQ(found.relations.size(), 2);  // the set point is given by the other two, too
  const ColumnRelation& law = found.relations[0];
  ASSERT_EQ(law.terms.size(), 2);
  EXPECT_EQ(law.joined, (std::vector<Index>{0, 2}));
  for (const ColumnRelation::Term& term : law.terms) {
    EXPECT_NEAR(term.coefficient, term.column == 2 ? gain : -gain, 1e-4);
    EXPECT_EQ(term.lag, 0);
  }
  EXPECT_TRUE(law.complete);
  EXPECT_EQ(law.constant, 0.0);
  EXPECT_FALSE(law.follows_states);
}

TEST(Identifiable, HasNothingAgainstMovingInputs) {
  EXPECT_TRUE(look(plant(Input::held, SetPoint::hidden, 1.0)).relations.empty());
  EXPECT_TRUE(look(plant(Input::follows_set_point, SetPoint::hidden, 1.0)).relations.empty());
}

TEST(Identifiable, FindsSumsOfInputsAndInputsAtRest) {
  Recording recording = plant(Input::held, SetPoint::logged, 1.0);
  MatrixXd& u = recording.runs[0].input;
  u.conservativeResize(5, Eigen::NoChange);
  u.row(2) = (u.row(0) + u.row(1)) / 2.0;
  u.row(3) = (u.row(1) - u.row(0)) / 0.5;
  u.row(4).setConstant(0.3);
  recording.inputs.resize(5);
  const Identifiability found = look(recording);
  EXPECT_EQ(found.relations.size(), 4);
  for (const ColumnRelation& relation : found.relations) EXPECT_EQ(relation.terms.size(), 2) << relation.column;
  EXPECT_EQ(found.resting, std::vector<Index>{5});
}

}  // namespace
}  // namespace modebank
