#pragma once

#include <string>

#include "ident/model/parameter_labels.hpp"
#include "io/archive/archive.hpp"
#include "io/archive/bank/layout_bank.hpp"
#include "io/archive/bank/layout_drifting.hpp"
#include "io/archive/layout_data.hpp"
#include "io/archive/layout_evaluation.hpp"
#include "io/archive/stored.hpp"

/// The only description of the archive's layout. Other parts of it are in layout_data.hpp, layout_evaluation.hpp and,
/// for programs that only load banks, in bank/layout_bank.hpp.
///
/// Every function names members once. `Io` is GroupWriter or GroupReader; for arrays over samples it is SampleWriter or
/// SampleReader. Writing, reading and verification therefore agree. Above a function, `/// - NAME: text` describes a
/// member or a column, and `/// /PATH: text` describes its group. docs/_ext/archive_layout.py makes the reference page
/// from these comments.
///
/// Letters: M windows, K modes, n states, m inputs, n_y outputs, p parameters, S samples of all runs, F features.
namespace modebank::layout {

/// /windows/global: one model of all training runs.
/// - residual_covariance: covariance of the model's residuals
template <class Io, class G>
void exchange_global(Io& io, G& global, const Unit& parameters, const Unit& states) {
  io.attribute("transitions", global.transitions);
  io.field("parameters", global.theta, {"p"}, parameters);
  io.field("covariance", global.covariance, {"p", "p"}, outer(parameters));
  io.field("residual_covariance", global.residual_covariance, {"n", "n"}, outer(states));
  const Eigen::VectorXd noise_variance = Io::reads ? Eigen::VectorXd() : global.noise_variance();
  io.derived_field("noise_variance", noise_variance, {"n"}, squared(states));
}

inline Unit window_units(const WindowFits& fits, const Units& units) {
  return fits.model_parameters.empty() ? parameter_units(fits.structure, units.states(), units.inputs())
                                       : unit_of(fits.model_parameters);
}

/// /windows: one local model for each window.
/// - length: transitions of a window
/// - step: transitions from one window to the next
/// - run: name of the run
/// - start: row of the window's first sample, within its run
/// - parameters: parameters theta of each window
/// - covariance: covariance of theta
/// - noise_variance: variance of the residuals
/// - condition: condition number of the regressors
/// - information: information of each parameter
/// - inlier_fraction: share of transitions that the loss does not down-weight
/// - status: 0: converged, 1: iteration limit, 2: rank deficient, 3: failed
/// - transitions: number of transitions in the fit
/// - weighed_information: information of the data, which weighed theta against the prior. The prior's share of
///   theta can be removed with it.
/// - prior_sd: standard deviations of the prior
/// - parameter_labels: output and regressor of each parameter, `wz <- velL`
template <class Io, class W>
void exchange_windows(Io& io, W& fits, const Recording& recording, const Units& units) {
  const std::vector<Trajectory>& runs = recording.runs;
  const Unit parameters = window_units(fits, units);
  exchange_model_parameters(io, fits.model_parameters, "model_parameter");
  exchange_structure(io, fits.structure, fits.model);
  io.attribute("length", fits.length, rule::at_least_one);
  io.attribute("step", fits.step, rule::at_least_one);
  io.attribute("loss", fits.loss);
  io.through(
      fits.windows, [&](const auto& windows) { return store_windows(windows, runs); },
      [&](const StoredWindows& stored) { return restore_windows(stored, runs, fits.length); },
      [&](auto& stored) {
        io.texts("run", stored.run, {"M"});
        io.field("start", stored.start, {"M"}, {}, rule::not_negative);
      });
  io.field("parameters", fits.parameters, {"M", "p"}, parameters);
  io.field("covariance", fits.covariance, {"M", "p", "p"}, outer(parameters));
  io.field("noise_variance", fits.noise_variance, {"M", "n"}, squared(units.states()));
  io.field("condition", fits.condition, {"M"});
  io.field("rank", fits.rank, {"M"});
  io.field("information", fits.information, {"M", "p"});
  io.field("inlier_fraction", fits.inlier_fraction, {"M"});
  io.field("status", fits.status, {"M"}, {}, rule::between(0, static_cast<int>(FitStatus::failed)));
  io.optional_field("r_squared", fits.r_squared, {"M", "n"});
  io.optional_field("transitions", fits.transitions, {"M"}, {}, rule::between(0.0, static_cast<double>(fits.length)));
  io.optional_field("weighed_information", fits.weighed_information, {"M", "n"});
  io.optional_derived_field(
      "standard_error", [&] { return fits.standard_errors(); }, {"M", "p"}, parameters);
  io.optional_derived_field("t_value", [&] { return fits.t_values(); }, {"M", "p"});
  io.optional_field("prior_sd", fits.prior_sd, {"p"}, parameters);
  if constexpr (Io::reads) io.finish([&] { restore_window_structure(fits, io.size("n"), io.size("p")); });
  std::vector<std::string> names = fits.parameter_names();
  io.attribute_texts("parameter_names", names);
  if constexpr (!Io::reads)
    io.attribute_texts("parameter_labels",
                       parameter_labels(fits, names_of(recording.states), names_of(recording.inputs)));
  io.group("global", io.known({"n", "p"}),
           [&](auto& member) { exchange_global(member, fits.global, parameters, units.states()); });
}

/// - candidates: one row for each number of components that was compared
/// - parameters: free parameters
/// - effective_samples: number of independent samples that contain as much information as the windows
/// - agreeing_restarts: random starts that reached the best likelihood
/// - floor_active: 1: the covariance of a component is at the covariance floor
/// - failed: reason of a failure
/// - selected: 1: the mixture has this row's components
template <class Io, class C>
void exchange_candidates(Io& io, C& candidates) {
  io.table("candidates", candidates, column("components", &Candidate::components).obeying(rule::at_least_one),
           column("covariance", &Candidate::covariance), column("log_likelihood", &Candidate::log_likelihood, "nat"),
           column("parameters", &Candidate::parameters), column("effective_samples", &Candidate::effective_samples),
           column("bic", &Candidate::bic), column("aic", &Candidate::aic), column("iterations", &Candidate::iterations),
           column("converged", &Candidate::converged), column("agreeing_restarts", &Candidate::agreeing_restarts),
           column("selected", &Candidate::selected), column("bic_naive", &Candidate::bic_naive),
           column("restarts", &Candidate::restarts), column("floor_active", &Candidate::floor_active),
           column("status", &Candidate::status), column("failed", &Candidate::failed));
}

/// `features`: units of the features.
/// - labels: component of each window; -1: not clustered, or noise
/// - weights: weights of the components; their sum is 1, or 1 - `noise_weight`
/// - features: the clustered features, if these are not `/windows/parameters`; NaN for a window without features
/// - compared_windows: number of windows for the comparison of candidates, if not all windows were used
/// - responsibilities: NaN: not clustered. The sum of a row is 1, or 1 minus the probability of noise.
/// - noise_weight: weight of the noise component
/// - noise_lower: lower corner of the noise component's box
/// - noise_upper: upper corner of the noise component's box
template <class Io, class X>
void exchange_mixture(Io& io, X& result, const Unit& features) {
  exchange_candidates(io, result.candidates);
  io.attribute_texts("feature_names", result.feature_names);
  io.attribute("covariance", result.mixture.type);
  io.field("weights", result.mixture.weights, {"K"}, {}, rule::share);
  io.field("means", result.mixture.means, {"K", "F"}, features, rule::finite);
  io.through(
      result.mixture.covariances, store_covariances,
      [&](const Eigen::MatrixXd& stored) { return restore_covariances(stored, result.mixture.features()); },
      [&](auto& stored) {
        io.field("covariances", stored, {"K", "F", "F"}, outer(features), rule::covariances);
      });
  io.attribute("clustered_windows", result.clustered);
  io.attribute_unless(Index{0}, "compared_windows", result.compared);
  io.optional_field("features", result.features, {"M", "F"}, features);
  io.attribute("noise_weight", result.mixture.noise.weight, rule::share);
  io.optional_field("noise_lower", result.mixture.noise.lower, {"F"}, features, rule::finite);
  io.optional_field("noise_upper", result.mixture.noise.upper, {"F"}, features, rule::finite);
  io.field("labels", result.labels, {"M"}, {}, rule::position_or_none("K"));
  io.through_rows("responsibilities", result.responsibilities, {"M", "K"});
  if constexpr (Io::reads) io.finish([&] { check_mixture(result); });
}

/// /mixture: clusters of window parameters.
/// /bank: the modes.
/// /baseline: one Kalman filter.
/// /noise_only: one model with switching noise.
/// /one_motion: one motion, learned in the same way as the bank.
/// /nonlinear: one motion with nonlinear terms, if these terms predict the training runs better.
/// /bank/unrefined: the bank from which refinement started.
/// /residual_tests: correlations of the residuals, and of residuals with inputs.
/// - measured_fit: result of the stage with measurement noise: `none`, `converged`, `iteration_limit` or `stalled`
/// - learned_transitions: number of training transitions for learning, if not all were used
/// - mode_names: names of the modes; empty for a mode without a name
template <class Io, class A>
void exchange_archive(Io& io, A& archive) {
  exchange_origin(io, archive);
  exchange_part(io, "data", archive.recording, {}, [&](auto& member, auto& part) {
    exchange_recording(member, part, archive.labels, archive.step_scatter);
  });
  exchange_part(io, "lag", archive.lag, {}, [](auto& member, auto& part) { exchange_lag(member, part); });
  const Recording none;
  const Recording& recording = archive.recording ? *archive.recording : none;
  exchange_part(io, "structure", archive.structure, {},
                [&](auto& member, auto& part) { exchange_found_structure(member, part, recording.input_count()); });
  const Units units(recording);
  Sizes channels;
  if (archive.recording) channels.set("n", recording.states.size());
  exchange_part(io, "windows", archive.windows, channels,
                [&](auto& member, auto& part) { exchange_windows(member, part, recording, units); });
  Sizes known;
  Unit features;
  if (archive.windows) {
    if (archive.windows->count() > 0) known.set("M", static_cast<hsize_t>(archive.windows->count()));
    if (archive.mixture) features = feature_units(archive.mixture->feature_names, *archive.windows, units);
  }
  exchange_part(io, "mixture", archive.mixture, known,
                [&](auto& member, auto& part) { exchange_mixture(member, part, features); });
  const auto exchange_one = [&](auto& member, auto& part) { exchange_bank(member, part, units); };
  exchange_part(io, "bank", archive.bank, {}, [&](auto& member, auto& part) {
    exchange_one(member, part);
    member.attribute("measured_fit", archive.measured_fit);
    member.attribute_unless(Index{0}, "learned_transitions", archive.learned_transitions, rule::not_negative);
    member.optional_attribute_texts("mode_names", archive.mode_names);
    if constexpr (Io::reads) member.finish([&] { check_count("mode_names", archive.mode_names, part.mode_count()); });
    exchange_part(member, "unrefined", archive.unrefined, {}, exchange_one);
    exchange_left_out(member, archive.left_out, units.states());
  });
  exchange_part(io, "baseline", archive.baseline, {}, exchange_one);
  exchange_part(io, "noise_only", archive.noise_only, {}, exchange_one);
  exchange_part(io, "one_motion", archive.one_motion, {}, exchange_one);
  exchange_part(io, "drifting", archive.drifting, {},
                [&](auto& member, auto& part) { exchange_drifting(member, part, units); });
  exchange_part(io, "nonlinear", archive.nonlinear, {}, exchange_one);
  io.optional_group("residual_tests", !archive.residual_tests.empty(), {},
                    [&](auto& member) { exchange_residual_tests(member, archive.residual_tests, recording); });
  io.optional_group("evaluation", !archive.evaluations.empty() || !archive.summary.empty(),
                    sizes_of_evaluation(archive, recording),
                    [&](auto& member) { exchange_evaluation(member, archive, recording, units); });
}

}  // namespace modebank::layout
