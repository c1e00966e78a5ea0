#include <hwy/targets.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cstring>

#include "ident/fit/audit.hpp"
#include "modebank/base/error.hpp"
#include "tests/ident/fit/batch_test_support.hpp"
#include "tests/support/effort.hpp"
#include "tests/support/matrix_compare.hpp"

namespace modebank {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using test::near;
using test::RealVector;

bool convex(Loss loss) { return loss == Loss::trivial || loss == Loss::huber || loss == Loss::softlone; }

/// Regime changes, 5 % outliers, a stretch of standstill and samples that are missing.
Recording hard_recording(const LinearStructure& structure, Index samples, bool missing) {
  std::mt19937_64 generator(11);
  std::vector<Trajectory> runs;
  for (int i = 0; i < 3; ++i) {
    VectorXd theta = VectorXd::LinSpaced(structure.parameters(), -0.4, 0.5);
    theta(0) = -0.4;
    runs.push_back(test::gaussian_run(structure, theta, 0.05, samples, generator));
    Trajectory& run = runs.back();
    run.run = std::to_string(i);
    for (Index k = 0; k < samples; ++k)
      if (generator() % 20 == 0) run.state(0, k) += generator() % 2 ? 1.5 : -0.7;
    if (structure.inputs > 1)
      run.input.middleCols(samples / 2, 40).colwise() = VectorXd::Constant(structure.inputs, 0.3);
    if (missing) run.state(0, samples / 4) = run.input(0, samples / 3) = std::nan("");
  }
  return test::make_recording(runs);
}

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
    o.scale = ScaleSource::fixed;
    o.sigma = 0.04;
    o.length = 30;
    const WindowFits fits = fit_by(WindowSolver::batch, recording, o);
    EXPECT_GT(fits.audit.batch, fits.count() / 2);
    test::ReferenceProblem problem{o.loss, default_loss_scale(o.loss), o.sigma, {}, {}};
    if (o.prior == Prior::global) {
      problem.mean = fits.global.theta.cast<test::Real>();
      problem.precision = fits.prior_sd.array().square().inverse().cast<test::Real>();
    }
    Index unsolved = 0;
    for (Index i = 0; i < fits.count(); ++i) {
      if (fits.status(i) == 2 && o.prior == Prior::none) continue;
      if (fits.status(i) == 1 && !convex(o.loss)) {
        ++unsolved;  // says so itself
        continue;
      }
      const Window window = fits.windows[static_cast<std::size_t>(i)];
      const auto data =
          test::window_of(recording.runs[static_cast<std::size_t>(window.run)], window.start, o.length, structure);
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
      for (const ScaleSource scale : {ScaleSource::window, ScaleSource::run}) {
        FitOptions o = options();
        o.covariance = kind;
        o.scale = scale;
        if (missing) o.step *= 3;
        o.prior_sd = {0.8};
        const Recording recording = hard_recording(test::skid_structure, 130, missing);
        const WindowFits batch = fit_by(WindowSolver::batch, recording, o),
                         ceres = fit_by(WindowSolver::ceres, recording, o);
        EXPECT_EQ(ceres.audit.batch, 0);
        EXPECT_EQ(batch.audit.batch + batch.audit.ceres, batch.count());
        EXPECT_GE(batch.audit.batch, o.prior == Prior::global ? batch.count() : batch.count() / 2);
        EXPECT_TRUE(batch.status == ceres.status);
        EXPECT_TRUE(batch.rank == ceres.rank);
        if (convex(o.loss)) {
          EXPECT_LE(batch.audit.cost_difference, WindowAudit::tolerance);
          EXPECT_LE(batch.audit.gradient, 1.1e-10);  // Ceres alone, below, gets no nearer than some 1e-7
          EXPECT_LE(batch.audit.parameter_difference, 1e-6);
        }
        for (Index i = 0; i < batch.count(); ++i) {
          if (!near(batch.parameters.col(i), ceres.parameters.col(i), 1e-7)) {
            EXPECT_FALSE(convex(o.loss)) << "window " << i;
            continue;  // another minimum
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
          }
          EXPECT_NEAR(batch.noise_variance(0, i), ceres.noise_variance(0, i), 1e-6 * ceres.noise_variance(0, i));
          EXPECT_DOUBLE_EQ(batch.inlier_fraction(i), ceres.inlier_fraction(i));
        }
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
    EXPECT_GE(fits.audit.batch, expected.audit.batch) << unit;
    const MatrixXd back = Eigen::Vector3d(1, unit, unit).asDiagonal() * fits.parameters;
    for (Index i = 0; i < fits.count(); ++i) {
      if (fits.status(i) == 2 && options().prior == Prior::none) continue;  // minimum norm depends on units
      EXPECT_TRUE(near(back.col(i), expected.parameters.col(i), convex(options().loss) ? 1e-8 : 1.0))
          << unit << " window " << i;
    }
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

  // The same windows in chunks of one to eleven, so that each meets other neighbours in other lanes.
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
      if (verdict[static_cast<std::size_t>(i)] != batch::Verdict::solved) theta.col(i).setZero();
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
    EXPECT_EQ(fits.audit.batch, best.audit.batch) << hwy::TargetName(target);
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

TEST(BatchSolverOption, SaysWhatItCannotDo) {
  const Recording recording = hard_recording({2, 1, false}, 100, false);
  FitOptions o;
  o.solver = WindowSolver::batch;
  EXPECT_THROW(fit_windows(recording, o), ConfigurationError);
  o.solver = WindowSolver::automatic;
  EXPECT_EQ(fit_windows(recording, o).audit.batch, 0);
  o.solver = WindowSolver::batch;
  o.model = "slip";
  EXPECT_THROW(fit_windows(recording, o), ConfigurationError);
}

TEST(WindowSolverAuto, DependsOnTheNumberOfWindowsAlone) {
  std::mt19937_64 generator(5);
  FitOptions o;
  const auto recording = [&](Index windows) {
    return test::make_recording(
        {test::gaussian_run(test::skid_structure, test::skid_theta, 0.05, windows + o.length, generator)});
  };
  const WindowFits few = fit_windows(recording(most_ceres_windows), o);
  EXPECT_EQ(few.count(), most_ceres_windows);
  EXPECT_EQ(few.audit.ceres, most_ceres_windows);
  EXPECT_EQ(few.audit.batch, 0);
  EXPECT_EQ(few.audit.checked, 0);
  EXPECT_EQ(few.audit.ceres_method, "Ceres, then Newton's method to a relative gradient of 1e-10");
  EXPECT_EQ(few.audit.batch_method, "");
  const WindowFits many = fit_windows(recording(most_ceres_windows + 1), o);
  EXPECT_EQ(many.audit.batch + many.audit.ceres, most_ceres_windows + 1);
  EXPECT_GT(many.audit.batch, most_ceres_windows * 99 / 100);
  EXPECT_EQ(many.audit.checked, 200);
  EXPECT_EQ(many.audit.replaced, 0);
}

TEST(WindowSolverAuto, CountsSolutionsNotAttempts) {
  std::mt19937_64 generator(5);
  Trajectory run = test::gaussian_run(test::skid_structure, test::skid_theta, 0.05, 150, generator);
  run.state.middleCols(0, 40).setConstant(std::nan(""));  // windows without a transition
  for (const WindowSolver solver : {WindowSolver::ceres, WindowSolver::batch}) {
    FitOptions o;
    const WindowFits fits = fit_by(solver, test::make_recording({run}), o);
    const Index failed = (fits.status.array() == static_cast<int>(FitStatus::failed)).count();
    EXPECT_GT(failed, 0);
    EXPECT_EQ(fits.audit.batch + fits.audit.ceres, fits.count() - failed);
    EXPECT_EQ(fits.audit.batch > 0, solver == WindowSolver::batch);
  }
}

TEST(StreamedWindows, AreTheSameAsCollectedOnes) {
  const Recording recording = hard_recording(test::skid_structure, 200, true);
  FitOptions o;
  o.solver = WindowSolver::batch;
  const WindowFits whole = fit_windows(recording, o);
  Index seen = 0;
  const WindowFits common = stream_windows(recording, o, [&](const WindowFits& chunk, Index first) {
    EXPECT_EQ(first, seen);
    EXPECT_TRUE(test::same_bits(chunk.parameters, whole.parameters.middleCols(first, chunk.count())));
    seen += chunk.count();
  });
  EXPECT_EQ(seen, whole.count());
  EXPECT_EQ(count_windows(recording, {}), whole.count());
  EXPECT_EQ(common.audit.checked, whole.audit.checked);
  EXPECT_TRUE(test::same_bits(common.prior_sd, whole.prior_sd));
}

TEST(WindowAudits, SampleEveryPartAndRejectAWorseSolution) {
  EXPECT_EQ(audited_windows(50, 1).size(), 50U);
  const std::vector<Index> sample = audited_windows(1000000, 7);
  EXPECT_EQ(sample.size(), 1000U);
  EXPECT_TRUE(std::is_sorted(sample.begin(), sample.end()));
  EXPECT_NE(sample, audited_windows(1000000, 8));

  const Recording recording = hard_recording(test::skid_structure, 100, false);
  const WindowFits fits = fit_windows(recording, {});
  const FitOptions options;
  const LinearWindows context(recording, options, test::skid_structure, fits.global);
  const ParameterPrior prior{fits.global.theta, fits.prior_sd};
  LocalModel wrong = fits.at(0);
  wrong.theta(0) += 1e-3;
  WindowAudit audit;
  EXPECT_FALSE(add_to_audit(audit_window(context, fits.windows[0], &prior, fits.at(0)), audit));
  EXPECT_EQ(audit.replaced, 0);
  EXPECT_TRUE(add_to_audit(audit_window(context, fits.windows[0], &prior, wrong), audit));
  EXPECT_EQ(audit.replaced, 1);
  EXPECT_GT(audit.cost_difference, WindowAudit::tolerance);
  EXPECT_GT(audit.gradient, WindowAudit::gradient_tolerance);
}

}  // namespace
}  // namespace modebank
