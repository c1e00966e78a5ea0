#include "tests/app/export/exported.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <sstream>

#include "app/export/forms.hpp"
#include "tests/support/run_program.hpp"

namespace modebank::app::test {
namespace {

using modebank::test::run_program;
using modebank::test::TemporaryFolder;
using modebank::test::write_file;

constexpr int look_ahead = 5, look_every = 37;

/// Reads samples and prints the filter's estimates with 17 digits. At every 37th sample it also prints a forecast of 5
/// steps.
constexpr const char* driver = R"(#include "robot.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static double number(void) {
  char word[64];
  if (scanf("%63s", word) != 1) exit(0);
  return strtod(word, NULL);
}
static void print(const double *values, int count) {
  for (int i = 0; i < count; ++i) printf("%.17g ", values[i]);
}
int main(void) {
  static robot_filter filter, ahead;
  static robot_estimate estimate;
  double input[ROBOT_ROOM_FOR_INPUTS] = {0}, measurement[ROBOT_MEASUREMENTS];
  double held[5 * ROBOT_ROOM_FOR_INPUTS], mean[5 * ROBOT_MEASUREMENTS];
  double S[5 * ROBOT_MEASUREMENTS * ROBOT_MEASUREMENTS];
  robot_restart(&filter);
  for (int k = 0;; ++k) {
    const double time_s = number();
    for (int i = 0; i < ROBOT_INPUTS; ++i) input[i] = number();
    for (int i = 0; i < ROBOT_MEASUREMENTS; ++i) measurement[i] = number();
    robot_step(&filter, time_s, input, measurement, &estimate);
    printf("%d %.17g ", estimate.steps, estimate.log_density);
    print(estimate.prediction, ROBOT_STATES);
    print(estimate.state, ROBOT_STATES);
    print(&estimate.innovation_covariance[0][0], ROBOT_MEASUREMENTS * ROBOT_MEASUREMENTS);
    print(&estimate.covariance[0][0], ROBOT_STATES * ROBOT_STATES);
    print(estimate.mode_probability_predicted, ROBOT_MODES);
    print(estimate.mode_probability, ROBOT_MODES);
    print(estimate.innovation, ROBOT_MEASUREMENTS);
    if (k % 37 == 0) {
      for (int i = 0; i < 5 * ROBOT_INPUTS; ++i) held[i] = input[i % ROBOT_ROOM_FOR_INPUTS];
      robot_predict(&filter, &ahead, 5, held, mean, S);
      print(mean, 5 * ROBOT_MEASUREMENTS);
      print(S, 5 * ROBOT_MEASUREMENTS * ROBOT_MEASUREMENTS);
    }
    printf("\n");
  }
}
)";

/// Reads numbers one after another.
struct Numbers {
  std::istringstream text;
  explicit Numbers(const std::string& line) : text(line) {}
  double next() {
    std::string word;
    text >> word;
    return word.empty() ? std::nan("") : std::strtod(word.c_str(), nullptr);
  }
  Eigen::MatrixXd next(Index rows, Index cols) {
    Eigen::MatrixXd M(rows, cols);
    for (Index i = 0; i < rows; ++i)
      for (Index j = 0; j < cols; ++j) M(i, j) = next();
    return M;
  }
};

/// Distance of two matrices. Two unknown numbers count as equal. If only one number is unknown, the distance is
/// infinite.
double distance(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  double largest = 0.0;
  for (Index i = 0; i < a.size(); ++i) {
    const double x = a.reshaped()(i), y = b.reshaped()(i);
    if (std::isnan(x) && std::isnan(y)) continue;
    const double d = std::abs(x - y);
    largest = std::max(largest, std::isnan(d) ? INFINITY : d);
  }
  return largest;
}

double relative(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  const double scale =
      b.array().isNaN().all() ? 1.0 : std::max(b.array().isNaN().select(0.0, b).cwiseAbs().maxCoeff(), 1e-30);
  return distance(a, b) / scale;
}

/// Differences in units of the predictions' standard deviations. A missing signal has the largest standard deviation of
/// the others.
double in_deviations(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b, const Eigen::MatrixXd& S) {
  const double variance = S.array().isNaN().any() ? 1.0 : S.diagonal().minCoeff();
  return distance(a, b) / std::sqrt(std::max(variance, 1e-30));
}

std::string input_of(const Trajectory& run) {
  fmt::memory_buffer text;
  const auto to = std::back_inserter(text);
  for (Index k = 0; k < run.samples(); ++k) {
    fmt::format_to(to, "{:.17g}", run.time_s(k));
    for (const double u : run.input.col(k)) fmt::format_to(to, " {:.17g}", u);
    for (const double y : run.state.col(k)) fmt::format_to(to, " {:.17g}", y);
    fmt::format_to(to, "\n");
  }
  return fmt::to_string(text);
}

/// Difference of the forecasts for the next samples, without measurements.
double distance_ahead(BankFilter& filter, const Bank& bank, const Trajectory& run, Index k, Numbers& numbers) {
  const Index n_y = bank.C.rows();
  const std::vector<double> snapshot = filter.snapshot();
  const Eigen::MatrixXd means = numbers.next(look_ahead, n_y), S = numbers.next(look_ahead, n_y * n_y);
  const Eigen::VectorXd nothing = Eigen::VectorXd::Constant(n_y, std::nan(""));
  double largest = 0.0;
  for (Index h = 0; h < look_ahead; ++h) {
    const FilterEstimate& said = filter.step(std::nan(""), run.input.col(k), nothing);
    largest = std::max(largest,
                       in_deviations(means.row(h).transpose(), bank.C * said.prediction, said.innovation_covariance));
    largest = std::max(largest, relative(Eigen::MatrixXd(S.row(h)).reshaped(n_y, n_y), said.innovation_covariance));
  }
  filter.restore(snapshot);
  return largest;
}

Differences compare(const ExportedBank& exported, const Trajectory& run, std::istream& said) {
  const Bank& bank = exported.bank;
  const Index n = bank.structure.dimension(), n_y = bank.C.rows(), K = bank.mode_count();
  BankFilter filter(bank, exported.options);
  Differences worst;
  for (Index k = 0; k < run.samples(); ++k) {
    std::string line;
    EXPECT_TRUE(std::getline(said, line)) << "sample " << k;
    Numbers numbers(line);
    const FilterEstimate& expected = filter.step(run.time_s(k), run.input.col(k), run.state.col(k));
    EXPECT_EQ(numbers.next(), static_cast<double>(expected.steps)) << "sample " << k;
    const double log_density = numbers.next();
    const Eigen::MatrixXd prediction = numbers.next(n, 1), state = numbers.next(n, 1), S = numbers.next(n_y, n_y),
                          P = numbers.next(n, n), before = numbers.next(K, 1), after = numbers.next(K, 1),
                          innovation = numbers.next(n_y, 1);
    Differences here;
    const Eigen::MatrixXd& S_expected = expected.innovation_covariance;
    here.mean = std::max({in_deviations(prediction, expected.prediction, S_expected),
                          in_deviations(state, expected.state, S_expected),
                          in_deviations(innovation, expected.innovation, S_expected)});
    here.probability =
        std::max(distance(before, expected.mode_probability_predicted), distance(after, expected.mode_probability));
    here.covariance = std::max(relative(S, S_expected),
                               std::isnan(S(0, 0)) ? 0.0 : distance(P, expected.covariance) / S_expected.norm());
    here.log_density =
        distance(Eigen::MatrixXd::Constant(1, 1, log_density), Eigen::MatrixXd::Constant(1, 1, expected.log_density)) /
        std::max(1.0, std::isnan(expected.log_density) ? 1.0 : std::abs(expected.log_density));
    here.compared = expected.steps > 0 ? 1 : 0;
    if (k % look_every == 0) here.ahead = distance_ahead(filter, bank, run, k, numbers);
    worst.join(here);
  }
  return worst;
}

}  // namespace

