#include "tests/ident/fit/coverage_study.hpp"

#include <Eigen/Core>
#include <boost/random/normal_distribution.hpp>
#include <boost/random/uniform_real_distribution.hpp>
#include <cmath>
#include <random>

#include "modebank/ident/windows.hpp"
#include "tests/ident/public_run.hpp"
#include "tests/support/confidence.hpp"

namespace modebank::test {
namespace {

using Eigen::Index;

constexpr Index length = 25;
constexpr Index warm_up = 20;
const Eigen::Vector3d mean_theta(-0.5, -0.4, 0.5);
const Eigen::Vector3d prior_sd(0.12, 0.3, 0.3);  // 1 + A is inside the unit circle up to 4 standard deviations

/// One independent window and its true theta.
struct Draw {
  Eigen::Vector3d theta = mean_theta;
  RecordedRun run;
};

class Source {
 public:
  Source(CoverageCase which, Index window)
      : which_(which), window_(window), generator_(static_cast<std::uint64_t>(window)) {}

  Draw draw() {
    Draw draw;
    if (which_ == CoverageCase::poor)
      for (Index j = 0; j < 3; ++j) draw.theta(j) += prior_sd(j) * normal_(generator_);
    constexpr Index samples = warm_up + length + 1;
    const Eigen::MatrixXd u = inputs(samples);
    Eigen::RowVectorXd x = Eigen::RowVectorXd::Zero(samples);
    for (Index k = 0; k + 1 < samples; ++k)
      x(k + 1) = x(k) + draw.theta(0) * x(k) + draw.theta.tail<2>().dot(u.col(k)) + noise(x(k));
    draw.run = public_run(x.rightCols(length + 1), u.rightCols(length + 1));
    return draw;
  }

 private:
  Eigen::MatrixXd inputs(Index samples) {
    Eigen::MatrixXd u(2, samples);
    for (double& value : u.reshaped()) value = level_(generator_);
    if (which_ != CoverageCase::poor) return u;
    const Eigen::Vector2d command = u.col(0);
    const double variation = window_ % 2 == 0 ? 0.0 : 0.02;
    return (variation * u).colwise() + command;
  }

  double noise(double x) {
    constexpr double sd = 0.1, outlier_share = 0.05, outlier_size = 10.0;
    const double z = normal_(generator_);
    if (which_ == CoverageCase::growing_noise) return z * sd * (0.2 + 3.0 * std::abs(x));
    if (which_ == CoverageCase::outliers && share_(generator_) < outlier_share) return z * sd * outlier_size;
    return z * sd;
  }

  CoverageCase which_;
  Index window_;
  std::mt19937_64 generator_;
  boost::random::normal_distribution<double> normal_{0.0, 1.0};
  boost::random::uniform_real_distribution<double> level_{-1.0, 1.0}, share_{0.0, 1.0};
};

}  // namespace

double measure_coverage(CoverageCase which, Loss loss, CovarianceKind kind, std::ptrdiff_t windows) {
  FitOptions options;
  options.length = length;
  options.loss = loss;
  options.covariance = kind;
  options.prior = Prior::none;
  options.solver = WindowSolver::ceres;
  std::vector<Eigen::Vector3d> truth;
  RecordedRuns runs;
  for (Index i = 0; i < windows; ++i) {
    Draw draw = Source(which, i).draw();
    truth.push_back(draw.theta);
    runs.runs.push_back(std::move(draw.run));
  }
  if (which == CoverageCase::poor) {
    options.prior = Prior::global;
    options.prior_sd = to_vector(prior_sd);
    runs.runs.push_back(run_that_decides(mean_theta));
  }
  const ident::Windows fits = ident::fit_windows(runs, options);
  Index inside = 0;
  for (Index i = 0; i < windows; ++i) {
    FittedTheta fit{view(fits.theta).col(i), view(fits.covariance).col(i).reshaped(3, 3), {}, 1, length};
    fit.information.setConstant(3, std::nan(""));
    if (!fits.prior_sd.empty())
      fit.information = 1.0 - fit.covariance.diagonal().array() / view(fits.prior_sd).array().square();
    inside += confidence_region(fit, 0.95).contains(truth[i]) ? 1 : 0;
  }
  return static_cast<double>(inside) / static_cast<double>(windows);
}

}  // namespace modebank::test
