#pragma once

#include <stdexcept>
#include <string>
#include <vector>

#include "io/archive.hpp"
#include "io/archive_sizes.hpp"
#include "io/archive_stored.hpp"
#include "io/archive_units.hpp"
#include "io/table_columns.hpp"

/// The layout of banks and evaluations; see archive_layout.hpp.
namespace modebank::layout {

/// What kind of model it is. Reading leaves the number of states to restore_structure, which knows it from the arrays.
template <class Io, class S, class Name>
void exchange_structure(Io& io, S& structure, Name& model) {
  io.attribute("model", model);
  io.constant_attribute("form", std::string("increment"));
  io.attribute("intercept", structure.intercept);
  io.attribute("inputs", structure.inputs);
  io.attribute("state_lags", structure.state_lags);
  io.attribute("input_lags", structure.input_lags);
  io.attribute("input_delay", structure.input_delay);
}

/// Names and units of a motion model's parameters; empty lists for linear models.
template <class Io, class P>
void exchange_model_parameters(Io& io, P& parameters, const std::string& kind) {
  io.through(parameters, store_model_parameters, restore_model_parameters, [&](auto& stored) {
    io.attribute_texts(kind + "_names", stored.names);
    io.attribute_texts(kind + "_units", stored.units);
  });
}

/// The filter measures the recorded states, so outputs have the states' units where there are as many.
template <class Io, class S>
void exchange_modes(Io& io, S& stored, const Unit& states, const Unit& inputs, const Unit& motion) {
  const Unit parameters = parameter_units(stored.structure, states, inputs);
  const bool measured = static_cast<std::size_t>(stored.C.cols()) == states.size();
  const Unit outputs(states.begin(), states.begin() + (measured ? stored.C.rows() : 0));
  io.field("weight", stored.weight, {"K"});
  io.field("c", stored.c, {"K", "n"}, states);
  io.field("A", stored.A, {"K", "n", "n"}, ratios(states, states));
  io.field("B", stored.B, {"K", "n", "m"}, ratios(states, inputs));
  io.field("Q", stored.Q, {"K", "n", "n"}, outer(states));
  io.field("parameters", stored.parameters, {"K", "p"}, parameters);
  io.optional_field("parameter_covariance", stored.spread, {"K", "p", "p"}, outer(parameters));
  io.optional_field("parameter_standard_error", stored.standard_error, {"K", "p"}, parameters);
  io.optional_field("Q_standard_error", stored.Q_standard_error, {"K", "n", "n"}, outer(states));
  io.optional_field("R_standard_error", stored.R_standard_error, {"n_y", "n_y"}, measured ? outer(outputs) : Unit());
  io.optional_field("transition_standard_error", stored.transition_standard_error, {"K", "K"});
  io.field("C", stored.C, {"n_y", "n"}, measured ? ratios(outputs, states) : Unit());
  io.field("R", stored.R, {"n_y", "n_y"}, measured ? outer(outputs) : Unit());
  io.field("transition", stored.transition, {"K", "K"});
  io.field("initial_probability", stored.initial_probability, {"K"});
  io.optional_field("motion_parameters", stored.motion_parameters, {"K", "p_motion"}, motion);
  io.optional_field("motion_standard_error", stored.motion_standard_error, {"K", "p_motion"}, motion);
  exchange_structure(io, stored.structure, stored.model);
  if constexpr (Io::reads)
    io.finish([&] { stored.structure = restore_structure(stored.structure, io.size("n"), io.size("p")); });
}

/// Names, period and screened modes, then everything that StoredBank holds.
template <class Io, class B>
void exchange_bank(Io& io, B& bank, const Units& units) {
  io.attribute_texts("state_names", bank.state_names);
  io.attribute_texts("input_names", bank.input_names);
  io.attribute("dt_s", bank.dt_s);
  io.optional_attribute("noise_forgetting", bank.noise_adaptation.forgetting);
  io.optional_attribute("noise_prior_samples", bank.noise_adaptation.prior_samples);
  exchange_model_parameters(io, bank.motion_parameters, "motion_parameter");
  io.table("screened", bank.screened, column("component", &ScreenedMode::component),
           column("weight", &ScreenedMode::weight), column("spectral_radius", &ScreenedMode::spectral_radius),
           column("reason", &ScreenedMode::reason));
  const Unit states = units.states(bank.state_names), inputs = units.inputs(bank.input_names);
  io.through(
      bank, store_bank, [&](const StoredBank& stored) { return restore_bank(stored, bank); },
      [&](auto& stored) { exchange_modes(io, stored, states, inputs, unit_of(bank.motion_parameters)); });
}

template <class Io, class R>
void exchange_merging(Io& io, R& rows) {
  io.optional_table("merged", rows, column("role", &MergingCost::role), column("components", &MergingCost::components),
                    column("modes_unlimited", &MergingCost::modes_unlimited), column("modes", &MergingCost::modes),
                    column("samples", &MergingCost::samples),
                    column("log_score_unlimited", &MergingCost::log_score_unlimited, "nat"),
                    column("log_score", &MergingCost::log_score, "nat"), column("loss", &MergingCost::loss, "nat"));
}

template <class Io, class E>
void exchange_run_evaluation(Io& io, E& evaluation, const Unit& states) {
  io.field("prediction", evaluation.prediction, {"N", "n"}, states);
  io.field("innovation", evaluation.innovation, {"N", "n_y"}, states);
  io.field("innovation_covariance", evaluation.innovation_covariance, {"N", "n_y", "n_y"}, outer(states));
  io.field("state", evaluation.state, {"N", "n"}, states);
  io.field("covariance", evaluation.covariance, {"N", "n", "n"}, outer(states));
  io.field("nis", evaluation.nis, {"N"});
  io.field("pit", evaluation.pit, {"N", "n_y"});
  io.field("log_density", evaluation.log_density, {"N"}, {"nat"});
  io.field("mode_probability_predicted", evaluation.mode_probability_predicted, {"N", "K"});
  io.field("mode_probability", evaluation.mode_probability, {"N", "K"});
  io.optional_field("spread_share", evaluation.spread_share, {"N"});
  io.optional_field("smoothed_state", evaluation.smoothed_state, {"N", "n"}, states);
  io.optional_field("smoothed_covariance", evaluation.smoothed_covariance, {"N", "n", "n"}, outer(states));
  io.optional_field("viterbi_mode", evaluation.viterbi_mode, {"N"});
}

/// One filter's evaluation of every run of the recording.
template <class Io, class F>
void exchange_filter(Io& io, F& evaluation, const Recording& recording, const Unit& states) {
  if constexpr (Io::reads) evaluation.runs.resize(recording.runs.size());
  if (evaluation.runs.size() != recording.runs.size())
    throw std::invalid_argument("filter " + evaluation.filter + " has evaluated " +
                                std::to_string(evaluation.runs.size()) + " runs of " +
                                std::to_string(recording.runs.size()));
  for (std::size_t i = 0; i < recording.runs.size(); ++i) {
    Sizes known;
    if (recording.runs[i].samples() > 0) known.set("N", static_cast<hsize_t>(recording.runs[i].samples()));
    io.group(recording.runs[i].run, known,
             [&](auto& member) { exchange_run_evaluation(member, evaluation.runs[i], states); });
  }
}

template <class Io, class S>
void exchange_summary(Io& io, S& summary, const Unit& states) {
  io.optional_table("summary", summary, column("filter", &SummaryRow::filter), column("role", &SummaryRow::role),
                    column("run", &SummaryRow::run), column("samples", &SummaryRow::samples),
                    column("log_score", &SummaryRow::log_score, "nat"),
                    column("rmse", &SummaryRow::rmse, joined(states)), column("nis_mean", &SummaryRow::nis_mean),
                    column("nis_above", &SummaryRow::nis_above), column("nis_below", &SummaryRow::nis_below),
                    column("tail_above", &SummaryRow::tail_above), column("tail_below", &SummaryRow::tail_below),
                    column("pit_distance", &SummaryRow::pit_distance), column("whiteness_p", &SummaryRow::whiteness_p));
}

template <class Io, class R>
void exchange_horizon(Io& io, R& rows, const Unit& states) {
  io.optional_table("horizon", rows, column("filter", &HorizonRow::filter), column("role", &HorizonRow::role),
                    column("run", &HorizonRow::run), column("horizon", &HorizonRow::horizon, "samples"),
                    column("samples", &HorizonRow::samples), column("log_score", &HorizonRow::log_score, "nat"),
                    column("rmse", &HorizonRow::rmse, joined(states)));
}

template <class Io, class R>
void exchange_diagnostics(Io& io, R& rows, const Unit& states) {
  using Row = DiagnosticsRow;
  io.optional_table(
      "diagnostics", rows, column("filter", &Row::filter), column("role", &Row::role), column("mode", &Row::mode),
      column("samples", &Row::samples), column("usage", &Row::usage), column("entropy", &Row::entropy),
      column("dwell", &Row::dwell, "samples"), column("dwell_model", &Row::dwell_model, "samples"),
      column("tail_above", &Row::tail_above), column("tail_above_lower", &Row::tail_above_lower),
      column("tail_above_upper", &Row::tail_above_upper), column("tail_below", &Row::tail_below),
      column("tail_below_lower", &Row::tail_below_lower), column("tail_below_upper", &Row::tail_below_upper),
      column("nis_mean", &Row::nis_mean), column("nis_lower", &Row::nis_lower), column("nis_upper", &Row::nis_upper),
      column("nees_mean", &Row::nees_mean), column("nees_lower", &Row::nees_lower),
      column("nees_upper", &Row::nees_upper), column("state_rmse", &Row::state_rmse, joined(states)),
      column("whiteness_p", &Row::whiteness_p), column("spread_share", &Row::spread_share),
      column("verdict", &Row::verdict), column("flags", &Row::flags));
}

template <class Io, class A>
void exchange_evaluation(Io& io, A& archive, const Recording& recording, const Units& units) {
  const auto names = [](const std::vector<FilterEvaluation>& list) {
    std::vector<std::string> filters;
    for (const FilterEvaluation& evaluation : list) filters.push_back(evaluation.filter);
    return filters;
  };
  const auto named = [](const std::vector<std::string>& filters) {
    std::vector<FilterEvaluation> list;
    for (const std::string& filter : filters) list.push_back({filter, {}});
    return list;
  };
  io.through(archive.evaluations, names, named, [&](auto& filters) { io.attribute_texts("filters", filters); });
  for (auto& evaluation : archive.evaluations)
    io.group(evaluation.filter, {},
             [&](auto& member) { exchange_filter(member, evaluation, recording, units.states()); });
  exchange_summary(io, archive.summary, units.states());
  exchange_horizon(io, archive.horizons, units.states());
  exchange_diagnostics(io, archive.diagnostics, units.states());
}

}  // namespace modebank::layout
