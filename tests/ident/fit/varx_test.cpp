#include <fstream>
#include <sstream>

#include "ident/base/not_a_number.hpp"
#include "modebank/base/error.hpp"
#include "tests/ident/ident_test_support.hpp"

namespace modebank {
namespace {

/// Rows of numbers, separated by any other characters. Lines that do not begin with a number are skipped.
Eigen::MatrixXd read_rows(const std::filesystem::path& path) {
  std::ifstream file(path);
  std::vector<std::vector<double>> rows;
  for (std::string line; std::getline(file, line);) {
    for (char& c : line) c = c == ',' ? ' ' : c;
    std::istringstream stream(line);
    std::vector<double> row;
    for (double value; stream >> value;) row.push_back(value);
    if (!row.empty()) rows.push_back(row);
  }
  Eigen::MatrixXd result(rows.size(), rows.at(0).size());
  for (std::size_t i = 0; i < rows.size(); ++i)
    for (std::size_t j = 0; j < rows[i].size(); ++j) result(i, j) = rows[i][j];
  return result;
}

/// Block i of `lags` blocks, at rows i * rows and below, holds in each column `signal` at that column + ahead - i. NaN
/// before the start of the run.
Eigen::MatrixXd lagged(const Eigen::MatrixXd& signal, Index lags, Index ahead, Index columns) {
  Eigen::MatrixXd blocks = Eigen::MatrixXd::Constant(signal.rows() * lags, columns, not_a_number);
  for (Index k = 0; k < columns; ++k)
    for (Index i = 0; i < lags; ++i)
      if (k + ahead - i >= 0) blocks.col(k).segment(i * signal.rows(), signal.rows()) = signal.col(k + ahead - i);
  return blocks;
}

/// State-space form of the model: z[k] of every sample, n x N, and v[k] of every transition, m x (N - 1).
Eigen::MatrixXd stacked_states(const LinearStructure& s, const Trajectory& run) {
  return lagged(run.state, s.state_lags, 0, run.samples());
}
Eigen::MatrixXd acting_inputs(const LinearStructure& s, const Trajectory& run) {
  return lagged(run.input, s.input_lags, 1 - s.input_delay.latest(), run.transitions());
}

/// An ARX structure na, nb, nk in modebank's form.
LinearStructure arx(Index na, Index nb, Index nk) { return {1, 1, false, na, nb, nk}; }

/// a_1 .. a_na of A(q) y = B(q) u, from the increment form y[k+1] = (1 + A_lag1) y[k] + A_lag2 y[k-1] + ...
Eigen::VectorXd a_coefficients(const LinearStructure& s, const Eigen::VectorXd& theta) {
  Eigen::VectorXd a = -theta.head(s.state_lags);
  a(0) -= 1.0;
  return a;
}

double fit_percent(const Eigen::VectorXd& y, const Eigen::VectorXd& prediction) {
  return 100.0 * (1.0 - (y - prediction).norm() / (y.array() - y.mean()).matrix().norm());
}

/// One-step predictions of every sample, from the first sample that has all lags.
Eigen::VectorXd one_step(const LinearStructure& s, const Eigen::VectorXd& theta, const Trajectory& run, Index first) {
  const LinearModel model = unpack(s, theta);
  const Eigen::MatrixXd z = stacked_states(s, run), v = acting_inputs(s, run);
  Eigen::VectorXd prediction(run.samples() - first);
  for (Index k = first; k < run.samples(); ++k) prediction(k - first) = model.next(z.col(k - 1), v.col(k - 1))(0);
  return prediction;
}

/// Predictions of the model from its own predictions; only the first samples are measured.
Eigen::VectorXd free_run(const LinearStructure& s, const Eigen::VectorXd& theta, const Trajectory& run, Index first) {
  const LinearModel model = unpack(s, theta);
  Trajectory simulated = run;
  const Eigen::MatrixXd v = acting_inputs(s, run);
  for (Index k = first; k < run.samples(); ++k)
    simulated.state(0, k) = model.next(stacked_states(s, simulated).col(k - 1), v.col(k - 1))(0);
  return simulated.state.row(0).transpose();
}

struct ArmCase {
  Index na, nb;
  double fit_train, fit_test, fit_simulation;
};

// The reference is the README of sysid_classic in the shared data: numpy's ordinary least squares on rows 0..511 with
// nk = 0.
TEST(Varx, RobotArmAsOrdinaryLeastSquaresHasIt) {
  MODEBANK_NEEDS_SHARED_DATA();
  const Eigen::MatrixXd data = read_rows(test::shared_data_dir() / "sysid_classic" / "robot_arm.dat");
  ASSERT_EQ(data.rows(), 1024);
  const Trajectory all = test::make_run(data.col(1).transpose(), data.col(0).transpose());
  const Trajectory first_half = test::make_run(data.col(1).head(512).transpose(), data.col(0).head(512).transpose());
  for (const ArmCase& c : {ArmCase{4, 4, 98.51, 98.46, 63.93}, ArmCase{4, 5, 99.66, 99.67, 77.06},
                           ArmCase{6, 6, 99.84, 99.80, 90.36}, ArmCase{10, 10, 99.96, 99.96, 96.08}}) {
    const LinearStructure s = arx(c.na, c.nb, 0);
    const Eigen::VectorXd theta = fit_global(test::make_recording({first_half}), s).theta;
    const Index lags = std::max(c.na, c.nb - 1);
    const Eigen::VectorXd y = all.state.row(0).transpose();
    const Eigen::VectorXd prediction = one_step(s, theta, all, lags);
    EXPECT_NEAR(fit_percent(y.segment(lags, 512 - lags), prediction.head(512 - lags)), c.fit_train, 0.006);
    EXPECT_NEAR(fit_percent(y.tail(512), prediction.tail(512)), c.fit_test, 0.006);
    EXPECT_NEAR(fit_percent(y, free_run(s, theta, all, lags)), c.fit_simulation, 0.006);
    if (c.nb != 5) continue;
    const Eigen::Vector4d a(-3.26563, 4.59542, -3.24417, 0.98702);
    Eigen::VectorXd b(5);
    b << -0.25207, 0.70254, -0.91299, 0.69298, -0.24323;
    EXPECT_LT((a_coefficients(s, theta) - a).cwiseAbs().maxCoeff(), 6e-6);
    EXPECT_LT((theta.tail(5) - b).cwiseAbs().maxCoeff(), 6e-6);
  }
}

TEST(Varx, BuckConverterAsOrdinaryLeastSquaresHasIt) {
  MODEBANK_NEEDS_SHARED_DATA();
  Eigen::MatrixXd data = read_rows(test::shared_data_dir() / "sysid_classic" / "buck_id.csv");
  ASSERT_EQ(data.rows(), 1001);
  for (Index j = 1; j < 3; ++j) data.col(j).array() -= data.col(j).mean();
  const Trajectory run = test::make_run(data.col(2).transpose(), data.col(1).transpose());
  const LinearStructure s = arx(2, 2, 1);
  const Eigen::VectorXd theta = fit_global(test::make_recording({run}), s).theta;
  EXPECT_LT((a_coefficients(s, theta) - Eigen::Vector2d(-0.55147, -0.40583)).cwiseAbs().maxCoeff(), 6e-6);
  EXPECT_LT((theta.tail(2) - Eigen::Vector2d(-0.30667, -0.10329)).cwiseAbs().maxCoeff(), 6e-6);
  const Eigen::VectorXd y = run.state.row(0).transpose();
  EXPECT_NEAR(fit_percent(y, free_run(s, theta, run, 2)), 58.90, 0.006);
}

TEST(Varx, CompanionFormStepsAsTheDifferenceEquation) {
  const LinearStructure s{2, 1, true, 3, 2, 2};
  std::mt19937_64 generator(3);
  boost::random::uniform_real_distribution<double> value(-0.3, 0.3);
  Eigen::VectorXd theta(s.parameters());
  for (double& entry : theta) entry = value(generator);
  EXPECT_EQ(pack(s, unpack(s, theta)), theta);
  Trajectory run = test::gaussian_run({2, 1, false}, Eigen::VectorXd::Constant(6, -0.1), 0.1, 12, generator);
  const Eigen::Map<const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>> rows(theta.data(), 2,
                                                                                                      s.regressors());
  const Index k = 7;
  Eigen::VectorXd phi(9);
  phi << run.state.col(k), run.state.col(k - 1), run.state.col(k - 2), run.input.col(k - 1), run.input.col(k - 2), 1.0;
  const Eigen::VectorXd next = unpack(s, theta).next(stacked_states(s, run).col(k), acting_inputs(s, run).col(k));
  EXPECT_LT((next.head(2) - run.state.col(k) - rows * phi).norm(), 1e-14);
  EXPECT_LT((next.tail(4) - stacked_states(s, run).col(k).head(4)).norm(), 1e-14);
}

TEST(Varx, WindowsStartWhereAllLagsLieInsideTheRun) {
  std::mt19937_64 generator(4);
  const Trajectory run = test::gaussian_run(test::skid_structure, test::skid_theta, 0.1, 60, generator);
  FitOptions options;
  options.model = "varx";
  options.state_lags = 2;
  options.input_lags = 3;
  options.input_delay = 2;
  options.length = 40;
  const WindowFits fits = fit_windows(test::make_recording({run}), options);
  EXPECT_EQ(fits.windows.front().start, 3);
  EXPECT_EQ(fits.count(), 60 - 1 - 40 - 3 + 1);
  EXPECT_EQ(fits.parameter_names(), (std::vector<std::string>{"A_lag1", "A_lag2", "B1_lag2", "B2_lag2", "B1_lag3",
                                                              "B2_lag3", "B1_lag4", "B2_lag4"}));
  EXPECT_TRUE(fits.parameters.allFinite());
}

/// y[k+1] = 1.5 y[k] - .6 y[k-1] + .5 u1[k] + .2 u1[k-1] - .3 u2[k-3] + .4 u2[k-4], without noise.
TEST(Varx, EachInputHasItsOwnDelay) {
  std::mt19937_64 generator(6);
  boost::random::uniform_real_distribution<double> value(-1.0, 1.0);
  Eigen::MatrixXd y = Eigen::MatrixXd::Zero(1, 90), u(2, 90);
  for (double& entry : u.reshaped()) entry = value(generator);
  for (Index k = 4; k < 89; ++k)
    y(k + 1) = 1.5 * y(k) - 0.6 * y(k - 1) + 0.5 * u(0, k) + 0.2 * u(0, k - 1) - 0.3 * u(1, k - 3) + 0.4 * u(1, k - 4);
  const Recording recording = test::make_recording({test::make_run(y, u)});
  const Eigen::VectorXd theta{{0.5, -0.6, 0.5, -0.3, 0.2, 0.4}};
  FitOptions options;
  options.model = "varx";
  options.state_lags = options.input_lags = 2;
  options.input_delay = InputDelays({1, 4});
  const WindowFits fits = fit_windows(recording, options);
  EXPECT_LT((fit_global(recording, fits.structure).theta - theta).norm(), 1e-9);
  EXPECT_LT((fits.parameters.colwise() - theta).cwiseAbs().maxCoeff(), 1e-9);
  EXPECT_EQ(fits.windows.front().start, 4);
  EXPECT_EQ(fits.parameter_names(),
            (std::vector<std::string>{"A_lag1", "A_lag2", "B1_lag1", "B2_lag4", "B1_lag2", "B2_lag5"}));
  options.input_delay = InputDelays({4, 4});
  const Eigen::MatrixXd listed = fit_windows(recording, options).parameters;
  options.input_delay = 4;
  EXPECT_EQ(fit_windows(recording, options).parameters, listed);
  options.input_delay = InputDelays({4, 4, 4});
  EXPECT_THROW(fit_windows(recording, options), ConfigurationError);
}

TEST(Varx, OneLagIsTheLinearModel) {
  std::mt19937_64 generator(5);
  const Recording recording =
      test::make_recording({test::gaussian_run(test::skid_structure, test::skid_theta, 0.1, 80, generator)});
  FitOptions options;
  const WindowFits linear = fit_windows(recording, options);
  options.model = "varx";
  EXPECT_EQ(fit_windows(recording, options).parameters, linear.parameters);
}

}  // namespace
}  // namespace modebank
