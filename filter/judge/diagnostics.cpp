#include "filter/judge/diagnostics.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <iterator>
#include <utility>

#include "filter/step/gaussian.hpp"
#include "ident/base/linalg.hpp"
#include "ident/base/not_a_number.hpp"

namespace modebank {

namespace {

using Eigen::Index;

/// Statistics of the samples of one row.
struct Collected {
  Eigen::Index samples = 0, entropy_samples = 0, failed = 0;  ///< failed: samples without a density above zero
  double usage = 0.0, entropy = 0.0, visits = 0.0, visited = 0.0;
  BandCounts counts;
  SquaredDistances nees;
  SeriesByRun z;  ///< only for the whole filter: one series per run and measured signal
  std::vector<double> whiteness;
  Eigen::VectorXd squared_state_error;
  Eigen::Index state_errors = 0;
};

/// Collects counts over runs, for the whole filter (mode -1) or one mode.
class Collector {
 public:
  /// `nees_states`: the states of the NEES.
  Collector(const Bank& bank, Index mode, bool chi_square_nis, const std::vector<Index>& nees_states)
      : mode_(mode), nees_states_(nees_states) {
    sums.squared_state_error.setZero(bank.C.rows());
    sums.counts.nis_degrees = static_cast<double>(bank.C.rows());
    sums.counts.chi_square_nis = chi_square_nis;
  }

  Collected sums;

  void add(const Trajectory& run, const RunEvaluation& e, const RunScores& scores) {
    BandCounts& counts = sums.counts;
    for (HitsByRun* hits : {&counts.far, &counts.close}) hits->emplace_back();
    for (HitsByRun& hits : counts.outside) hits.emplace_back();
    counts.sizes.emplace_back();
    for (SquaredDistances* distances : {&counts.nis, &sums.nees}) distances->begin_run();
    OutputSeries z(static_cast<std::size_t>(e.pit.rows()));  // samples of one mode only
    if (mode_ < 0) make_room(e, z);
    for (Index k = 0; k < e.log_density.size(); ++k) {
      if (std::isnan(e.log_density(k))) continue;
      add_probabilities(e, k);
      if (mode_ >= 0 && scores.likeliest(k) != mode_) continue;
      add_scores(e, k, scores, z);
      if (run.truth.size() > 0) add_truth(run, e, k);
    }
    sums.whiteness.push_back(mode_ < 0 ? scores.whiteness_p : whiteness_p(z));
    if (mode_ < 0) sums.z.insert(sums.z.end(), std::make_move_iterator(z.begin()), std::make_move_iterator(z.end()));
    add_visits(e);
  }

  /// Finds the largest lag-1 autocorrelation. The samples of one mode only are no neighbours, so they have none.
  void correlate() {
    const std::size_t signals = static_cast<std::size_t>(sums.squared_state_error.size());
    for (std::size_t i = 0; i < signals; ++i) {
      SeriesByRun z;
      for (std::size_t run = i; run < sums.z.size(); run += signals) z.push_back(sums.z[run]);
      const double value = largest_autocorrelation(z, 1).value;
      if (std::abs(value) > std::abs(sums.counts.correlation)) sums.counts.correlation = value;
    }
  }

 private:
  /// Reserves memory for all samples of a run. Without this, growing series would take up to twice the memory.
  void make_room(const RunEvaluation& e, OutputSeries& z) {
    BandCounts& counts = sums.counts;
    const auto samples = static_cast<std::size_t>(e.log_density.size()), all = samples * z.size();
    for (HitsByRun* hits : {&counts.far, &counts.close}) hits->back().reserve(all);
    for (HitsByRun& hits : counts.outside) hits.back().reserve(all);
    counts.sizes.back().reserve(all);
    for (SeriesByRun* series : {&counts.nis.value, &counts.nis.degrees}) series->back().reserve(samples);
    for (std::vector<double>& output : z) output.reserve(samples);
  }

  Index mode_;
  const std::vector<Index>& nees_states_;
  ScoreBands bands_;

  void add_probabilities(const RunEvaluation& e, Index k) {
    const auto mu = e.mode_probability.col(k);
    ++sums.entropy_samples;
    sums.usage += mode_ < 0 ? mu.maxCoeff() : mu(mode_);
    if (mu.size() < 2) return;
    double entropy = 0.0;
    for (const double p : mu) entropy -= p > 0.0 ? p * std::log(p) : 0.0;
    sums.entropy += entropy / std::log(static_cast<double>(mu.size()));
  }

  void add_scores(const RunEvaluation& e, Index k, const RunScores& scores, OutputSeries& z) {
    ++sums.samples;
    sums.failed += e.log_density(k) <= lowest_log_density ? 1 : 0;
    for (Index i = 0; i < e.pit.rows(); ++i) {
      if (std::isnan(e.pit(i, k))) continue;
      const double score = scores.z(i, k);
      const ScoreBands::Hits hits = bands_.of(score);
      for (std::size_t b = 0; b < hits.outside.size(); ++b)
        sums.counts.outside[b].back().push_back(hits.outside[b] ? 1 : 0);
      sums.counts.far.back().push_back(hits.far ? 1 : 0);
      sums.counts.close.back().push_back(hits.close ? 1 : 0);
      sums.counts.sizes.back().push_back(std::abs(score));
      z[static_cast<std::size_t>(i)].push_back(score);
    }
    sums.counts.nis.add(e.nis(k), scored_signals(e, k));
  }

