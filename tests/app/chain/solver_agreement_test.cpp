// Every window of real and simulated runs is solved by both solvers for linear models.
#include <gtest/gtest.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <vector>

#include "ident/fit/window_fitter.hpp"
#include "ident/simulate/simulate.hpp"
#include "io/import/import.hpp"
#include "tests/ident/fit/batch_test_support.hpp"
#include "tests/support/paths.hpp"

namespace modebank {
namespace {

constexpr double stationary = 1e-10, cost_tolerance = 1e-9;

/// Differences between the two solutions of a window.
struct Comparison {
  double cost_above = 0.0;      ///< cost of the batch solver's solution, relative to the cost of Ceres' solution
  double gradient = 0.0;        ///< relative gradient at the solution of the batch solver
  double ceres_gradient = 0.0;  ///< relative gradient at the solution of Ceres and Newton's method
};

/// Both solvers have the same start: least squares or the Huber optimum.
std::vector<Comparison> compare(const Recording& recording, FitOptions options) {
  options.solver = WindowSolver::batch;
  const LinearStructure structure = linear_structure(recording.state_count(), recording.input_count(), options);
  const WindowFits fits = fit_windows(recording, options);
  EXPECT_GT(test::by_batch(fits), fits.count() * 9 / 10);
  const LinearWindows context(recording, options, structure, fits.global);
  const ParameterPrior prior{fits.global.theta, fits.prior_sd};
  std::vector<Comparison> result(static_cast<std::size_t>(fits.count()));
  tbb::parallel_for(std::size_t{0}, result.size(), [&](std::size_t w) {
    const LocalModel fit = fits.at(static_cast<Index>(w));
    const Window& window = fits.windows[w];
    const LocalModel by_ceres = context.fit(window, &prior);
    const auto data = context.load(window);
    if (by_ceres.status == FitStatus::failed || !data) return;
    const test::ReferenceProblem problem{options.loss, default_loss_scale(options.loss), data->scale.sigma(0),
                                         prior.mean.cast<test::Real>(),
                                         prior.sd.array().square().inverse().cast<test::Real>()};
    const test::Regression samples = test::window_of(context.run_of(window), window.start, options.length, structure);
    const auto gradient = [&](const LocalModel& model) {
      if (model.status == FitStatus::iteration_limit) return 0.0;  // the status of the fit already reports it
      return problem.relative_gradient(samples, model.theta.cast<test::Real>());
    };
    const auto cost = [&](const LocalModel& model) {
      return problem.terms(samples, model.theta.cast<test::Real>()).cost;
    };
    const test::Real least = std::max(cost(by_ceres), 1e-9L * static_cast<test::Real>(samples.y.size()));
    result[w] = {static_cast<double>((cost(fit) - cost(by_ceres)) / least), gradient(fit), gradient(by_ceres)};
  });
  return result;
}

/// For non-convex losses, one window of a thousand may end in another minimum.
void expect_agreement(const Recording& recording, FitOptions options, const std::string& name) {
  for (const Loss loss : test::all_losses) {
    options.loss = loss;
    const std::vector<Comparison> windows = compare(recording, options);
    const auto count = [&](auto&& condition) { return std::count_if(windows.begin(), windows.end(), condition); };
    const auto above = count([](const Comparison&c) { return c.cost_above > cost_tolerance; }),
               below = count([](const Comparison&c) { return c.cost_above < -cost_tolerance; });
    const std::string what = name + ", " + std::string(name_of(loss)) + ": of " + std::to_string(windows.size());
    const bool convex = RobustLoss(loss, 0.0).convex();
    EXPECT_LE(above, convex ? 0 : std::ssize(windows) / 1000) << what;
    EXPECT_TRUE(!convex || below == 0) << what;
    EXPECT_EQ(count([](const Comparison& c) { return !(c.gradient <= stationary); }), 0) << what;
    EXPECT_EQ(count([](const Comparison& c) { return !(c.ceres_gradient <= stationary); }), 0) << what;
    std::cout << what << " windows " << above << " above Ceres' cost, " << below << " below\n";
  }
}

TEST(SolverAgreement, EveryWindowOfTheHuskyOnIce) {
  MODEBANK_NEEDS_SHARED_DATA();
  DataOptions data;
  data.root = test::shared_data_dir().string();
  data.inputs = "borealtc/ICE/pro_*.csv";
  data.states = "borealtc/ICE/imu_*.csv";
  data.state = {"wz"};
  data.input = {"velL", "velR"};
  expect_agreement(import_data(data).recording, {}, "ice");
}

TEST(SolverAgreement, EveryWindowOfASwitchingSystemWithOutliers) {
  std::mt19937_64 generator(43);
  std::vector<Trajectory> runs;
  for (int i = 0; i < 4; ++i) {
    const Eigen::Vector3d theta = i % 2 ? Eigen::Vector3d(-0.6, -0.8, 0.75) : Eigen::Vector3d(test::skid_theta);
    runs.push_back(test::gaussian_run(test::skid_structure, theta, 0.05, 1300, generator));
    runs.back().run = std::to_string(i);
    for (Index k = 0; k < 1300; ++k)
      if (generator() % 20 == 0) runs.back().state(0, k) += generator() % 2 ? 1.5 : -0.7;
  }
  expect_agreement(test::make_recording(runs), {}, "switching");
}

}  // namespace
}  // namespace modebank