void Differences::join(const Differences& other) {
  mean = std::max(mean, other.mean);
  probability = std::max(probability, other.probability);
  covariance = std::max(covariance, other.covariance);
  log_density = std::max(log_density, other.log_density);
  ahead = std::max(ahead, other.ahead);
  compared += other.compared;
}

ExportedBank as_exported(Bank bank, const FilterOptions& options) {
  const LinearStructure& s = bank.structure;
  ExportedBank exported;
  exported.filter = "bank";
  exported.archive = "test.h5";
  exported.options = options;
  exported.verdict = Calibration::calibrated;
  exported.verdict_words = "calibrated";
  exported.judged_on = "held-out";
  exported.coverage_95 = 0.95;
  for (Index i = 0; i < s.dimension(); ++i) exported.states.push_back({fmt::format("x{}", i), "rad/s"});
  for (Index i = 0; i < s.acting_inputs(); ++i) exported.inputs.push_back({fmt::format("u{}", i), "m/s"});
  for (Index i = 0; i < s.inputs; ++i) exported.recorded_inputs.push_back({fmt::format("u{}", i), "m/s"});
  for (Index i = 0; i < bank.C.rows(); ++i) exported.measurements.push_back({fmt::format("y{}", i), "rad/s"});
  for (Index i = 0; i < s.parameters(); ++i) exported.parameter_names.push_back(fmt::format("p{}", i));
  exported.parameter_units.resize(exported.parameter_names.size());
  for (Index k = 0; k < bank.mode_count(); ++k) {
    exported.mode_names.push_back(fmt::format("mode {}", k));
    Motion& alone = exported.motions.emplace_back();
    alone.number = k;
    alone.modes = {k};
    alone.use = 1.0 / static_cast<double>(bank.mode_count());
    const LinearModel& model = bank.modes[k].model;
    exported.errors.push_back({0.0 * model.A, 0.0 * model.B, 0.0 * model.c});
  }
  exported.bank = std::move(bank);
  return exported;
}

