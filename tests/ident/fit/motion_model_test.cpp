#include <array>
#include <cmath>
#include <utility>

#include "ident/fit/fit_windows.hpp"
#include "ident/fit/linearise.hpp"
#include "ident/fit/motion_fit.hpp"
#include "modebank/base/error.hpp"
#include "modebank/ident/auto_diff_motion_model.hpp"
#include "tests/ident/fit/decay.hpp"
#include "tests/ident/fit/linear_motion.hpp"
#include "tests/ident/ident_test_support.hpp"

namespace modebank {
namespace {

ModelSettings two_states() { return {2, 2, 0.165}; }

/// A run of the model with process noise. The wheel speeds change every few samples.
Trajectory drive(const MotionModel& model, const Eigen::VectorXd& theta, const Eigen::VectorXd& noise_sd, Index samples,
                 std::mt19937_64& generator, double measurement_sd = 0.0) {
  boost::random::uniform_real_distribution<double> speed(-6.0, 6.0);
  boost::random::normal_distribution<double> noise(0.0, 1.0);
  constexpr double dt_s = 0.1;
  constexpr Index hold = 4;
  const Index n = model.states();
  Eigen::MatrixXd x = Eigen::MatrixXd::Zero(n, samples), u(2, samples);
  for (Index k = 0; k < samples; ++k)
    for (Index j = 0; j < 2; ++j) u(j, k) = k % hold == 0 ? speed(generator) : u(j, k - 1);
  for (Index k = 0; k + 1 < samples; ++k) {
    model.predict(theta.data(), x.col(k).data(), u.col(k).data(), dt_s, x.col(k + 1).data());
    for (Index i = 0; i < n; ++i) x(i, k + 1) += noise_sd(i) * noise(generator);
  }
  for (double& value : x.reshaped()) value += measurement_sd * noise(generator);
  Trajectory run = test::make_run(x, u);
  run.time_s *= dt_s;
  return run;
}

struct Exact {
  std::string name;
  ModelSettings settings;
  Eigen::VectorXd theta;
};

std::vector<Exact> exact_cases() {
  const auto vector = [](std::initializer_list<double> values) {
    return Eigen::VectorXd(Eigen::Map<const Eigen::VectorXd>(values.begin(), std::ssize(values)));
  };
  return {{"slip", {1, 2, 0.165}, vector({1.4, 0.05, 0.25})},
          {"slip", two_states(), vector({1.2, 0.15, 0.2, 0.3})},
          {"icr", {1, 2, 0.165}, vector({1.5})},
          {"icr", two_states(), vector({0.6, -0.7, 0.9, 0.8})},
          {"icr", {3, 2, 0.165}, vector({0.6, -0.7, 0.9, 0.8, -0.1})}};
}

// At slip_difference d = 0: B = g (d/2 -+ 1) r / W of left and right, g = 1 - exp(-dt / tau), so dB/dd = g r / (2 W).
TEST(MotionModel, LinearisationKnowsItsDerivativeAtZero) {
  const double track = 1.4, tau = 0.25, dt = 0.1, radius = 0.165, gain = 1.0 - std::exp(-dt / tau);
  const auto model = make_motion_model("slip", {1, 2, radius});
  const LinearisedMotion motion =
      linearise(*model, Eigen::Vector3d(track, 0.0, tau), {Eigen::VectorXd::Zero(1), Eigen::Vector2d(2.0, 3.0), dt});
  for (const Index entry : {1, 2})  // order of theta: A, B of the left wheel, B of the right wheel, c
    EXPECT_NEAR(motion.by_motion(entry, 1) / (gain * radius / (2.0 * track)), 1.0, 1e-6);
}

TEST(MotionModel, NoiselessRunsGiveTheParametersBack) {
  std::mt19937_64 generator(11);
  for (const Exact& exact : exact_cases()) {
    const auto model = make_motion_model(exact.name, exact.settings);
    ASSERT_EQ(model->parameter_count(), exact.theta.size());
    const Trajectory run = drive(*model, exact.theta, Eigen::VectorXd::Zero(exact.settings.states), 80, generator);
    const GlobalModel global = fit_global(test::make_recording({run}), *model);
    EXPECT_LT((global.theta - exact.theta).cwiseAbs().maxCoeff(), 1e-8) << exact.name << " " << exact.settings.states;
  }
}

// Computes the model's equations independently: the body rotates about its instantaneous centres.
TEST(MotionModel, IcrMatchesThePublishedKinematics) {
  const auto model = make_motion_model("icr", {3, 2, 1.0});
  const Eigen::VectorXd theta = (Eigen::VectorXd(5) << 0.5, -0.75, 1.0, 1.0, 0.2).finished();
  const Eigen::Vector2d u(0.3, 0.8);
  Eigen::Vector3d x(0, 0, 0), next;
  model->predict(theta.data(), x.data(), u.data(), 0.1, next.data());
  const double w = (0.8 - 0.3) / 1.25;
  // Martinez et al. (2005): v_x = (V_r y_l - V_l y_r) / (y_l - y_r).
  EXPECT_NEAR(next(0), (0.8 * 0.5 + 0.3 * 0.75) / 1.25, 1e-15);
  EXPECT_NEAR(next(1), -0.2 * w, 1e-15);
  EXPECT_NEAR(next(2), w, 1e-15);
}

TEST(MotionModel, DerivativesAreThoseOfDifferences) {
  const auto model = make_motion_model("slip", two_states());
  const Eigen::VectorXd theta = (Eigen::VectorXd(4) << 1.2, 0.15, 0.2, 0.3).finished();
  const Eigen::Vector2d x(0.4, -0.2), u(3.0, 5.0);
  Eigen::Vector2d next, above, below;
  Eigen::Matrix<double, 2, 4, Eigen::RowMajor> by_theta;
  Eigen::Matrix<double, 2, 2, Eigen::RowMajor> by_x, by_u;
  model->predict(theta.data(), x.data(), u.data(), 0.1, next.data(), by_theta.data(), by_x.data(), by_u.data());
  constexpr double h = 1e-6;
  const auto check = [&](Eigen::VectorXd at, auto call, const auto& column, Index j) {
    at(j) += h;
    call(at, above);
    at(j) -= 2 * h;
    call(at, below);
    EXPECT_LT((column - (above - below) / (2 * h)).norm(), 1e-9);
  };
  for (Index j = 0; j < 4; ++j)
    check(
        theta, [&](const auto& t, auto& out) { model->predict(t.data(), x.data(), u.data(), 0.1, out.data()); },
        by_theta.col(j), j);
  for (Index j = 0; j < 2; ++j) {
    check(
        x, [&](const auto& t, auto& out) { model->predict(theta.data(), t.data(), u.data(), 0.1, out.data()); },
        by_x.col(j), j);
    check(
        u, [&](const auto& t, auto& out) { model->predict(theta.data(), x.data(), t.data(), 0.1, out.data()); },
        by_u.col(j), j);
  }
}

/// Counts the full-rank windows. For each parameter, also counts the windows whose true value lies within three
/// standard errors.
struct Recovery {
  Index windows = 0;
  Eigen::ArrayXi inside;
};

Recovery recovery(const WindowFits& fits, const Eigen::VectorXd& theta) {
  Recovery result{0, Eigen::ArrayXi::Zero(theta.size())};
  for (Index i = 0; i < fits.count(); ++i) {
    const LocalModel fit = fits.at(i);
    if (fit.status != FitStatus::converged) continue;
    ++result.windows;
    const Eigen::ArrayXd t = (fit.theta - theta).array() / fit.covariance.diagonal().array().sqrt();
    result.inside += (t.abs() <= 3.0).cast<int>();
  }
  return result;
}

// A t variable with 22 degrees of freedom lies within three standard errors with probability 99.3 %.
TEST(MotionModel, EachSlipParameterLiesWithinThreeStandardErrors) {
  std::mt19937_64 generator(17);
  for (const Exact& exact : exact_cases()) {
    if (exact.name != "slip") continue;
    const auto model = make_motion_model("slip", exact.settings);
    std::vector<Trajectory> runs;
    const Eigen::VectorXd noise = Eigen::VectorXd::Constant(exact.settings.states, 0.03);
    for (int i = 0; i < 80; ++i) {
      runs.push_back(drive(*model, exact.theta, noise, 26 * 25, generator));
      runs.back().run = std::to_string(i);
    }
    FitOptions options;
    options.model = "slip";
    options.wheel_radius_m = exact.settings.wheel_radius_m;
    options.prior = Prior::none;
    options.step = options.length;
    for (const Loss loss : {Loss::trivial, Loss::huber}) {
      options.loss = loss;
      const Recovery found = recovery(fit_windows(test::make_recording(runs), options), exact.theta);
      EXPECT_GT(found.windows, 1800);
      for (Index j = 0; j < found.inside.size(); ++j) {
        const double share = found.inside(j) / static_cast<double>(found.windows);
        EXPECT_GE(share, 0.985) << exact.settings.states << " states, " << name_of(loss) << ", "
                                << model->parameters()[j].name;
        RecordProperty(std::string(name_of(loss)) + std::to_string(exact.settings.states) + "_" + std::to_string(j),
                       std::to_string(share));
      }
    }
  }
}

TEST(MotionModel, LinearModelThroughEitherDoorIsTheSame) {
  std::mt19937_64 generator(19);
  const Trajectory run = test::gaussian_run(test::skid_structure, test::skid_theta, 0.1, 26, generator);
  const auto motion = test::make_linear_motion(test::skid_structure);
  const Eigen::VectorXd sigma = Eigen::VectorXd::Constant(1, 0.1);
  const ParameterPrior prior{Eigen::Vector3d(-0.2, -0.3, 0.3), Eigen::Vector3d(0.2, 0.3, 0.4)};
  for (Index l = 0; l < std::ssize(EnumNames<Loss>::values); ++l)
    for (const CovarianceKind kind : {CovarianceKind::model, CovarianceKind::sandwich})
      for (const ParameterPrior* p : {static_cast<const ParameterPrior*>(nullptr), &prior}) {
        FitOptions options = test::whole_run(run, static_cast<Loss>(l));
        options.covariance = kind;
        const LocalModel linear = fit_window(run, 0, test::skid_structure, options, sigma, p);
        const ModelResiduals residuals(*motion, {{&run, 0, run.transitions()}});
        const LocalModel general = fit_model(residuals, make_model_estimator(*motion, options), sigma,
                                             Eigen::VectorXd::Zero(1), p, Eigen::Vector3d::Zero());
        // Ceres stops if costs are equal up to rounding; theta is then within about sqrt(2 epsilon cost) = 5e-8
        // standard errors.
        const Eigen::ArrayXd standard_error = linear.covariance.diagonal().array().sqrt();
        EXPECT_LT(((general.theta - linear.theta).array() / standard_error).abs().maxCoeff(), 5e-7)
            << name_of(options.loss);
        EXPECT_LT((general.covariance - linear.covariance).norm(), 5e-8 * linear.covariance.norm());
        EXPECT_NEAR(general.noise_variance(0), linear.noise_variance(0), 1e-9 * linear.noise_variance(0));
        EXPECT_NEAR(general.condition, linear.condition, 1e-8 * linear.condition);
        EXPECT_EQ(general.rank, linear.rank);
        EXPECT_EQ(general.inlier_fraction, linear.inlier_fraction);
        EXPECT_EQ(general.status, linear.status);
        if (!p) continue;
        EXPECT_LT((general.information - linear.information).norm(), 1e-7);
      }
}

TEST(MotionModel, UnexcitedWindowsAreAStatusAndTakeThePrior) {
  const auto model = make_motion_model("slip", {1, 2, 0.165});
  std::mt19937_64 generator(29);
  const Eigen::Vector3d theta(1.4, 0.0, 0.3);
  Trajectory moving = drive(*model, theta, Eigen::VectorXd::Constant(1, 0.01), 200, generator);
  Trajectory still = moving;
  still.run = "01";
  still.state.setZero();
  still.input.setConstant(2.0);
  FitOptions options;
  options.model = "slip";
  options.wheel_radius_m = 0.165;
  const WindowFits fits = fit_windows(test::make_recording({moving, still}), options);
  const LocalModel last = fits.at(fits.count() - 1);
  EXPECT_EQ(last.status, FitStatus::rank_deficient);
  EXPECT_TRUE(last.theta.allFinite());
  EXPECT_NEAR(last.covariance(0, 0), fits.prior_sd(0) * fits.prior_sd(0), 1e-6 * fits.prior_sd(0));
  EXPECT_LT(last.information(0), 1e-6);
  options.prior = Prior::none;
  EXPECT_TRUE(std::isnan(fit_windows(test::make_recording({still, moving}), options).at(0).covariance(0, 0)));
}

/// docs/howto/how_many_modes.md shows tests/ident/fit/decay.hpp.
TEST(MotionModel, TheExampleOfThePagesIsAWholeModel) {
  const auto model = models::make_decay({});
  const Eigen::Vector2d theta(0.7, 1.3);
  std::mt19937_64 generator(31);
  boost::random::uniform_real_distribution<double> command(-1.0, 1.0);
  Eigen::MatrixXd x = Eigen::MatrixXd::Zero(1, 60), u(1, 60);
  for (double& value : u.reshaped()) value = command(generator);
  for (Index k = 0; k + 1 < 60; ++k)  // the closed form of the motion
    x(0, k + 1) = 1.3 * u(0, k) + (x(0, k) - 1.3 * u(0, k)) * std::exp(-1.0 / 0.7);
  FitOptions options;
  options.model = "decay";
  const WindowFits fits = fit_windows(test::make_recording({test::make_run(x, u)}), options, *model);
  for (Index i = 0; i < fits.count(); ++i) EXPECT_LT((fits.parameters.col(i) - theta).norm(), 1e-6);
}

/// The equation of LinearMotion, which has hand-written derivatives: one state, two inputs.
struct LinearFunctor {
  template <class T>
  void operator()(const T* theta, const T* x, const T* u, double, T* next) const {
    next[0] = x[0] + theta[0] * x[0] + theta[1] * u[0] + theta[2] * u[1] + theta[3];
  }
};

std::vector<ModelParameter> named(const std::vector<std::string>& names) {
  std::vector<ModelParameter> parameters;
  for (const std::string& name : names) parameters.push_back({name, ""});
  return parameters;
}

TEST(AutoDiffMotionModel, GivesTheDerivativesByHand) {
  const LinearStructure structure{1, 2, true};
  const test::LinearMotion by_hand(structure);
  const AutoDiffMotionModel<LinearFunctor, 1, 2, 4> model({}, "linear", named(structure.parameter_names()));
  const double theta[]{-0.3, 0.4, -0.5, 0.1}, x[]{0.7}, u[]{-1.0, 2.0};
  std::array<double, 8> a{}, b{};
  model.predict(theta, x, u, 0.1, &a[0], &a[1], &a[5], &a[6]);
  by_hand.predict(theta, x, u, 0.1, &b[0], &b[1], &b[5], &b[6]);
  for (std::size_t i = 0; i < a.size(); ++i) EXPECT_NEAR(a[i], b[i], 1e-15) << i;
  double alone = 0.0;
  model.predict(theta, x, u, 0.1, &alone);
  EXPECT_EQ(alone, a[0]);
}

TEST(AutoDiffMotionModel, RefusesAnotherNumberOfParameters) {
  using Model = AutoDiffMotionModel<LinearFunctor, 1, 2, 4>;
  EXPECT_THROW(Model({}, "linear", named({"a", "b"})), std::invalid_argument);
}

/// Derivatives of a function of two numbers. They are compared with central differences, whose error is about 1e-9.
template <class F>
void expect_slopes(const char* name, F f) {
  constexpr double step = 1e-6;
  for (const auto& [a, b] : {std::pair{0.4, 1.3}, {1.1, 0.7}}) {
    const Dual<2> result = f(Dual<2>(a, 0), Dual<2>(b, 1));
    EXPECT_EQ(result.value, f(a, b)) << name;
    EXPECT_NEAR(result.slope[0], (f(a + step, b) - f(a - step, b)) / (2.0 * step), 1e-8) << name;
    EXPECT_NEAR(result.slope[1], (f(a, b + step) - f(a, b - step)) / (2.0 * step), 1e-8) << name;
  }
}

TEST(Dual, HasTheDerivativesOfFiniteDifferences) {
  using namespace std;
  expect_slopes("arithmetic", [](auto a, auto b) { return (2.0 - a * b) / (a + 3.0 * b) - -b / 7.0; });
  expect_slopes("in place", [](auto a, auto b) {
    auto c = a;
    c += b;
    c *= a;
    c -= b;
    c /= a;
    return c;
  });
  expect_slopes("comparison", [](auto a, auto b) { return a < b ? a * a : b * a; });
  expect_slopes("exp, log", [](auto a, auto b) { return exp(a * b) * log(a + b); });
  expect_slopes("sqrt, abs", [](auto a, auto b) { return sqrt(a) * abs(a - b); });
  expect_slopes("sin, cos, tan", [](auto a, auto b) { return sin(a) * cos(b) + tan(a); });
  expect_slopes("tanh, atan", [](auto a, auto b) { return tanh(a) * atan(b); });
  expect_slopes("atan2", [](auto a, auto b) { return atan2(a, b); });
  expect_slopes("hypot", [](auto a, auto b) { return hypot(a, b); });
  expect_slopes("pow", [](auto a, auto b) { return pow(a, b); });
  expect_slopes("pow of a whole number", [](auto a, auto b) { return pow(a - b, 2.0) + pow(2.0, b); });
}

TEST(MotionModel, UnknownModelsAndWrongStatesAreSaid) {
  EXPECT_EQ(motion_model_names(), (std::vector<std::string>{"icr", "slip"}));
  EXPECT_THROW(make_motion_model("sliip", two_states()), ConfigurationError);
  EXPECT_THROW(make_motion_model("slip", {3, 2, 1.0}), ConfigurationError);
  EXPECT_THROW(make_motion_model("icr", {1, 3, 1.0}), ConfigurationError);
}

}  // namespace
}  // namespace modebank
