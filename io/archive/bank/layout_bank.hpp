#pragma once

#include <string>

#include "ident/model/parameter_labels.hpp"
#include "io/archive/bank/stored_bank.hpp"
#include "io/archive/bank/units.hpp"
#include "io/hdf5/columns.hpp"

/// The layout of banks; see io/archive/layout.hpp.
namespace modebank::layout {

/// A part that an std::optional holds.
template <class Io, class T, class Body>
void exchange_part(Io& io, const std::string& name, T& part, const Sizes& known, Body body) {
  io.optional_group(name, part.has_value(), known, [&](auto& member) {
    if constexpr (Io::reads) part.emplace();
    body(member, *part);
  });
}

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
  io.optional_field("quantum", stored.quantum, {"n_y"}, outputs);
  io.field("transition", stored.transition, {"K", "K"});
  io.optional_field("transition_weights", stored.transition_weights, {"K", "K", "features"});
  io.optional_field("transition_reference", stored.transition_reference, {"features"});
  io.optional_field("transition_weight_standard_error", stored.transition_weight_error, {"K", "features"});
  io.field("initial_probability", stored.initial_probability, {"K"});
  io.optional_field("drift_scale", stored.drift_scale, {"regressors"});
  io.optional_field("drift_rates", stored.drift_rates, {"rates"});
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
  if constexpr (!Io::reads)
    io.attribute_texts("parameter_labels", parameter_labels(bank.structure, bank.state_names, bank.input_names));
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

}  // namespace modebank::layout
