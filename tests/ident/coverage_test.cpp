#include <Eigen/Cholesky>
#include <boost/math/distributions/fisher_f.hpp>

#include "ident/fit_window.hpp"
#include "tests/ident/ident_test_support.hpp"

namespace modebank {
namespace {

/// Share of windows whose 95 % F region holds the truth; every window is a run of its own, hence independent.
double coverage(Loss loss, CovarianceKind kind, Index windows) {
  const LinearStructure structure{1, 2, false};
  const Eigen::Vector3d theta(-0.3, -0.4, 0.5);
  constexpr Index L = 25, warm_up = 20;
  const double limit = 3 * boost::math::quantile(boost::math::fisher_f(3, L - 3), 0.95);
  std::mt19937_64 generator(31);
  std::vector<Trajectory> runs;
  for (Index i = 0; i < windows; ++i) {
    Trajectory run = test::gaussian_run(structure, theta, 0.1, warm_up + L + 1, generator);
    run.state = run.state.rightCols(L + 1).eval();
    run.input = run.input.rightCols(L + 1).eval();
    run.time_s = run.time_s.tail(L + 1).eval();
    runs.push_back(std::move(run));
  }
  FitOptions options;
  options.loss = loss;
  options.prior = Prior::none;
  options.covariance = kind;
  const WindowFits fits = fit_windows(test::make_recording(std::move(runs)), options);
  Index inside = 0;
  for (Index i = 0; i < fits.count(); ++i) {
    const LocalModel fit = fits.at(i);
    const Eigen::Vector3d error = fit.theta - theta;
    inside += error.dot(fit.covariance.ldlt().solve(error)) <= limit ? 1 : 0;
  }
  return static_cast<double>(inside) / static_cast<double>(windows);
}

constexpr Index windows = 4000;  // standard error of the share: 0.0034

TEST(Coverage, OfTheFRegionIsNominal) {
  for (const Loss loss : {Loss::trivial, Loss::huber}) {
    const double share = coverage(loss, CovarianceKind::model, windows);
    EXPECT_GT(share, 0.93) << name_of(loss);
    EXPECT_LT(share, 0.97) << name_of(loss);
    ::testing::Test::RecordProperty(std::string(name_of(loss)), std::to_string(share));
  }
}

TEST(Coverage, OfTheSandwichIsNotFarShort) {
  const double share = coverage(Loss::trivial, CovarianceKind::sandwich, windows);
  EXPECT_GT(share, 0.92);  // HC3 costs some accuracy at L = 25 even where it is not needed
  EXPECT_LT(share, 0.98);
  ::testing::Test::RecordProperty("sandwich", std::to_string(share));
}

}  // namespace
}  // namespace modebank