  void add_truth(const Trajectory& run, const RunEvaluation& e, Index k) {
    const Index n = run.truth.rows(), all = e.state.rows();
    const Eigen::VectorXd error = e.state.col(k).head(n) - run.truth.col(k);
    if (!error.allFinite()) return;
    if (!nees_states_.empty()) {
      const Eigen::MatrixXd P = e.covariance.col(k).reshaped(all, all)(nees_states_, nees_states_);
      const Eigen::VectorXd judged = error(nees_states_);
      sums.nees.add(judged.dot(solve_semidefinite(P, judged)), judged.size());
    }
    sums.squared_state_error += error.cwiseAbs2();
    ++sums.state_errors;
  }

  int mode_at(const RunEvaluation& e, Index k) const {
    if (e.viterbi_mode.size() > 0) return e.viterbi_mode(k);
    int likeliest = 0;
    e.mode_probability.col(k).maxCoeff(&likeliest);
    return std::isnan(e.state(0, k)) ? -1 : likeliest;
  }

  void add_visits(const RunEvaluation& e) {
    int before = -1;
    for (Index k = 0; k < e.log_density.size(); ++k) {
      const int mode = mode_at(e, k);
      if (mode >= 0 && (mode_ < 0 || mode == mode_)) {
        sums.visited += 1.0;
        sums.visits += mode != before ? 1.0 : 0.0;
      }
      before = mode;
    }
  }
};

/// Collects the samples of the runs of a role for one filter (mode -1) or one of its modes. A sample belongs to the
/// mode that was most probable before the measurement. `scores`: scores of all evaluations. `nees_states`: the states
/// of the NEES.
Collected collect(const Bank& bank, Index mode, Role role, bool chi_square_nis, const std::vector<Index>& nees_states,
                  const std::vector<Trajectory>& runs, const std::vector<RunEvaluation>& evaluations,
                  const std::vector<RunScores>& scores) {
  Collector collector(bank, mode, chi_square_nis, nees_states);
  for (std::size_t i = 0; i < runs.size(); ++i)
    if (runs[i].role == role) collector.add(runs[i], evaluations.at(i), scores.at(i));
  collector.correlate();
  return std::move(collector.sums);
}

constexpr double coloured = 0.01;          // whiteness p
constexpr double noticeable_colour = 0.1;  // autocorrelation

}  // namespace

bool errors_follow_a_pattern(const DiagnosticsRow& row) {
  return (row.whiteness_p < coloured && std::abs(row.autocorrelation) > noticeable_colour) ||
         row.reason == CalibrationReason::pattern;
}

namespace {

constexpr double negligible_R = 1e-6;  // limit of R as a share of the innovations' variance

/// Sets a fraction of hits and its confidence interval.
void set_fraction(const HitsByRun& hits, double time, double& fraction, double& lower, double& upper) {
  const SeriesByRun numbers = as_numbers(hits);
  fraction = mean_of(numbers);
  const Interval interval = fraction_interval(numbers, time);
  lower = interval.lower;
  upper = interval.upper;
}

void set_coverage(const HitsByRun& outside, double time, double& coverage, double& lower, double& upper) {
  set_fraction(outside, time, coverage, upper, lower);
  for (double* share : {&coverage, &lower, &upper}) *share = 1.0 - *share;
}

void set_fractions(const BandCounts& e, double time, DiagnosticsRow& row) {
  set_coverage(e.outside[0], time, row.coverage_50, row.coverage_50_lower, row.coverage_50_upper);
  set_coverage(e.outside[1], time, row.coverage_90, row.coverage_90_lower, row.coverage_90_upper);
  set_coverage(e.outside[2], time, row.coverage_95, row.coverage_95_lower, row.coverage_95_upper);
  set_coverage(e.outside[3], time, row.coverage_99, row.coverage_99_lower, row.coverage_99_upper);
  set_fraction(e.far, time, row.too_far, row.too_far_lower, row.too_far_upper);
  set_fraction(e.close, time, row.too_close, row.too_close_lower, row.too_close_upper);
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

DiagnosticsRow make_row(const Collected& c, Index nees_states) {
  DiagnosticsRow row;
  const double all = c.entropy_samples > 0 ? static_cast<double>(c.entropy_samples) : not_a_number;
  row.samples = c.samples;
  row.usage = c.usage / all;
  row.entropy = c.entropy / all;
  row.dwell = c.visits > 0.0 ? c.visited / c.visits : not_a_number;
  row.dwell_model = not_a_number;
  const double time = time_by_sizes(c.counts.sizes);
  set_fractions(c.counts, time, row);
  row.nis_mean = mean_distance(c.counts.nis, c.counts.nis_degrees);
  row.nees_mean = mean_distance(c.nees, static_cast<double>(nees_states));
  row.state_rmse =
      (c.squared_state_error / (c.state_errors > 0 ? static_cast<double>(c.state_errors) : not_a_number)).cwiseSqrt();
  row.whiteness_p = fisher_p(c.whiteness);
  const Verdict verdict = verdict_of(c.counts, time);
  row.verdict = verdict.calibration;
  row.reason = verdict.reason;
  return row;
}

constexpr double takes_all = 0.99;     // limit of a mode's usage; a mode above the limit is flagged
constexpr double unused = 1e-3;        // usage
constexpr double flat_entropy = 0.95;  // as a share of log K

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

std::vector<DiagnosticsRow> diagnose(const std::string& filter, Role role, const Bank& bank, bool chi_square_nis,
                                     const std::vector<Trajectory>& runs, const std::vector<RunEvaluation>& evaluations,
                                     const std::vector<RunScores>& scores) {
  if (std::none_of(runs.begin(), runs.end(), [role](const Trajectory& run) { return run.role == role; })) return {};
  const std::vector<Index> nees_states = states_with_noise(bank, role, runs, evaluations);
  Index failed = 0;
  const auto row_of = [&](Index mode) {
    const Collected collected = collect(bank, mode, role, chi_square_nis, nees_states, runs, evaluations, scores);
    DiagnosticsRow row = make_row(collected, std::ssize(nees_states));
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
