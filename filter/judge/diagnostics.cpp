#include "filter/judge/diagnostics.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <iterator>
#include <utility>

#include "filter/step/gaussian.hpp"
#include "ident/base/distributions.hpp"
#include "ident/base/linalg.hpp"
#include "ident/base/not_a_number.hpp"

namespace modebank {

namespace {

using Eigen::Index;

constexpr double nis_level = 0.99;  // level of the confidence interval that decides the verdict
constexpr double outside_level = 0.99;
/// Shares of signals outside the band. If significant, they decide a verdict.
constexpr double true_outside = 0.05, many_outside = 0.06, few_outside = 0.025;

/// Verdict of the mean NIS: -1 for underconfident, 1 for overconfident, 0 for neither.
int judge_nis(const BandCounts& counts) {
  if (!counts.chi_square_nis) return 0;
  const double degrees = counts.nis_degrees, mean = mean_distance(counts.nis, degrees);
  const Interval expected = mean_distance_interval(counts.nis, degrees, nis_level);
  if (mean > expected.upper && mean > (1.0 + nis_tolerance) * degrees) return 1;
  if (mean < expected.lower && mean < (1.0 - nis_tolerance) * degrees) return -1;
  return 0;
}

bool within(double value, double least, double largest) { return value >= least && value <= largest; }

/// Whether an interval contains the whole calibrated band and values outside. If so, the data are inconclusive.
bool says_nothing(const Interval& interval, double least, double largest) {
  return interval.lower < least && interval.upper > largest;
}

/// The number that keeps a filter from being calibrated; none if every number passes. `outside`: share of the misses.
CalibrationReason doubt_of(const BandCounts& counts, double outside, const Interval& likely, const Interval& close) {
  if (says_nothing(likely, least_outside, largest_outside) || says_nothing(close, least_close, largest_close))
    return CalibrationReason::few_samples;
  if (!within(outside, least_outside, largest_outside)) return CalibrationReason::band;
  if (!within(share_of(counts.close), least_close, largest_close)) return CalibrationReason::close;
  if (!within(mean_distance(counts.nis, counts.nis_degrees) / counts.nis_degrees, least_nis, most_nis))
    return CalibrationReason::nis;
  return within(counts.correlation, -largest_correlation, largest_correlation) ? CalibrationReason::none
                                                                               : CalibrationReason::pattern;
}

}  // namespace

SeriesByRun as_numbers(const HitsByRun& hits) {
  SeriesByRun numbers;
  for (const std::vector<char>& run : hits) numbers.emplace_back(run.begin(), run.end());
  return numbers;
}

void BandCounts::begin_run(const RunEvaluation& run) {
  const auto samples = static_cast<std::size_t>(run.log_density.size());
  const std::size_t signals = samples * static_cast<std::size_t>(run.pit.rows());
  for (HitsByRun& hits : outside) hits.emplace_back().reserve(signals);
  far.emplace_back().reserve(signals);
  close.emplace_back().reserve(signals);
  sizes.emplace_back().reserve(signals);
  nis.begin_run(samples);
}

void BandCounts::add(const RunEvaluation& run, const RunScores& scores, Index k) {
  for (const double z : scores.z.col(k)) {
    if (std::isnan(z)) continue;
    const BandHits hits = band_hits(z);
    for (std::size_t b = 0; b < outside.size(); ++b) outside[b].back().push_back(hits.outside[b] ? 1 : 0);
    far.back().push_back(hits.far ? 1 : 0);
    close.back().push_back(hits.close ? 1 : 0);
    sizes.back().push_back(std::abs(z));
  }
  nis.add(run.nis(k), scored_signals(run, k));
}

double share_of(const HitsByRun& hits) { return mean_of(as_numbers(hits)); }

double time_by_sizes(const SeriesByRun& sizes) {
  return cautious_time(autocorrelation_time_of_tail(sizes), sample_count(sizes));
}

Interval fraction_interval(const SeriesByRun& hits, double time, double level) {
  const double samples = sample_count(hits) / std::max(autocorrelation_time(hits), time);
  return binomial_interval(mean_of(hits) * samples, samples, level);
}

Verdict verdict_of(const BandCounts& counts, double time) {
  const SeriesByRun misses = as_numbers(counts.outside[deciding_level]);
  if (sample_count(misses) == 0.0) return {};
  const double outside = mean_of(misses);
  const Interval sure = fraction_interval(misses, time, outside_level);
  if (outside > many_outside && sure.lower > true_outside) return {Calibration::overconfident, CalibrationReason::band};
  const Interval close = fraction_interval(as_numbers(counts.close), time);
  if (outside < few_outside && sure.upper < true_outside) return {Calibration::underconfident, CalibrationReason::band};
  if (outside < true_outside && close.lower > largest_close)
    return {Calibration::underconfident, CalibrationReason::close};
  if (const int nis = judge_nis(counts); nis != 0)
    return {nis > 0 ? Calibration::overconfident : Calibration::underconfident, CalibrationReason::nis};
  const CalibrationReason doubt = doubt_of(counts, outside, fraction_interval(misses, time), close);
  return {doubt == CalibrationReason::none ? Calibration::calibrated : Calibration::undecided, doubt};
}

namespace {

/// Statistics of the samples of one row: those of the whole filter (mode -1), or those where one mode was the most
/// probable one before the measurement.
struct Collected {
  Index mode;
  std::vector<Index> nees_states;                      ///< the states of the NEES
  Index samples = 0, entropy_samples = 0, failed = 0;  ///< failed: samples without a density above zero
  double usage = 0.0, entropy = 0.0, visits = 0.0, visited = 0.0;
  double nees = 0.0, nees_degrees = 0.0;
  BandCounts counts = {};
  SeriesByRun z = {};  ///< only for the whole filter: one series per run and measured signal
  std::vector<double> whiteness = {};
  Eigen::VectorXd squared_state_error = {};
  Index state_errors = 0;

