#include <cmath>

#include "app/export/forms.hpp"
#include "app/export/json_parts.hpp"

namespace modebank::app {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

/// `remark_of`: returns the remark on the value at an index; empty if the value is reliable.
template <class RemarkOf>
OrderedJson parameters_json(const VectorXd& values, const VectorXd& errors, const std::vector<std::string>& names,
                            const std::vector<std::string>& units, RemarkOf remark_of) {
  OrderedJson list = OrderedJson::array();
  for (Index i = 0; i < values.size(); ++i) {
    const auto at = static_cast<std::size_t>(i);
    list.push_back({{"name", names[at]},
                    {"value", values(i)},
                    {"standard_error", errors.size() == values.size() ? OrderedJson(errors(i)) : OrderedJson(nullptr)},
                    {"unit", at < units.size() ? units[at] : ""}});
    if (const std::string remark = remark_of(i); !remark.empty()) list.back()["remark"] = remark;
  }
  return list;
}

OrderedJson mode_json(const ExportedBank& exported, Index k) {
  const auto at = static_cast<std::size_t>(k);
  const Mode& mode = exported.bank.modes[at];
  const ModeErrors& errors = exported.errors[at];
  const Unit states = units_of(exported.states), inputs = units_of(exported.inputs);
  OrderedJson result = {{"index", k},
                        {"name", exported.mode_names[at]},
                        {"family", family_of(exported, k)},
                        {"share_of_windows", mode.weight}};
  result["A"] = quantity(exported.A(k), errors.A, ratios(states, states));
  result["B"] = quantity(mode.model.B, errors.B, ratios(states, inputs));
  result["c"] = quantity(mode.model.c, errors.c, states);
  result["Q"] = quantity(mode.Q, mode.Q_standard_error, outer(states));
  result["parameters"] =
      parameters_json(exported.bank.theta(k), mode.standard_error, exported.parameter_names, exported.parameter_units,
                      [&](Index i) { return doubt_about_parameter(exported, k, i); });
  if (mode.motion_theta.size() == 0) return result;
  std::vector<std::string> names, units;
  for (const ModelParameter& parameter : exported.bank.motion_parameters) {
    names.push_back(parameter.name);
    units.push_back(parameter.unit);
  }
  result["motion_parameters"] =
      parameters_json(mode.motion_theta, mode.motion_standard_error, names, units, [&](Index i) {
        return doubt_about(mode.motion_theta(i),
                           mode.motion_standard_error.size() > i ? mode.motion_standard_error(i) : NAN);
      });
  return result;
}

OrderedJson transition_json(const ExportedBank& exported) {
  const Bank& bank = exported.bank;
  OrderedJson result = {
      {"meaning", transition_meaning},
      {"T", matrix_json(bank.transition.matrix())},
      {"standard_error",
       bank.transition_standard_error.size() > 0 ? matrix_json(bank.transition_standard_error) : OrderedJson(nullptr)},
      {"initial_probability", vector_json(bank.initial_probability)}};
  if (bank.transition_logit.empty()) {
    result["logit"] = nullptr;
    return result;
  }
  OrderedJson features = OrderedJson::array();
  for (const auto* channels : {&exported.states, &exported.inputs})
    for (const Channel& channel : *channels) features.push_back(channel.name);
  result["logit"] = {
      {"meaning",
       "P(mode j next | mode i now, z) is proportional to T[i][j] exp(w[j] . (z - reference)), z = (x, u) of the step"},
      {"features", features},
      {"weights", matrix_json(bank.transition_logit.weights)},
      {"standard_error",
       bank.transition_weight_error.size() > 0 ? matrix_json(bank.transition_weight_error) : OrderedJson(nullptr)},
      {"reference", vector_json(bank.transition_logit.reference)}};
  return result;
}

OrderedJson filter_json(const ExportedBank& exported) {
  const Bank& bank = exported.bank;
  OrderedJson result = {{"variant", name_of(exported.options.variant)},
                        {"noise", name_of(exported.options.noise)},
                        {"noise_forgetting", bank.noise_adaptation.forgetting},
                        {"noise_prior_samples", bank.noise_adaptation.prior_samples}};
  result["quantum"] = bank.quantum.size() > 0 ? vector_json(bank.quantum) : OrderedJson(nullptr);
  result["noise_factor"] = nullptr;
  if (!bank.noise_factor.empty())
    result["noise_factor"] = {{"directions", matrix_json(bank.noise_factor.directions)},
                              {"weights", vector_json(bank.noise_factor.weights)},
                              {"offset", bank.noise_factor.offset},
                              {"softening", NoiseFactor::softening},
                              {"largest", NoiseFactor::largest}};
  result["drift"] = nullptr;
  if (!bank.drift.empty())
    result["drift"] = {{"q", bank.drift.rates.q},
                       {"p0", bank.drift.rates.p0},
                       {"leak", bank.drift.rates.leak},
                       {"regressor_scale", vector_json(bank.drift.scale)}};
  return result;
}

}  // namespace

std::string to_json(const ExportedBank& exported) {
  const Bank& bank = exported.bank;
  const LinearStructure& s = bank.structure;
  const Unit outputs = units_of(exported.measurements);
  OrderedJson page = {{"format", "modebank export"}, {"schema_version", export_schema_version}};
  page["verdict"] = verdict_json(exported);
  page["source"] = source_json(exported);
  page["equation"] = exported_equation;
  page["remarks"] = exported.remarks();
  page["dt_s"] = bank.dt_s;
  page["model"] = bank.model;
  page["input_lag_s"] = exported.input_lag_s;
  page["lags"] = {
      {"state_lags", s.state_lags}, {"input_lags", s.input_lags}, {"input_delay", s.input_delay.by_input(s.inputs)}};
  page["states"] = channels_json(exported.states);
  page["inputs"] = channels_json(exported.inputs);
  page["measurements"] = channels_json(exported.measurements);
  page["C"] =
      quantity(bank.C, MatrixXd::Zero(bank.C.rows(), bank.C.cols()), ratios(outputs, units_of(exported.states)));
  page["R"] = quantity(bank.R, bank.R_standard_error, outer(outputs));
  page["transition"] = transition_json(exported);
  page["filter"] = filter_json(exported);
  page["families"] = families_json(exported);
  page["modes"] = OrderedJson::array();
  for (Index k = 0; k < bank.mode_count(); ++k) page["modes"].push_back(mode_json(exported, k));
  return page.dump(1, ' ', false, OrderedJson::error_handler_t::replace) + "\n";
}

}  // namespace modebank::app
