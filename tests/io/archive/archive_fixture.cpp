#include "tests/io/archive/archive_fixture.hpp"

#include <limits>

#include "ident/base/not_a_number.hpp"

namespace modebank::test {

namespace {

constexpr Index modes = 3;
constexpr Index length = 5;

Recording make_recording(Index n, Index m) {
  Recording recording;
  const char* state_units[] = {"rad/s", "m/s"};
  const char* input_units[] = {"m/s", "", "V"};
  for (Index i = 0; i < n; ++i) recording.states.push_back({"x" + std::to_string(i), state_units[i % 2]});
  for (Index i = 0; i < m; ++i) recording.inputs.push_back({"u" + std::to_string(i), input_units[i % 3]});
  // Printable names that are unusual in files. They are not in byte order.
  const char* names[] = {"run 2", "Gelände.ä", "10"};
  for (Index r = 0; r < 3; ++r) {
    const Index samples = 12 + r;
    Trajectory run;
    run.run = names[r];
    run.role = r == 1 ? Role::test : Role::train;
    run.time_s = Eigen::VectorXd::LinSpaced(samples, 0.1, 3.0);
    run.state = pattern(n, samples, 1000.0 * static_cast<double>(r));
    run.input = pattern(m, samples, 0.0);
    if (r != 2) run.truth = pattern(n, samples, 7.0);
    run.lag_s = 0.1 * static_cast<double>(r);
    recording.runs.push_back(run);
  }
  recording.runs[0].state(0, 3) = not_a_number;
  recording.runs[0].file = "/data/pro_00.csv";
  return recording;
}

LagReport make_lag_report(const std::vector<Trajectory>& runs) {
  LagReport report;
  report.correction = LagCorrection::pooled;
  report.lag = {0.25, 0.125, 0.5, 2};
  report.scores = {{LagCorrection::none, 35, 1.5, 0.25, 0.0, 0.0},
                   {LagCorrection::pooled, 35, 1.75, 0.125, 0.25, 0.0625}};
  for (const Trajectory& run : runs) {
    RunLag& entry = report.runs.emplace_back();
    entry.run = run.run;
    entry.status = run.role == Role::train ? LagStatus::at_edge : LagStatus::not_estimated;
    entry.lag_s = run.role == Role::train ? -0.75 : not_a_number;
    entry.applied_lag_s = run.lag_s;
  }
  return report;
}

WindowFits make_windows_fits(const LinearStructure& structure) {
  const Index n = structure.states, p = structure.parameters(), count = 9;
  WindowFits fits;
  fits.structure = structure;
  fits.length = length;
  fits.step = 2;
  fits.loss = Loss::tukey;
  for (Index i = 0; i < count; ++i) fits.windows.push_back({i % 3 == 2 ? 2 : 0, i % 7});
  fits.parameters = pattern(p, count, 1.0);
  fits.covariance = spread_pattern(p, count, 2.0);
  fits.noise_variance = pattern(n, count, 3.0);
  fits.condition = pattern(count, 1, 4.0);
  fits.condition(2) = std::numeric_limits<double>::infinity();
  fits.rank.resize(count);
  for (Index i = 0; i < count; ++i) fits.rank(i) = static_cast<int>((i + 1) % (p + 1));
  fits.information = pattern(p, count, 5.0);
  fits.information.col(1).setConstant(not_a_number);
  fits.inlier_fraction = share_pattern(count, 1, 6.0);
  fits.status = Eigen::VectorXi::LinSpaced(count, 0, 3);
  fits.r_squared = share_pattern(n, count, 12.0);
  fits.r_squared(0, 1) = not_a_number;
  fits.transitions = Eigen::VectorXi::Constant(count, length);
  fits.weighed_information = pattern(fits.structure.states, count, 14.0);
  fits.prior_sd = pattern(p, 1, 8.0);
  const auto spread = [](Index side, double base) {
    return Eigen::MatrixXd(pattern(side, side, base).selfadjointView<Eigen::Upper>());
  };
  fits.global = {pattern(p, 1, 9.0), spread(p, 10.0), spread(n, 11.0), 35};
  return fits;
}

/// base + 101 i + 1/3 on the diagonal, 1/3 in all other entries.
Eigen::MatrixXd covariance_pattern(Index side, double base) {
  Eigen::MatrixXd result = Eigen::MatrixXd::Constant(side, side, 1.0 / 3.0);
  for (Index i = 0; i < side; ++i) result(i, i) = base + 101.0 * static_cast<double>(i) + 1.0 / 3.0;
  return result;
}

MixtureResult make_mixture(const WindowFits& fits) {
  const Index features = fits.parameter_count() + 1, count = fits.count();
  MixtureResult result;
  result.mixture.weights = Eigen::Vector3d(0.5, 0.3, 0.2);
  result.mixture.means = pattern(features, modes, 20.0);
  for (Index k = 0; k < modes; ++k)
    result.mixture.covariances.push_back(covariance_pattern(features, 30.0 + static_cast<double>(k)));
  result.mixture.type = CovarianceType::diagonal;
  result.feature_names = fits.structure.parameter_names();
  result.feature_names.push_back("log_noise_variance_x0");
  result.labels = Eigen::VectorXi::Constant(count, -1);
  result.labels.head(3) << 0, 2, 1;
  Eigen::MatrixXd responsibilities = Eigen::MatrixXd::Constant(modes, count, not_a_number);
  responsibilities.leftCols(3) = share_pattern(modes, 3, 40.0);
  result.responsibilities = responsibilities;
  result.candidates.push_back({2, CovarianceType::full, -10.25, 13, 7.5, 1.0 / 3.0, 2.0 / 3.0, 17, false, 1, false, 0.5,
                               5, true, CandidateStatus::fitted, ""});
  result.candidates.push_back({3, CovarianceType::diagonal, -9.5, 20, 7.5, 0.1, 0.2, 40, true, 4, true, 0.6, 5, false,
                               CandidateStatus::failed, "its covariance is singular"});
  return result;
}

/// A valid bank with weakly coupled states and positive definite noise. A(k)(i, j) = -0.1 - (k + (i+2j)/8)/64.
Bank make_bank(const LinearStructure& structure, Index count, bool uncertain) {
  const Index n = structure.states, m = structure.inputs, p = structure.parameters();
  Bank bank;
  bank.structure = structure;
  for (Index k = 0; k < count; ++k) {
    Mode mode;
    const double scale = static_cast<double>(k) + 1.0;
    mode.model.A.resize(n, n);
    for (Index i = 0; i < n; ++i)
      for (Index j = 0; j < n; ++j)
        mode.model.A(i, j) = -0.1 - (static_cast<double>(k) + static_cast<double>(i + 2 * j) / 8.0) / 64.0;
    mode.model.B = 1e-3 * pattern(n, m, scale);
    mode.model.c = structure.intercept ? Eigen::VectorXd(1e-3 * pattern(n, 1, scale)) : Eigen::VectorXd::Zero(n);
    mode.Q = scale * Eigen::MatrixXd::Identity(n, n);
    mode.Q(0, n - 1) += 0.125;
    mode.Q(n - 1, 0) += 0.125;
    if (uncertain) mode.parameter_covariance = pattern(p, p, 50.0).selfadjointView<Eigen::Upper>();
    if (uncertain) mode.standard_error = pattern(p, 1, 60.0 + scale);
    if (uncertain) mode.Q_standard_error = pattern(n, n, 70.0 + scale);
    mode.weight = 1.0 / scale;
    bank.modes.push_back(mode);
  }
  bank.C = Eigen::MatrixXd::Identity(n, n);
  bank.R = 0.01 * Eigen::MatrixXd::Identity(n, n);
  if (count == modes) {
    Eigen::Matrix3d transition;
    transition << 0.7, 0.2, 0.1, 0.05, 0.9, 0.05, 0.15, 0.25, 0.6;
    bank.transition = TransitionMatrix(transition);
  }
  bank.initial_probability = Eigen::VectorXd::Constant(count, 1.0 / static_cast<double>(count));
  for (Index i = 0; i < n; ++i) bank.state_names.push_back("x" + std::to_string(i));
  for (Index i = 0; i < m; ++i) bank.input_names.push_back("u" + std::to_string(i));
  bank.dt_s = 2.0 / 13.0;
  if (uncertain) {
    bank.R_standard_error = pattern(n, n, 80.0);
    bank.transition_standard_error = pattern(count, count, 90.0);
    const Index features = structure.dimension() + structure.acting_inputs();
    bank.transition_logit = {pattern(count, features, 95.0), pattern(features, 1, 96.0)};
    bank.motion = {1, 0, 0};
  }
  if (uncertain) bank.screened.push_back({4, 0.01, 1.25, "unstable: spectral radius 1.25"});
  return bank;
}

}  // namespace

Eigen::MatrixXd pattern(Index rows, Index cols, double base) {
  Eigen::MatrixXd result(rows, cols);
  for (Index s = 0; s < cols; ++s)
    for (Index i = 0; i < rows; ++i)
      result(i, s) = base + 100.0 * static_cast<double>(s) + static_cast<double>(i) + 1.0 / 3.0;
  return result;
}

Eigen::MatrixXd share_pattern(Index rows, Index cols, double base) { return pattern(rows, cols, base) / 1e4; }

Eigen::MatrixXd probability_pattern(Index rows, Index cols, double base) {
  Eigen::MatrixXd result = share_pattern(rows, cols, base);
  result.bottomRows(1) = Eigen::RowVectorXd::Ones(cols) - result.topRows(rows - 1).colwise().sum();
  return result;
}

Eigen::MatrixXd spread_pattern(Index side, Index count, double base) {
  Eigen::MatrixXd result = pattern(side * side, count, base);
  for (Index i = 0; i < side; ++i)
    for (Index j = 0; j < i; ++j) result.row(i * side + j) = result.row(j * side + i);
  return result;
}

namespace {

Bank make_drifting(const LinearStructure& structure) {
  Bank bank = one_mode_bank(structure, pattern(structure.parameters(), 1, 95.0), pattern(structure.states, 1, 97.0));
  bank.model = "varx";
  bank.state_names.assign(static_cast<std::size_t>(structure.states), "wz");
  bank.input_names.assign(static_cast<std::size_t>(structure.inputs), "u");
  bank.dt_s = 0.125;
  bank.drift = {{1e-3, 10.0, 0.97}, pattern(structure.regressors(), 1, 96.0), {2.75, 321}};
  bank.running_noise = {0.75, 5.0, pattern(structure.states, 1, 98.0), {{5, 1.25}, {10, 2.5}}};
  bank.running_noise.level = pattern(structure.states, 2, 99.0);
  bank.running_noise.switching = TransitionMatrix::sticky(2, 0.75).matrix();
  return bank;
}

}  // namespace

namespace {

/// Every second sample has a label. Stamps begin at a time that a double cannot represent exactly.
void add_labels(Archive& archive) {
  archive.labels = RunLabels{{"ice", "a, b"}, {}};
  for (Trajectory& run : archive.recording->runs) {
    Eigen::VectorXi labels = Eigen::VectorXi::Constant(run.samples(), -1);
    for (Index k = 0; k < run.samples(); k += 2) labels(k) = static_cast<int>(k / 2 % 2);
    archive.labels->of_runs.push_back(labels);
    run.time_origin_ns = 1'714'557'600'000'000'001;
  }
  archive.confusion = {{"bank", Role::test, "a, b", 0, 7, 0.875},
                       {"bank", Role::test, "a, b", 1, 1, 0.125},
                       {"bank", Role::test, "ice", 0, 0, 0.0},
                       {"bank", Role::test, "ice", 1, 3, 1.0}};
}

}  // namespace

Archive full_archive(Index n, Index m) {
  Archive archive;
  archive.provenance = {
      "0.1.0",
      "2026-08-01T12:00:00Z",
      "modebank run \"a b.ini\" --window.length 5",
      std::string(64, 'c'),
      std::string(64, 'd'),
      {{"Boost", "1.74.0"}, {"Ceres", "2.1.0"}, {"compiler", "GCC 12.2"}},
      {{"/data/pro_00.csv", 9007199254740993u, std::string(64, '1')}, {"/data/Gelände.csv", 12, std::string(64, '2')}}};
  archive.config = "[window]\nlength = 5  # fünf\n";
  LinearStructure structure{n, m, m == 1};
  if (m > 1) structure.input_delay = InputDelays({1, 4});
  archive.recording = make_recording(n, m);
  archive.lag = make_lag_report(archive.recording->runs);
  archive.windows = make_windows_fits(structure);
  archive.mixture = make_mixture(*archive.windows);
  archive.bank = make_bank(structure, modes, true);
  archive.unrefined = make_bank(structure, 1, false);
  archive.measured_fit = MeasuredFit::iteration_limit;
  archive.learned_transitions = 40;
  archive.mode_names = {"ice", "", "Gelände, \"naß\""};
  add_labels(archive);
  archive.baseline = make_bank(structure, 1, false);
  archive.noise_only = make_bank(structure, modes, false);
  archive.one_motion = make_bank(structure, modes, false);
  archive.drifting = make_drifting(structure);
  add_evaluation(archive);
  return archive;
}

}  // namespace modebank::test