  void add(const Trajectory& run, const RunEvaluation& e, const RunScores& scores) {
    counts.begin_run(e);
    SeriesByRun of_run(static_cast<std::size_t>(e.pit.rows()));
    for (Index k = 0; k < e.log_density.size(); ++k) {
      if (std::isnan(e.log_density(k))) continue;
      add_probabilities(e, k);
      if (mode >= 0 && scores.likeliest(k) != mode) continue;
      ++samples;
      failed += e.log_density(k) <= lowest_log_density ? 1 : 0;
      counts.add(e, scores, k);
      for (Index i = 0; i < e.pit.rows(); ++i)
        if (!std::isnan(scores.z(i, k))) of_run[static_cast<std::size_t>(i)].push_back(scores.z(i, k));
      if (run.truth.size() > 0) add_truth(run, e, k);
    }
    whiteness.push_back(mode < 0 ? scores.whiteness_p : whiteness_p(of_run));
    if (mode < 0) std::move(of_run.begin(), of_run.end(), std::back_inserter(z));
    add_visits(e);
  }

  /// Finds the largest lag-1 autocorrelation. The samples of one mode only are no neighbours, so they have none.
  void correlate() {
    const auto signals = static_cast<std::size_t>(squared_state_error.size());
    for (std::size_t i = 0; i < signals; ++i) {
      SeriesByRun of_signal;
      for (std::size_t run = i; run < z.size(); run += signals) of_signal.push_back(z[run]);
      const double value = largest_autocorrelation(of_signal, 1).value;
      if (std::abs(value) > std::abs(counts.correlation)) counts.correlation = value;
    }
  }

 private:
  void add_probabilities(const RunEvaluation& e, Index k) {
    const auto mu = e.mode_probability.col(k);
    ++entropy_samples;
    usage += mode < 0 ? mu.maxCoeff() : mu(mode);
    if (mu.size() < 2) return;
    double of_sample = 0.0;
    for (const double p : mu) of_sample -= p > 0.0 ? p * std::log(p) : 0.0;
    entropy += of_sample / std::log(static_cast<double>(mu.size()));
  }

  void add_truth(const Trajectory& run, const RunEvaluation& e, Index k) {
    const Index n = run.truth.rows(), all = e.state.rows();
    const Eigen::VectorXd error = e.state.col(k).head(n) - run.truth.col(k);
    if (!error.allFinite()) return;
    if (!nees_states.empty()) {
      const Eigen::MatrixXd P = e.covariance.col(k).reshaped(all, all)(nees_states, nees_states);
      const Eigen::VectorXd judged = error(nees_states);
      nees += judged.dot(solve_semidefinite(P, judged));
      nees_degrees += static_cast<double>(judged.size());
    }
    squared_state_error += error.cwiseAbs2();
    ++state_errors;
  }

