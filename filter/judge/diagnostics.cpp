#include "filter/judge/diagnostics.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <iterator>
#include <tuple>
#include <utility>

#include "filter/step/gaussian.hpp"
#include "ident/base/distributions.hpp"
#include "ident/base/linalg.hpp"
#include "ident/base/not_a_number.hpp"

namespace modebank {

using Eigen::Index;

namespace {

constexpr double sure_level = 0.99;  // of the confidence intervals that decide the verdict
/// Shares of signals outside the 95 % band. If significant, they decide a verdict.
constexpr double deciding_band = 0.95, true_outside = 0.05, many_outside = 0.06, few_outside = 0.025;

/// A share of signals with its interval, for the effective number of independent samples.
struct Share {
  double value;
  Interval interval;
};

/// The share outside a central band. `time`: least autocorrelation time.
Share outside_of(double band, const SeriesByRun& z, double time, double level = 0.95) {
  const SeriesByRun hits = outside_band(z, band);
  const double samples = sample_count(hits) / std::max(autocorrelation_time(hits), time), share = mean_of(hits);
  return {share, binomial_interval(share * samples, samples, level)};
}

Share inside_of(double band, const SeriesByRun& z, double time) {
  const auto [outside, interval] = outside_of(band, z, time);
  return {1.0 - outside, {1.0 - interval.upper, 1.0 - interval.lower}};
}

bool within(double value, double least, double largest) { return value >= least && value <= largest; }

/// Whether an interval contains the whole calibrated band and values outside. If so, the data are inconclusive.
bool says_nothing(const Interval& interval, double least, double largest) {
  return interval.lower < least && interval.upper > largest;
}

/// The first rule of Calibration that holds, and the number in it. `time`: of the sizes. `correlation`: the largest
/// lag-1 autocorrelation of a signal's z by absolute value.
std::pair<Calibration, CalibrationReason> verdict_of(const ScoredSignals& of, double time, bool chi_square_nis,
                                                     double correlation) {
  using enum Calibration;
  if (sample_count(of.z) == 0.0) return {undecided, CalibrationReason::few_samples};
  const Share sure = outside_of(deciding_band, of.z, time, sure_level), close = inside_of(true_tail, of.z, time);
  const double outside = sure.value, nis = of.nis.mean(1.0);
  if (outside > many_outside && sure.interval.lower > true_outside) return {overconfident, CalibrationReason::band};
  if (outside < few_outside && sure.interval.upper < true_outside) return {underconfident, CalibrationReason::band};
  if (outside < true_outside && close.interval.lower > largest_close) return {underconfident, CalibrationReason::close};
  if (chi_square_nis) {
    const Interval expected = of.nis.mean_interval(1.0, sure_level);
    if (nis > expected.upper && nis > 1.0 + nis_tolerance) return {overconfident, CalibrationReason::nis};
    if (nis < expected.lower && nis < 1.0 - nis_tolerance) return {underconfident, CalibrationReason::nis};
  }
  if (says_nothing(outside_of(deciding_band, of.z, time).interval, least_outside, largest_outside) ||
      says_nothing(close.interval, least_close, largest_close))
    return {undecided, CalibrationReason::few_samples};
  if (!within(outside, least_outside, largest_outside)) return {undecided, CalibrationReason::band};
  if (!within(close.value, least_close, largest_close)) return {undecided, CalibrationReason::close};
  if (!within(nis, least_nis, most_nis)) return {undecided, CalibrationReason::nis};
  if (!within(correlation, -largest_correlation, largest_correlation)) return {undecided, CalibrationReason::pattern};
  return {calibrated, CalibrationReason::none};
}

/// Statistics of the samples of one row: all (mode -1), or those where one mode was the most probable one before.
struct Collected {
  Index mode, n_y;
  const std::vector<Index>& nees_states;               ///< the states of the NEES
  Index samples = 0, entropy_samples = 0, failed = 0;  ///< failed: samples without a density above zero
  double usage = 0.0, entropy = 0.0, visits = 0.0, visited = 0.0;
  double nees = 0.0, nees_degrees = 0.0;
  ScoredSignals signals = {};
  SeriesByRun z = {};  ///< only for the whole filter: one series per run and measured signal
  std::vector<double> whiteness = {};
  Eigen::VectorXd squared_state_error = Eigen::VectorXd::Zero(n_y);
  Index state_errors = 0;

