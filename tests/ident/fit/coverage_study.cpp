#include "tests/ident/fit/coverage_study.hpp"

#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <Eigen/Core>
#include <boost/random/normal_distribution.hpp>
#include <boost/random/uniform_real_distribution.hpp>
#include <cmath>
#include <functional>
#include <random>

#include "ident/base/seed.hpp"
#include "ident/fit/fit_window.hpp"
#include "ident/fit/scale.hpp"
#include "ident/model/transitions.hpp"
#include "tests/support/confidence.hpp"

namespace modebank::test {
namespace {

constexpr Index length = 25;
constexpr Index warm_up = 20;
const LinearStructure structure{1, 2, false};
const Eigen::Vector3d mean_theta(-0.5, -0.4, 0.5);
const Eigen::Vector3d prior_sd(0.12, 0.3, 0.3);  // 1 + A is inside the unit circle up to 4 standard deviations

/// One independent window and its true theta.
struct Draw {
  Eigen::Vector3d theta = mean_theta;
  Trajectory run;
};

class Source {
 public:
  Source(CoverageCase which, Index window)
      : which_(which),
        window_(window),
        generator_(make_generator(31, "coverage", static_cast<std::uint64_t>(window))) {}

  Draw draw() {
    Draw draw;
    if (which_ == CoverageCase::poor)
      for (Index j = 0; j < 3; ++j) draw.theta(j) += prior_sd(j) * normal_(generator_);
    constexpr Index samples = warm_up + length + 1;
    const Eigen::MatrixXd u = inputs(samples);
    Eigen::RowVectorXd x = Eigen::RowVectorXd::Zero(samples);
    for (Index k = 0; k + 1 < samples; ++k)
      x(k + 1) = x(k) + draw.theta(0) * x(k) + draw.theta.tail<2>().dot(u.col(k)) + noise(x(k));
    draw.run.state = x.rightCols(length + 1);
    draw.run.input = u.rightCols(length + 1);
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

bool holds_the_truth(CoverageCase which, const FitOptions& options, Index window) {
  const Draw draw = Source(which, window).draw();
  const Transitions transitions = stack_transitions(draw.run, 0, length, structure);
  const Eigen::VectorXd sigma = robust_scale(transitions, decompose(transitions.regressors, excitation_tolerance));
  const ParameterPrior prior{mean_theta, prior_sd};
  const LocalModel fit =
      fit_window(draw.run, 0, structure, options, sigma, which == CoverageCase::poor ? &prior : nullptr);
  return confidence_region(fit, 0.95).contains(draw.theta);
}

}  // namespace

double measure_coverage(CoverageCase which, Loss loss, CovarianceKind kind, Index windows) {
  FitOptions options;
  options.length = length;
  options.loss = loss;
  options.covariance = kind;
  const Index inside = tbb::parallel_reduce(
      tbb::blocked_range<Index>(0, windows), Index{0},
      [&](const tbb::blocked_range<Index>& range, Index sum) {
        for (Index i = range.begin(); i < range.end(); ++i) sum += holds_the_truth(which, options, i) ? 1 : 0;
        return sum;
      },
      std::plus<>());
  return static_cast<double>(inside) / static_cast<double>(windows);
}

}  // namespace modebank::test