  static int mode_at(const RunEvaluation& e, Index k) {
    if (e.viterbi_mode.size() > 0) return e.viterbi_mode(k);
    int likeliest = 0;
    e.mode_probability.col(k).maxCoeff(&likeliest);
    return std::isnan(e.state(0, k)) ? -1 : likeliest;
  }

  void add_visits(const RunEvaluation& e) {
    int before = -1;
    for (Index k = 0; k < e.log_density.size(); ++k) {
      const int now = mode_at(e, k);
      if (now >= 0 && (mode < 0 || now == mode)) {
        visited += 1.0;
        visits += now != before ? 1.0 : 0.0;
      }
      before = now;
    }
  }
};

constexpr double negligible_R = 1e-6;  // limit of R as a share of the innovations' variance

/// Sets a share of hits and its confidence interval.
void set_share(const HitsByRun& hits, double time, double& share, double& lower, double& upper) {
  const SeriesByRun numbers = as_numbers(hits);
  const Interval interval = fraction_interval(numbers, time);
  share = mean_of(numbers);
  lower = interval.lower;
  upper = interval.upper;
}

/// Sets the share inside a band.
void set_coverage(const HitsByRun& outside, double time, double& coverage, double& lower, double& upper) {
  set_share(outside, time, coverage, upper, lower);
  for (double* share : {&coverage, &lower, &upper}) *share = 1.0 - *share;
}

/// The states whose measurement noise is not negligible. Only for these states does the covariance after the
/// measurement differ from R.
std::vector<Index> states_with_noise(const Bank& bank, Role role, const std::vector<Trajectory>& runs,
                                     const std::vector<RunEvaluation>& evaluations) {
  const Index n_y = bank.C.rows();
  Eigen::ArrayXd variance = Eigen::ArrayXd::Zero(n_y);
  double samples = 0.0;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    if (runs[i].role != role) continue;
    const RunEvaluation& e = evaluations.at(i);
    for (Index k = 0; k < e.log_density.size(); ++k) {
      if (std::isnan(e.log_density(k))) continue;
      variance += e.innovation_covariance.col(k).reshaped(n_y, n_y).diagonal().array();
      samples += 1.0;
    }
  }
  std::vector<Index> states;
  for (Index i = 0; i < n_y; ++i)
    if (samples > 0.0 && bank.R(i, i) * samples >= negligible_R * variance(i)) states.push_back(i);
  return states;
}

DiagnosticsRow make_row(const Collected& c) {
  DiagnosticsRow row;
  const double all = c.entropy_samples > 0 ? static_cast<double>(c.entropy_samples) : not_a_number;
  row.samples = c.samples;
  row.usage = c.usage / all;
  row.entropy = c.entropy / all;
  row.dwell = c.visits > 0.0 ? c.visited / c.visits : not_a_number;
  row.dwell_model = not_a_number;
  const double time = time_by_sizes(c.counts.sizes);
  const auto& outside = c.counts.outside;
  set_coverage(outside[0], time, row.coverage_50, row.coverage_50_lower, row.coverage_50_upper);
  set_coverage(outside[1], time, row.coverage_90, row.coverage_90_lower, row.coverage_90_upper);
  set_coverage(outside[2], time, row.coverage_95, row.coverage_95_lower, row.coverage_95_upper);
  set_coverage(outside[3], time, row.coverage_99, row.coverage_99_lower, row.coverage_99_upper);
  set_share(c.counts.far, time, row.too_far, row.too_far_lower, row.too_far_upper);
  set_share(c.counts.close, time, row.too_close, row.too_close_lower, row.too_close_upper);
  row.nis_mean = mean_distance(c.counts.nis, c.counts.nis_degrees);
  row.nees_mean = static_cast<double>(c.nees_states.size()) * (c.nees / c.nees_degrees);
  row.state_rmse =
      (c.squared_state_error / (c.state_errors > 0 ? static_cast<double>(c.state_errors) : not_a_number)).cwiseSqrt();
  row.whiteness_p = fisher_p(c.whiteness);
  const Verdict verdict = verdict_of(c.counts, time);
  row.verdict = verdict.calibration;
  row.reason = verdict.reason;
  return row;
}

constexpr double coloured = 0.01;          // whiteness p
constexpr double noticeable_colour = 0.1;  // autocorrelation
constexpr double takes_all = 0.99;         // limit of a mode's usage; a mode above the limit is flagged
constexpr double unused = 1e-3;            // usage
constexpr double flat_entropy = 0.95;      // as a share of log K

void add_flag(std::string& flags, const std::string& flag) { flags += (flags.empty() ? "" : "; ") + flag; }

/// "mode 3 unused", "modes 1, 3 unused"; empty if all modes are used.
std::string unused_modes(const std::vector<DiagnosticsRow>& modes) {
  std::string list;
  int count = 0;
  for (const DiagnosticsRow& mode : modes)
    if (mode.usage < unused) list += (count++ > 0 ? ", " : " ") + std::to_string(mode.mode);
  return count == 0 ? "" : (count > 1 ? "modes" : "mode") + list + " unused";
}

std::string two_digits(double value) {
  std::array<char, 16> text{};
  const auto end = std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::fixed, 2).ptr;
  return {text.data(), end};
}