  void add(const Trajectory& run, const RunEvaluation& e, const RunScores& scores) {
    signals.begin_run(e);
    SeriesByRun of_run(n_y);
    for (Index k = 0; k < e.log_density.size(); ++k) {
      if (std::isnan(e.log_density(k))) continue;
      add_probabilities(e, k);
      if (mode >= 0 && scores.likeliest(k) != mode) continue;
      ++samples;
      failed += e.log_density(k) <= lowest_log_density ? 1 : 0;
      signals.add(e, scores, k);
      for (Index i = 0; i < n_y; ++i)
        if (!std::isnan(scores.z(i, k))) of_run[i].push_back(scores.z(i, k));
      if (run.truth.size() > 0) add_truth(run, e, k);
    }
    whiteness.push_back(mode < 0 ? scores.whiteness_p : whiteness_p(of_run));
    if (mode < 0) std::move(of_run.begin(), of_run.end(), std::back_inserter(z));
    add_visits(e);
  }

  /// The largest lag-1 autocorrelation of a signal. The samples of one mode only are no neighbours, so they have none.
  double correlation() const {
    double largest = 0.0;
    for (Index i = 0; i < n_y; ++i) {
      SeriesByRun of_signal;
      for (Index run = i; run < std::ssize(z); run += n_y) of_signal.push_back(z[run]);
      const double value = largest_autocorrelation(of_signal, 1).value;
      if (std::abs(value) > std::abs(largest)) largest = value;
    }
    return largest;
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

  void add_visits(const RunEvaluation& e) {
    int before = -1;
    for (Index k = 0; k < e.log_density.size(); ++k) {
      int now = -1;
      if (e.viterbi_mode.size() > 0)
        now = e.viterbi_mode(k);
      else if (!std::isnan(e.state(0, k)))
        e.mode_probability.col(k).maxCoeff(&now);
      if (now >= 0 && (mode < 0 || now == mode)) {
        visited += 1.0;
        visits += now != before ? 1.0 : 0.0;
      }
      before = now;
    }
  }
};

constexpr double negligible_R = 1e-6;  // limit of R as a share of the innovations' variance

/// The states with measurement noise: only theirs is the covariance after the measurement not R.
std::vector<Index> states_with_noise(const Bank& bank, const std::vector<std::size_t>& runs,
                                     const std::vector<RunEvaluation>& evaluations) {
  const Index n_y = bank.C.rows();
  Eigen::ArrayXd variance = Eigen::ArrayXd::Zero(n_y);
  double samples = 0.0;
  for (const std::size_t i : runs)
    for (Index k = 0; k < evaluations.at(i).log_density.size(); ++k) {
      if (std::isnan(evaluations[i].log_density(k))) continue;
      variance += evaluations[i].innovation_covariance.col(k).reshaped(n_y, n_y).diagonal().array();
      samples += 1.0;
    }
  std::vector<Index> states;
  for (Index i = 0; i < n_y; ++i)
    if (samples > 0.0 && bank.R(i, i) * samples >= negligible_R * variance(i)) states.push_back(i);
  return states;
}

void set(const Share& share, double& value, double& lower, double& upper) {
  value = share.value;
  lower = share.interval.lower;
  upper = share.interval.upper;
}

/// The numbers of a row, and its verdict.
DiagnosticsRow make_row(const Collected& c, bool chi_square_nis) {
  DiagnosticsRow row;
  const double all = c.entropy_samples > 0 ? static_cast<double>(c.entropy_samples) : not_a_number;
  row.mode = c.mode;
  row.samples = c.samples;
  row.usage = c.usage / all;
  row.entropy = c.entropy / all;
  row.dwell = c.visits > 0.0 ? c.visited / c.visits : not_a_number;
  row.dwell_model = not_a_number;
  SeriesByRun sizes = c.signals.z;
  for (std::vector<double>& run : sizes)
    for (double& size : run) size = std::abs(size);
  const double time = cautious_time(autocorrelation_time_of_tail(sizes), sample_count(sizes));
  const SeriesByRun& z = c.signals.z;
  set(inside_of(0.50, z, time), row.coverage_50, row.coverage_50_lower, row.coverage_50_upper);
  set(inside_of(0.90, z, time), row.coverage_90, row.coverage_90_lower, row.coverage_90_upper);
  set(inside_of(0.95, z, time), row.coverage_95, row.coverage_95_lower, row.coverage_95_upper);
  set(inside_of(0.99, z, time), row.coverage_99, row.coverage_99_lower, row.coverage_99_upper);
  set(outside_of(1.0 - true_tail, z, time), row.too_far, row.too_far_lower, row.too_far_upper);
  set(inside_of(true_tail, z, time), row.too_close, row.too_close_lower, row.too_close_upper);
  row.nis_mean = c.signals.nis.mean(static_cast<double>(c.n_y));
  row.nees_mean = static_cast<double>(c.nees_states.size()) * (c.nees / c.nees_degrees);
  row.state_rmse =
      (c.squared_state_error / (c.state_errors > 0 ? static_cast<double>(c.state_errors) : not_a_number)).cwiseSqrt();
  row.whiteness_p = fisher_p(c.whiteness);
  std::tie(row.verdict, row.reason) = verdict_of(c.signals, time, chi_square_nis, c.correlation());
  if (c.mode >= 0) return row;
  const Autocorrelation colour = largest_autocorrelation(c.z);
  row.autocorrelation = colour.value;
  row.autocorrelation_lag = colour.lag;
  return row;
}

constexpr double coloured = 0.01;          // whiteness p
constexpr double noticeable_colour = 0.1;  // autocorrelation
constexpr double takes_all = 0.99;         // limit of a mode's usage; a mode above the limit is flagged
constexpr double unused = 1e-3;            // usage
constexpr double flat_entropy = 0.95;      // as a share of log K

std::string two_digits(double value) {
  std::array<char, 16> text{};
  const auto end = std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::fixed, 2).ptr;
  return {text.data(), end};
}

/// `modes`: rows of the filter's modes. `nees_states`: number of states of the NEES. `failed`: samples without density.
std::string flags_of(const DiagnosticsRow& all, const std::vector<DiagnosticsRow>& modes, Index nees_states,
                     Index failed) {
  std::string flags, list;
  const auto add_if = [&](bool holds, const std::string& flag) {
    if (holds) flags += (flags.empty() ? "" : "; ") + flag;
  };
  add_if(failed > 0, "the filter failed at " + std::to_string(failed) + " samples");
  for (const DiagnosticsRow& mode : modes) {
    add_if(mode.usage > takes_all, "one mode takes all (" + std::to_string(mode.mode) + ")");
    if (mode.usage < unused) list += (list.empty() ? " " : ", ") + std::to_string(mode.mode);
  }
  add_if(!list.empty(), (list.find(',') == std::string::npos ? "mode" : "modes") + list + " unused");
  add_if(!modes.empty() && all.entropy > flat_entropy, "probabilities flat");
  add_if(all.too_far_lower > largest_close && all.too_close_lower > largest_close, "heavy tails");
  add_if(errors_follow_a_pattern(all), "innovations not white: autocorrelation " + two_digits(all.autocorrelation) +
                                           " at lag " + std::to_string(all.autocorrelation_lag));
  add_if(all.reason == CalibrationReason::few_samples, "too few samples for a verdict");
  add_if(nees_states < all.state_rmse.size() && all.state_rmse.allFinite(),
         nees_states == 0 ? "R is nearly zero, so the state equals the measurement: no NEES"
                          : "R of some states is nearly zero, so these states equal the measurement: NEES only of the "
                            "other states");
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
  const std::vector<RunGroup> groups = run_groups(runs, role);
  if (groups.empty()) return {};
  const std::vector<std::size_t>& judged = groups.back().runs;
  const std::vector<Index> nees_states = states_with_noise(bank, judged, evaluations);
  std::vector<DiagnosticsRow> rows;
  Index failed = 0;
  for (Index mode = -1; mode < (bank.mode_count() > 1 ? bank.mode_count() : 0); ++mode) {
    Collected collected{mode, bank.C.rows(), nees_states};
    for (const std::size_t i : judged) collected.add(runs[i], evaluations.at(i), scores.at(i));
    if (mode < 0) failed = collected.failed;
    DiagnosticsRow& row = rows.emplace_back(make_row(collected, chi_square_nis));
    row.filter = filter;
    row.role = role;
    if (mode >= 0 && bank.transition_logit.empty())
      row.dwell_model = 1.0 / (1.0 - bank.transition.matrix()(mode, mode));
  }
  rows.front().flags = flags_of(rows.front(), {rows.begin() + 1, rows.end()}, std::ssize(nees_states), failed);
  return rows;
}

}  // namespace modebank
