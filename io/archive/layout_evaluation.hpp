#pragma once

#include <algorithm>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "io/archive/archive.hpp"
#include "io/archive/bank/units.hpp"
#include "io/archive/groups/columns.hpp"
#include "io/archive/groups/over_runs.hpp"
#include "io/archive/stored.hpp"

/// Layout of evaluations by filters and models; see io/archive/layout.hpp. The letter T is the number of lags, which
/// count from 0.
namespace modebank::layout {

/// - left_out: scores on training runs; each filter was learned without the run that it predicts
/// - start: weight at the start of a run
template <class Io, class R>
void exchange_left_out(Io& io, R& rows, const Unit& states) {
  io.optional_table("left_out", rows, column("filter", &LeftOutRow::filter),
                    column("horizon", &LeftOutRow::horizon, "samples").obeying(rule::at_least_one),
                    column("samples", &LeftOutRow::samples), column("log_score", &LeftOutRow::log_score, "nat"),
                    column("rmse", &LeftOutRow::rmse, joined(states)), column("start", &LeftOutRow::start));
}

/// - prediction: one step ahead, all modes combined
/// - innovation: measurement minus prediction
/// - innovation_covariance: covariance of the combined prediction
/// - state: estimate after the measurement
/// - covariance: covariance of `state`
/// - nis: normalised innovation squared
/// - pit: probability integral transform, uniform where the filter is consistent
/// - log_density: log density of the measurement
/// - mode_probability_predicted: probabilities before the measurement
/// - mode_probability: probabilities after the measurement
/// - viterbi_mode: the mode in the most probable sequence of modes; -1: before the filter's start
template <class Io, class E>
void exchange_run_evaluation(Io& io, E& evaluation, const Unit& states) {
  io.field("prediction", evaluation.prediction, {"S", "n_y"}, states);
  io.field("innovation", evaluation.innovation, {"S", "n_y"}, states);
  io.field("innovation_covariance", evaluation.innovation_covariance, {"S", "n_y", "n_y"}, outer(states));
  io.field("state", evaluation.state, {"S", "n_y"}, states);
  io.field("covariance", evaluation.covariance, {"S", "n_y", "n_y"}, outer(states));
  io.field("nis", evaluation.nis, {"S"});
  io.field("pit", evaluation.pit, {"S", "n_y"});
  io.field("log_density", evaluation.log_density, {"S"}, {"nat"});
  io.field("mode_probability_predicted", evaluation.mode_probability_predicted, {"S", "K"});
  io.field("mode_probability", evaluation.mode_probability, {"S", "K"});
  io.optional_field("viterbi_mode", evaluation.viterbi_mode, {"S"}, {}, rule::position_or_none("K"));
}

/// - free_run_mean: prediction without measurements after the run's start, with `filter.simulate`
/// - free_run_sd: standard deviation of this prediction
/// - free_run_lower: lower end of the 95 % band
/// - free_run_upper: upper end of the 95 % band
/// - free_run_mode: most probable mode
template <class Io, class F>
void exchange_free_run(Io& io, F& run, const Unit& states) {
  io.optional_field("free_run_mean", run.mean, {"S", "n_y"}, states);
  io.optional_field("free_run_sd", run.deviation, {"S", "n_y"}, states);
  io.optional_field("free_run_lower", run.lower, {"S", "n_y"}, states);
  io.optional_field("free_run_upper", run.upper, {"S", "n_y"}, states);
  io.optional_field("free_run_mode", run.mode, {"S"}, {}, rule::position_or_none("K"));
  if constexpr (Io::reads)
    io.finish([&] {
      check_together("free_run_mean, free_run_sd, free_run_lower and free_run_upper",
                     {run.mean.rows(), run.deviation.rows(), run.lower.rows(), run.upper.rows()});
    });
}

/// One filter's evaluation of one run, or of all runs if whole arrays are checked.
template <class Io, class E, class F>
void exchange_filter_run(Io& samples, E& evaluation, F& free_run, const Unit& states) {
  exchange_run_evaluation(samples, evaluation, states);
  exchange_free_run(samples, free_run, states);
}

/// One filter's evaluation of every run of the recording.
/// /evaluation/FILTER: one group for each filter: `bank`, `baseline`, `noise_only`, `one_motion`, `drifting`,
///   `nonlinear`, `combined`. Scores of the first sample of a run are NaN. States and covariances are those of the
///   sample itself. If a bank has lags, the earlier samples of its state are in earlier rows.
template <class Io, class F>
void exchange_filter(Io& io, F& evaluation, const Recording& recording, const Unit& states) {
  const std::vector<hdf5::Rows> rows = rows_of(recording.runs);
  std::conditional_t<Io::reads, FreeRun, const FreeRun> none{};  // absent if empty
  if constexpr (Io::reads) {
    evaluation.runs.resize(rows.size());
    if (io.has("free_run_mean")) evaluation.free_runs.resize(rows.size());
    if (io.leaves_evaluations()) return;
    if (io.verifies()) {
      RunEvaluation all;
      io.set_size("S", rows.empty() ? 0 : rows.back().end());
      return exchange_filter_run(io, all, none, states);
    }
  }
  if (evaluation.runs.size() != rows.size())
    throw std::invalid_argument("filter " + evaluation.filter + " has evaluated " +
                                std::to_string(evaluation.runs.size()) + " runs of " + std::to_string(rows.size()));
  over_runs(io, rows, [&](auto& samples, std::size_t i) {
    exchange_filter_run(samples, evaluation.runs[i], evaluation.free_runs.empty() ? none : evaluation.free_runs[i],
                        states);
  });
}

/// - summary: scores by filter and run
/// - run: `*`: all runs of the role
/// - samples: number of scored samples
/// - log_score: mean log score per sample
/// - nis_above: share of samples whose NIS is above the 97.5 % quantile of chi-square
/// - nis_below: share of samples whose NIS is below the 2.5 % quantile
/// - coverage_95: share of samples inside the 95 % band
/// - too_far: share of samples whose z^2 is above the 97.5 % quantile of z^2
/// - too_close: share of samples whose z^2 is below the 2.5 % quantile of z^2
/// - pit_distance: Kolmogorov distance of `pit` from the uniform distribution
/// - whiteness_p: p-value of the Ljung-Box test on the standardised innovations
template <class Io, class S>
void exchange_summary(Io& io, S& summary, const Unit& states) {
  io.optional_table("summary", summary, column("filter", &SummaryRow::filter), column("role", &SummaryRow::role),
                    column("run", &SummaryRow::run), column("samples", &SummaryRow::samples),
                    column("log_score", &SummaryRow::log_score, "nat"),
                    column("rmse", &SummaryRow::rmse, joined(states)), column("nis_mean", &SummaryRow::nis_mean),
                    column("nis_above", &SummaryRow::nis_above), column("nis_below", &SummaryRow::nis_below),
                    column("coverage_50", &SummaryRow::coverage_50), column("coverage_90", &SummaryRow::coverage_90),
                    column("coverage_95", &SummaryRow::coverage_95), column("coverage_99", &SummaryRow::coverage_99),
                    column("too_far", &SummaryRow::too_far), column("too_close", &SummaryRow::too_close),
                    column("pit_distance", &SummaryRow::pit_distance), column("whiteness_p", &SummaryRow::whiteness_p));
}

/// - horizon: scores of predictions this number of samples ahead, with `filter.horizon`
/// - run: `*`: all runs of the role
/// - coverage_95: share of the signals inside the central 95 % band, each by itself
template <class Io, class R>
void exchange_horizon(Io& io, R& rows, const Unit& states) {
  io.optional_table("horizon", rows, column("filter", &HorizonRow::filter), column("role", &HorizonRow::role),
                    column("run", &HorizonRow::run),
                    column("horizon", &HorizonRow::horizon, "samples").obeying(rule::at_least_one),
                    column("samples", &HorizonRow::samples), column("log_score", &HorizonRow::log_score, "nat"),
                    column("rmse", &HorizonRow::rmse, joined(states)), column("coverage_95", &HorizonRow::coverage_95));
}

/// - combination: weights of the filters in the combined forecasts
/// - weight: mean weight over the role's runs
/// - start: weight at the start of a run
template <class Io, class R>
void exchange_combination(Io& io, R& rows) {
  io.optional_table("combination", rows, column("role", &CombinationRow::role),
                    column("horizon", &CombinationRow::horizon, "samples"), column("filter", &CombinationRow::filter),
                    column("weight", &CombinationRow::weight), column("start", &CombinationRow::start));
}

/// - free_run: scores of free runs, with `filter.simulate`
/// - start: number of measured samples at the start of a run
/// - run: `*`: all runs of the role
template <class Io, class R>
void exchange_free_runs(Io& io, R& rows, const Unit& states) {
  using Row = FreeRunRow;
  io.optional_table("free_run", rows, column("filter", &Row::filter), column("role", &Row::role),
                    column("run", &Row::run), column("start", &Row::start, "samples"), column("samples", &Row::samples),
                    column("log_score", &Row::log_score, "nat"), column("rmse", &Row::rmse, joined(states)),
                    column("nrmse", &Row::nrmse), column("fit", &Row::fit, "%"),
                    column("coverage_50", &Row::coverage_50), column("coverage_90", &Row::coverage_90),
                    column("coverage_95", &Row::coverage_95), column("coverage_99", &Row::coverage_99),
                    column("lost_paths", &Row::lost_paths));
}

/// - diagnostics: consistency of each filter and mode, with intervals
/// - mode: -1: all modes
/// - dwell: mean length of a visit, by `viterbi_mode` or the most probable mode
/// - dwell_model: mean length of a visit that the transition matrix gives
/// - reason: the number that decided the verdict: `band`, `close`, `NIS`, `pattern`, `few samples`; `none`: all pass
/// - autocorrelation: largest autocorrelation of the standardised innovations
/// - autocorrelation_lag: lag of the largest autocorrelation
template <class Io, class R>
void exchange_diagnostics(Io& io, R& rows, const Unit& states) {
  using Row = DiagnosticsRow;
  io.optional_table(
      "diagnostics", rows, column("filter", &Row::filter), column("role", &Row::role),
      column("mode", &Row::mode).obeying(rule::position_or_none("K")), column("samples", &Row::samples),
      column("usage", &Row::usage), column("entropy", &Row::entropy), column("dwell", &Row::dwell, "samples"),
      column("dwell_model", &Row::dwell_model, "samples"), column("coverage_50", &Row::coverage_50),
      column("coverage_50_lower", &Row::coverage_50_lower), column("coverage_50_upper", &Row::coverage_50_upper),
      column("coverage_90", &Row::coverage_90), column("coverage_90_lower", &Row::coverage_90_lower),
      column("coverage_90_upper", &Row::coverage_90_upper), column("coverage_95", &Row::coverage_95),
      column("coverage_95_lower", &Row::coverage_95_lower), column("coverage_95_upper", &Row::coverage_95_upper),
      column("coverage_99", &Row::coverage_99), column("coverage_99_lower", &Row::coverage_99_lower),
      column("coverage_99_upper", &Row::coverage_99_upper), column("too_far", &Row::too_far),
      column("too_far_lower", &Row::too_far_lower), column("too_far_upper", &Row::too_far_upper),
      column("too_close", &Row::too_close), column("too_close_lower", &Row::too_close_lower),
      column("too_close_upper", &Row::too_close_upper), column("nis_mean", &Row::nis_mean),
      column("nees_mean", &Row::nees_mean), column("state_rmse", &Row::state_rmse, joined(states)),
      column("whiteness_p", &Row::whiteness_p), column("verdict", &Row::verdict), column("reason", &Row::reason),
      column("flags", &Row::flags), column("autocorrelation", &Row::autocorrelation),
      column("autocorrelation_lag", &Row::autocorrelation_lag));
}

/// /evaluation/evidence: whether held-out runs show evidence for modes.
/// - answer: `evidence`, `cannot tell`, `no evidence`, `one mode`, `not yet`, `not comparable`
/// - without_noise: 1: the errors of one linear model are only rounding errors
/// - gain: gain of the bank over `best_competitor` [nat] per sample
/// - description: `several modes`, `one linear motion`, `one drifting motion`, `one nonlinear motion`, `none`
/// - stay: harmonic mean length of a visit to a motion [samples]
/// - stay_asked: shortest mean visit that counts as a motion [samples]
/// - terms_asked: 1: terms of one nonlinear motion were compared
/// - pattern_gain: gain of predicting the bank's errors from past errors and inputs [nat] per sample on training
///   runs; NaN: not computed
/// - text: the finding as a sentence
/// - equations: equations of one nonlinear motion, line by line
/// - gains: gains of the bank over each competitor
/// - better_means: competitors with smaller mean errors than the bank
template <class Io, class F>
void exchange_finding(Io& io, F& finding) {
  io.attribute("answer", finding.answer);
  io.attribute("role", finding.role);
  io.attribute("runs", finding.runs);
  io.attribute("modes", finding.modes);
  io.attribute_unless(false, "without_noise", finding.without_noise);
  io.attribute("best_competitor", finding.best_competitor);
  io.attribute("gain", finding.gain);
  io.attribute("standard_error", finding.standard_error);
  io.attribute("description", finding.description);
  io.attribute("stay", finding.stay);
  io.attribute("stay_asked", finding.stay_asked);
  io.attribute_unless(false, "terms_asked", finding.terms_asked);
  io.attribute("pattern_gain", finding.pattern.gain);
  io.attribute("pattern_standard_error", finding.pattern.standard_error);
  io.attribute("better_description", finding.better_description);
  io.attribute("text", finding.text);
  io.optional_attribute_texts("equations", finding.equations);
  io.optional_table(
      "gains", finding.gains, column("competitor", &PairedGain::competitor), column("samples", &PairedGain::samples),
      column("gain", &PairedGain::gain, "nat"), column("standard_error", &PairedGain::standard_error, "nat"),
      column("degrees_of_freedom", &PairedGain::degrees_of_freedom), column("margin", &PairedGain::margin, "nat"),
      column("by_blocks", &PairedGain::by_blocks), column("rank_p", &PairedGain::rank_p));
  io.optional_table("better_means", finding.better_means, column("competitor", &BetterMean::competitor),
                    column("horizon", &BetterMean::horizon, "samples"), column("state", &BetterMean::state),
                    column("rmse_bank", &BetterMean::rmse_bank), column("rmse", &BetterMean::rmse));
}

/// - confusion: labels against modes, with `data.label`
/// - samples: number of samples that have this label and this most probable mode
/// - share: `samples` as a share of all samples with this label
template <class Io, class R>
void exchange_confusion(Io& io, R& rows) {
  using Row = ConfusionRow;
  io.optional_table("confusion", rows, column("filter", &Row::filter), column("role", &Row::role),
                    column("label", &Row::label), column("mode", &Row::mode).obeying(rule::position("K")),
                    column("samples", &Row::samples), column("share", &Row::share));
}

template <class Io, class A>
void exchange_evaluation(Io& io, A& archive, const Recording& recording, const Units& units) {
  const auto names = [](const std::vector<FilterEvaluation>& list) {
    std::vector<std::string> filters;
    for (const FilterEvaluation& evaluation : list) filters.push_back(evaluation.filter);
    return filters;
  };
  const auto named = [](const std::vector<std::string>& filters) {
    check_different("filters", filters);
    std::vector<FilterEvaluation> list;
    for (const std::string& filter : filters) list.push_back({filter, {}});
    return list;
  };
  io.through(archive.evaluations, names, named, [&](auto& filters) { io.attribute_texts("filters", filters); });
  for (auto& evaluation : archive.evaluations)
    if (!evaluation.streamed)
      io.group(evaluation.filter, sizes_of_filter(archive, evaluation.filter),
               [&](auto& member) { exchange_filter(member, evaluation, recording, units.states()); });
  exchange_summary(io, archive.summary, units.states());
  exchange_horizon(io, archive.horizons, units.states());
  exchange_combination(io, archive.combination);
  exchange_free_runs(io, archive.free_runs, units.states());
  exchange_diagnostics(io, archive.diagnostics, units.states());
  exchange_confusion(io, archive.confusion);
  exchange_part(io, "evidence", archive.finding, {}, [](auto& member, auto& part) { exchange_finding(member, part); });
  if constexpr (Io::reads) {
    io.finish([&] { check_modes(archive); });
    io.judge([&] { check_score_names(archive); });
  }
}

/// /residual_tests: tables of all models and runs. Lags are below the number T of their run.
/// - runs: tests of each model's residuals, by run
/// - model: `global`, `bank` or a competitor
/// - lags: one row for each lag; in `runs`: the number T of lags
/// - ljung_box_p: one p-value for each state
/// - cross_correlation_band: one band for each state and input
/// - lag: 0, 1, ... T - 1
template <class Io, class S>
void exchange_residual_tests(Io& io, S& sets, const Recording& recording) {
  using Run = ResidualRunRow;
  using Lag = ResidualLagRow;
  const std::vector<Trajectory>& runs = recording.runs;
  RestoredResiduals restored(recording);
  const auto take = [&](const auto& row) { restored.take(row); };
  io.table_rows(
      "runs", [&](const auto& append) { store_residual_runs(sets, runs, append); }, take, column("model", &Run::model),
      column("run", &Run::run), column("samples", &Run::samples), column("level", &Run::level),
      column("autocorrelation_band", &Run::autocorrelation_band), column("lags", &Run::lags),
      column("ljung_box_p", &Run::ljung_box_p), column("cross_correlation_band", &Run::cross_correlation_band));
  io.table_rows(
      "lags", [&](const auto& append) { store_residual_lags(sets, runs, append); }, take, column("model", &Lag::model),
      column("run", &Lag::run), column("lag", &Lag::lag, "samples"), column("autocorrelation", &Lag::autocorrelation),
      column("cross_correlation", &Lag::cross_correlation));
  if constexpr (Io::reads) io.finish([&] { sets = restored.sets(); });
}

}  // namespace modebank::layout