/// Flags of a filter's row, separated by "; ". `modes`: rows of the same filter's modes. `nees_states`: number of
/// states of the NEES. `failed`: samples at which the filter failed.
std::string flags_of(const DiagnosticsRow& all, const std::vector<DiagnosticsRow>& modes, Eigen::Index nees_states,
                     Eigen::Index failed) {
  std::string flags;
  if (failed > 0) add_flag(flags, "the filter failed at " + std::to_string(failed) + " samples");
  for (const DiagnosticsRow& mode : modes)
    if (mode.usage > takes_all) add_flag(flags, "one mode takes all (" + std::to_string(mode.mode) + ")");
  if (const std::string list = unused_modes(modes); !list.empty()) add_flag(flags, list);
  if (!modes.empty() && all.entropy > flat_entropy) add_flag(flags, "probabilities flat");
  if (all.too_far_lower > largest_close && all.too_close_lower > largest_close) add_flag(flags, "heavy tails");
  if (errors_follow_a_pattern(all))
    add_flag(flags, "innovations not white: autocorrelation " + two_digits(all.autocorrelation) + " at lag " +
                        std::to_string(all.autocorrelation_lag));
  if (all.reason == CalibrationReason::few_samples) add_flag(flags, "too few samples for a verdict");
  if (nees_states < all.state_rmse.size() && all.state_rmse.allFinite())
    add_flag(flags, nees_states == 0 ? "R is nearly zero, so the state equals the measurement: no NEES"
                                     : "R of some states is nearly zero, so these states equal the measurement: "
                                       "NEES only of the other states");
  return flags;
}

}  // namespace

bool errors_follow_a_pattern(const DiagnosticsRow& row) {
  return (row.whiteness_p < coloured && std::abs(row.autocorrelation) > noticeable_colour) ||
         row.reason == CalibrationReason::pattern;
}

std::vector<DiagnosticsRow> diagnose(const std::string& filter, Role role, const Bank& bank, bool chi_square_nis,
                                     const std::vector<Trajectory>& runs, const std::vector<RunEvaluation>& evaluations,
                                     const std::vector<RunScores>& scores) {
  if (std::none_of(runs.begin(), runs.end(), [role](const Trajectory& run) { return run.role == role; })) return {};
  const std::vector<Index> nees_states = states_with_noise(bank, role, runs, evaluations);
  Index failed = 0;
  const auto row_of = [&](Index mode) {
    Collected collected{mode, nees_states};
    collected.squared_state_error.setZero(bank.C.rows());
    collected.counts.nis_degrees = static_cast<double>(bank.C.rows());
    collected.counts.chi_square_nis = chi_square_nis;
    for (std::size_t i = 0; i < runs.size(); ++i)
      if (runs[i].role == role) collected.add(runs[i], evaluations.at(i), scores.at(i));
    collected.correlate();
    DiagnosticsRow row = make_row(collected);
    row.filter = filter;
    row.role = role;
    row.mode = mode;
    if (mode < 0) {
      failed = collected.failed;
      const Autocorrelation colour = largest_autocorrelation(collected.z);
      row.autocorrelation = colour.value;
      row.autocorrelation_lag = colour.lag;
    }
    if (mode >= 0 && bank.transition_logit.empty())
      row.dwell_model = 1.0 / (1.0 - bank.transition.matrix()(mode, mode));
    return row;
  };
  std::vector<DiagnosticsRow> rows{row_of(-1)};
  for (Index mode = 0; bank.mode_count() > 1 && mode < bank.mode_count(); ++mode) rows.push_back(row_of(mode));
  rows.front().flags = flags_of(rows.front(), {rows.begin() + 1, rows.end()}, std::ssize(nees_states), failed);
  return rows;
}

}  // namespace modebank
