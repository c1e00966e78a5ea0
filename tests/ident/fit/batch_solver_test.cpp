#include <hwy/targets.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>

#include "ident/fit/fit_windows.hpp"
#include "modebank/base/error.hpp"
#include "tests/ident/fit/batch_test_support.hpp"
#include "tests/support/effort.hpp"
#include "tests/support/matrix_compare.hpp"

namespace modebank {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using test::hard_recording;
using test::near;
using test::RealVector;

bool convex(Loss loss) { return loss == Loss::trivial || loss == Loss::huber || loss == Loss::softlone; }

WindowFits fit_by(WindowSolver solver, const Recording& recording, FitOptions options) {
  options.solver = solver;
  return fit_windows(recording, options);
}

void expect_same_bits(const WindowFits& a, const WindowFits& b) {
  EXPECT_TRUE(test::same_bits(a.parameters, b.parameters));
  EXPECT_TRUE(test::same_bits(a.covariance, b.covariance));
  EXPECT_TRUE(test::same_bits(a.noise_variance, b.noise_variance));
  EXPECT_TRUE(test::same_bits(a.condition, b.condition));
  EXPECT_TRUE(test::same_bits(a.information, b.information));
  EXPECT_TRUE(test::same_bits(a.inlier_fraction, b.inlier_fraction));
  EXPECT_TRUE(test::same_bits(a.prior_sd, b.prior_sd));
  EXPECT_TRUE(a.status == b.status);
  EXPECT_TRUE(a.rank == b.rank);
}

class Batch : public ::testing::TestWithParam<std::tuple<Loss, Prior>> {
 protected:
  FitOptions options() const {
    FitOptions o;
    std::tie(o.loss, o.prior) = GetParam();
    o.step = test::in_release(1, 6);
    return o;
  }
};

TEST_P(Batch, EveryWindowIsAtAStationaryPointAndConvexOnesAtTheReference) {
  for (const Index inputs : {0, 1, 2, 4}) {
    const LinearStructure structure{1, inputs, inputs == 4};
    const Recording recording = hard_recording(structure, 120, false);
    FitOptions o = options();
    o.intercept = structure.intercept;
    o.sigma = 0.04;
    o.length = 30;
    const WindowFits fits = fit_by(WindowSolver::batch, recording, o);
    EXPECT_GT(test::by_batch(fits), fits.count() / 2);
    test::ReferenceProblem problem{o.loss, default_loss_scale(o.loss), o.sigma, {}, {}};
    if (o.prior == Prior::global) {
      problem.mean = fits.global.theta.cast<test::Real>();
      problem.precision = fits.prior_sd.array().square().inverse().cast<test::Real>();
    }
    Index unsolved = 0;
    for (Index i = 0; i < fits.count(); ++i) {
      if (fits.status(i) == 2 && o.prior == Prior::none) continue;
      if (fits.status(i) == 1 && !convex(o.loss)) {
        ++unsolved;  // the window has the status unsolved
        continue;
      }
      const Window window = fits.windows[i];
      const auto data = test::window_of(recording.runs[window.run], window.start, o.length, structure);
      const RealVector theta = fits.parameters.col(i).cast<test::Real>();
      EXPECT_LE(problem.relative_gradient(data, theta), 1e-10) << "window " << i << ", inputs " << inputs;
      if (!convex(o.loss)) continue;
      const VectorXd reference = problem.minimum(data).cast<double>();
      EXPECT_TRUE(near(fits.parameters.col(i), reference, 1e-9)) << "window " << i << ", inputs " << inputs;
    }
    EXPECT_LE(unsolved, fits.count() / 100);
  }
}

TEST_P(Batch, HasTheSameLocalModelsAsCeres) {
  for (const bool missing : {false, true})
    for (const CovarianceKind kind : {CovarianceKind::model, CovarianceKind::sandwich})
      for (const double sigma : {0.0, 0.05}) {
        FitOptions o = options();
        o.covariance = kind;
        o.sigma = sigma;
        if (missing) o.step *= 3;
        o.prior_sd = {0.8};
        const Recording recording = hard_recording(test::skid_structure, 130, missing);
        const WindowFits batch = fit_by(WindowSolver::batch, recording, o),
                         ceres = fit_by(WindowSolver::ceres, recording, o);
        EXPECT_EQ(test::by_batch(ceres), 0);
        EXPECT_GE(test::by_batch(batch), o.prior == Prior::global ? batch.count() : batch.count() / 2);
        EXPECT_TRUE(batch.status == ceres.status);
        EXPECT_TRUE(batch.rank == ceres.rank);
        Index others = 0;  // if a loss has several minima, the solvers may find different minima
        for (Index i = 0; i < batch.count(); ++i) {
          if (!near(batch.parameters.col(i), ceres.parameters.col(i), 1e-7)) {
            ++others;
            continue;
          }
          const double scale_of_covariance = std::max(1e-300, ceres.covariance.col(i).cwiseAbs().maxCoeff());
          if (ceres.status(i) == 0) {
            EXPECT_NEAR(batch.condition(i), ceres.condition(i), 1e-6 * ceres.condition(i));
            EXPECT_TRUE(near(batch.covariance.col(i) / scale_of_covariance,
                             ceres.covariance.col(i) / scale_of_covariance, 1e-6))
                << "window " << i << name_of(o.loss);
          }
          if (o.prior == Prior::global) {
            const double largest = std::max(1.0, ceres.information.col(i).cwiseAbs().maxCoeff());
            EXPECT_TRUE(near(batch.information.col(i) / largest, ceres.information.col(i) / largest, 1e-6))
                << "window " << i;
            if (convex(o.loss) && ceres.status(i) == 0) {
              const double weighed = ceres.weighed_information(0, i);
              if (std::isnan(weighed))  // sandwich covariance
                EXPECT_TRUE(std::isnan(batch.weighed_information(0, i))) << "window " << i;
              else
                EXPECT_NEAR(batch.weighed_information(0, i), weighed, 1e-6 * weighed) << "window " << i;
            }
          }
          EXPECT_NEAR(batch.noise_variance(0, i), ceres.noise_variance(0, i), 1e-6 * ceres.noise_variance(0, i));
          EXPECT_DOUBLE_EQ(batch.inlier_fraction(i), ceres.inlier_fraction(i));
        }
        EXPECT_LE(others, convex(o.loss) ? 0 : batch.count() / 10);
      }
}

TEST_P(Batch, UnitsDoNotMatter) {
  const Recording plain = hard_recording(test::skid_structure, 100, false);
  const WindowFits expected = fit_by(WindowSolver::batch, plain, options());
  for (const double unit : {1e-6, 1e6}) {
    Recording scaled = plain;
    for (Trajectory& run : scaled.runs) run.input *= unit;
    const WindowFits fits = fit_by(WindowSolver::batch, scaled, options());
    EXPECT_TRUE(fits.status == expected.status) << unit;
    EXPECT_GE(test::by_batch(fits), test::by_batch(expected)) << unit;
    const MatrixXd back = Eigen::Vector3d(1, unit, unit).asDiagonal() * fits.parameters;
    Index others = 0;  // if a loss has several minima, the solvers may find different minima
    for (Index i = 0; i < fits.count(); ++i) {
      // the minimum-norm solution depends on units
      if (fits.status(i) == 2 && options().prior == Prior::none) continue;
      others += near(back.col(i), expected.parameters.col(i), 1e-8) ? 0 : 1;
    }
    EXPECT_LE(others, convex(options().loss) ? 0 : fits.count() / 10) << unit;
  }
}

TEST_P(Batch, ThreadsChunksAndNeighboursDoNotChangeABit) {
  const Recording recording = hard_recording(test::skid_structure, 150, true);
  std::vector<WindowFits> results;
  for (const std::size_t threads : {1U, 2U}) {
    tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    results.push_back(fit_by(WindowSolver::batch, recording, options()));
  }
  expect_same_bits(results[0], results[1]);

  // Fits the same windows in chunks of one to eleven windows. Each window is then in another lane, beside other
  // windows.
  FitOptions o = options();
  const ParameterPrior prior{results[0].global.theta,
                             o.prior == Prior::global ? results[0].prior_sd : VectorXd::Ones(3)};
  const BatchSolver solver(batch_settings(test::skid_structure, o, o.prior == Prior::global ? &prior : nullptr, 1e-4));
  const Trajectory& run = recording.runs[0];
  const Index windows = (run.transitions() - o.length) / o.step + 1;
  BatchWorkspace workspace;
  std::vector<MatrixXd> thetas;
  for (const Index chunk : {windows, Index{1}, Index{3}, Index{11}}) {
    MatrixXd theta = MatrixXd::Zero(3, windows);
    std::vector<batch::Verdict> verdict(static_cast<std::size_t>(windows));
    for (Index first = 0; first < windows; first += chunk) {
      const Index count = std::min(chunk, windows - first);
      const batch::Chunk staged = workspace.stage(run, first * o.step, count, test::skid_structure, solver.settings());
      batch::Output out;
      out.theta = theta.col(first).data();
      out.verdict = verdict.data() + first;
      solver(staged, workspace.scratch(o.length), out);
    }
    for (Index i = 0; i < windows; ++i)
      if (verdict[i] != batch::Verdict::solved) theta.col(i).setZero();
    thetas.push_back(theta);
  }
  for (const MatrixXd& theta : thetas) EXPECT_TRUE(test::same_bits(theta, thetas[0]));
}

TEST_P(Batch, EveryInstructionSetAgrees) {
  const Recording recording = hard_recording(test::skid_structure, 110, false);
  const WindowFits best = fit_by(WindowSolver::batch, recording, options());
  for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
    hwy::SetSupportedTargetsForTest(target);
    const WindowFits fits = fit_by(WindowSolver::batch, recording, options());
    hwy::SetSupportedTargetsForTest(0);
    EXPECT_EQ(test::by_batch(fits), test::by_batch(best)) << hwy::TargetName(target);
    for (Index i = 0; i < fits.count(); ++i) {
      if (fits.status(i) != 0) continue;
      EXPECT_TRUE(near(fits.parameters.col(i), best.parameters.col(i), 1e-12)) << hwy::TargetName(target) << " " << i;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Losses, Batch,
                         ::testing::Combine(::testing::ValuesIn(test::all_losses),
                                            ::testing::Values(Prior::none, Prior::global)),
                         [](const auto& instance) {
                           return std::string(name_of(std::get<0>(instance.param))) + "_" +
                                  std::string(name_of(std::get<1>(instance.param)));
                         });

}  // namespace
}  // namespace modebank