Trajectory disturbed(Trajectory run, double dt_s) {
  run.time_s = dt_s * Eigen::VectorXd::LinSpaced(run.samples(), 0.0, static_cast<double>(run.samples() - 1));
  const auto later = [&](Index from, double periods) {
    run.time_s.tail(run.samples() - from).array() += periods * dt_s;
  };
  for (Index k = 20; k < run.samples(); k += 23) run.state(0, k) = std::nan("");
  for (Index k = 30; k < run.samples(); k += 31) run.state.col(k).setConstant(std::nan(""));
  for (Index k = 50; k < std::min<Index>(54, run.samples()); ++k) run.state.col(k).setConstant(INFINITY);
  if (run.input.rows() > 0 && run.samples() > 60) run.input(0, 60) = std::nan("");
  if (run.samples() > 80) later(80, 3.0);
  if (run.samples() > 90) later(90, 0.6);
  if (run.samples() > 120) later(120, 49.2);
  if (run.samples() > 150) later(150, 70.0);
  return run;
}

Differences differences_of_c(const ExportedBank& exported, const std::vector<Trajectory>& runs) {
  const TemporaryFolder folder;
  const auto file = [&](const std::string& name) { return (folder.path() / name).string(); };
  const CFiles files = to_c(exported, "robot");
  write_file(file("robot.h"), files.header);
  write_file(file("robot.c"), files.source);
  write_file(file("driver.c"), driver);
  Differences worst;
  for (const std::string compiler : {"gcc", "clang"}) {
    if (!modebank::test::has_program(compiler)) continue;
    const auto compiled = run_program({compiler, "-std=c99", "-pedantic", "-Wall", "-Wextra", "-Wconversion", "-Werror",
                                       "-O1", "-o", file("driver"), file("driver.c"), file("robot.c"), "-lm"});
    EXPECT_EQ(compiled.status, 0) << compiler << compiled.err;
    for (const Trajectory& run : runs) {
      write_file(file("samples"), input_of(run));
      const auto result = run_program(
          {"/bin/sh", "-c", "\"$1\" < \"$2\" > \"$3\"", "sh", file("driver"), file("samples"), file("said")});
      EXPECT_EQ(result.status, 0) << result.err;
      std::ifstream said(file("said"));
      worst.join(compare(exported, run, said));
    }
  }
  return worst;
}

}  // namespace modebank::app::test
