// Noise that adapts to the run: the scale of every mode's Q.
#include "filter/judge/run/evaluate.hpp"
#include "tests/filter/learn/refine_test_support.hpp"
#include "tests/support/matrix_compare.hpp"

namespace modebank {
namespace {

using test::adaptive_imm;
using test::near;

TEST(NoiseScale, IsTheDiscountedMeanOfStandardisedSquares) {
  Recording recording = test::empty_recording(1, 1);
  Eigen::MatrixXd x(1, 8);
  x << 0.0, 0.3, -0.2, 0.5, 0.6, 0.1, -0.3, 0.2;
  test::add_run(recording, x, Eigen::MatrixXd::Zero(1, 8));
  const LinearStructure structure = test::structure_of(recording);
  Bank bank = bank_frame(recording, structure, Eigen::MatrixXd::Zero(1, 1));
  const double Q = 0.09, f = 0.9, n0 = 3.0;
  bank.modes.push_back(
      make_mode(structure, Eigen::Vector2d(-0.5, 0.0), Eigen::MatrixXd::Constant(1, 1, Q), {}, {}, 1.0));
  set_mode_sequence(bank, TransitionMatrix());
  bank.noise_adaptation = {f, n0};
  const RunEvaluation e = evaluate_run(bank, recording.runs[0], adaptive_imm());
  double weight = n0, squares = n0;
  for (Index k = 1; k < 8; ++k) {
    EXPECT_NEAR(e.innovation_covariance(0, k), squares / weight * Q, 1e-14);
    const double r = x(k) - 0.5 * x(k - 1);
    weight = f * weight + (1.0 - f) * n0 + 1.0;
    squares = f * squares + (1.0 - f) * n0 + r * r / Q;
  }
}

TEST(NoiseScale, StaysWhereMeasurementNoiseExplainsEverything) {
  Recording recording = test::empty_recording(1, 1);
  test::add_run(recording, Eigen::MatrixXd::Random(1, 50), Eigen::MatrixXd::Zero(1, 50));
  const LinearStructure structure = test::structure_of(recording);
  Bank bank = bank_frame(recording, structure, Eigen::MatrixXd::Ones(1, 1));
  bank.modes.push_back(
      make_mode(structure, Eigen::Vector2d(0.0, 0.0), Eigen::MatrixXd::Constant(1, 1, 1e-12), {}, {}, 1.0));
  set_mode_sequence(bank, TransitionMatrix());
  const RunEvaluation plain = evaluate_run(bank, recording.runs[0], {});
  const RunEvaluation e = evaluate_run(bank, recording.runs[0], adaptive_imm());
  EXPECT_TRUE(near(e.innovation_covariance.rightCols(49), plain.innovation_covariance.rightCols(49), 1e-9));
}

}  // namespace
}  // namespace modebank
