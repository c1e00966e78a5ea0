#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

#include "app/export/forms.hpp"
#include "ident/base/distributions.hpp"
#include "io/archive/bank/units.hpp"

namespace modebank::app {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
/// A JSON object whose members keep the order in which they were added.
using OrderedJson = nlohmann::ordered_json;

constexpr std::array gate_shares{0.95, 0.99, 0.999};

OrderedJson rows_of(const Unit& units, Index rows, Index cols) {
  OrderedJson list = OrderedJson::array();
  for (Index i = 0; i < rows; ++i) {
    OrderedJson row = OrderedJson::array();
    for (Index j = 0; j < cols; ++j) row.push_back(units[static_cast<std::size_t>(i * cols + j)]);
    list.push_back(row);
  }
  return list;
}

/// An unknown number (NaN) becomes null.
OrderedJson vector_json(const VectorXd& v) {
  OrderedJson list = OrderedJson::array();
  for (const double value : v) list.push_back(value);
  return list;
}

OrderedJson matrix_json(const MatrixXd& M) {
  OrderedJson rows = OrderedJson::array();
  for (Index i = 0; i < M.rows(); ++i) rows.push_back(vector_json(M.row(i).transpose()));
  return rows;
}

Unit units_of(const std::vector<Channel>& channels) {
  Unit units;
  for (const Channel& channel : channels) units.push_back(channel.unit);
  return units;
}

/// A matrix with its standard errors (null if unknown) and the units of its entries (empty if unknown).
OrderedJson quantity(const MatrixXd& value, const MatrixXd& error, const Unit& units) {
  OrderedJson result = {{"value", matrix_json(value)}};
  result["standard_error"] = error.size() == value.size() ? matrix_json(error) : OrderedJson(nullptr);
  result["unit"] = rows_of(units, value.rows(), value.cols());
  return result;
}

OrderedJson channels_json(const std::vector<Channel>& channels) {
  OrderedJson list = OrderedJson::array();
  for (const Channel& channel : channels) list.push_back({{"name", channel.name}, {"unit", channel.unit}});
  return list;
}

OrderedJson verdict_json(const ExportedBank& bank) {
  const bool judged = !bank.judged_on.empty();
  return {{"answer", judged ? OrderedJson(name_of(bank.verdict)) : OrderedJson("not judged")},
          {"judged_on", judged ? OrderedJson(bank.judged_on) : OrderedJson(nullptr)},
          {"share_in_95_band", judged ? OrderedJson(bank.coverage_95) : OrderedJson(nullptr)},
          {"text", bank.verdict_text()},
          {"finding", bank.finding}};
}

OrderedJson source_json(const ExportedBank& bank) {
  return {{"archive", bank.archive},
          {"sha256", bank.sha256},
          {"filter", bank.filter},
          {"created", bank.provenance.created},
          {"modebank_version", bank.provenance.modebank_version},
          {"config_hash", bank.provenance.config_hash},
          {"data_hash", bank.provenance.data_hash}};
}

/// The motions: title, modes, use, stay, time constant and gains.
OrderedJson motions_json(const ExportedBank& bank) {
  OrderedJson list = OrderedJson::array();
  const Unit units = ratios(units_of(bank.measurements), units_of(bank.recorded_inputs));
  for (const Motion& motion : bank.motions) {
    list.push_back({{"motion", motion.number}, {"title", motion.title()}, {"modes", motion.modes}});
    list.back()["used"] = bank.use.empty() ? OrderedJson(nullptr) : OrderedJson(motion.use);
    list.back()["stay_s"] = motion.stay_s;
    list.back()["time_constant_s"] = {{"value", motion.slowest.time_constant_s},
                                      {"standard_error", motion.slowest.time_constant_error_s}};
    list.back()["gain"] = quantity(motion.gain, motion.gain_error, units);
  }
  return list;
}

Unit per_second(Unit units) {
  for (std::string& unit : units)
    if (!unit.empty()) unit += "/s";
  return units;
}

/// Thresholds of the normalised innovation squared. There is one for each number of signals that a sample may have.
OrderedJson gates_json(Index signals) {
  OrderedJson gates = OrderedJson::array();
  for (Index n = 1; n <= signals; ++n)
    for (const double share : gate_shares)
      gates.push_back({{"signals", n}, {"share", share}, {"nis", chi_square_quantile(share, static_cast<double>(n))}});
  return gates;
}

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
                        {"motion", exported.bank.motion_of(k)},
                        {"share_of_windows", mode.weight}};
  result["A"] = quantity(exported.A(k), errors.A, ratios(states, states));
  result["B"] = quantity(mode.model.B, errors.B, ratios(states, inputs));
  result["c"] = quantity(mode.model.c, errors.c, states);
  result["Q"] = quantity(mode.Q, mode.Q_standard_error, outer(states));
  result["Q_per_s"] =
      quantity(mode.Q / exported.bank.dt_s, mode.Q_standard_error / exported.bank.dt_s, per_second(outer(states)));
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
      {"reference", vector_json(bank.transition_logit.reference)}};
  return result;
}

OrderedJson filter_json(const ExportedBank& exported) {
  const Bank& bank = exported.bank;
  OrderedJson result = {{"variant", name_of(exported.options.variant)}};
  result["quantum"] = bank.quantum.size() > 0 ? vector_json(bank.quantum) : OrderedJson(nullptr);
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
  page["gates"] = gates_json(bank.C.rows());
  page["filter"] = filter_json(exported);
  page["motions"] = motions_json(exported);
  page["modes"] = OrderedJson::array();
  for (Index k = 0; k < bank.mode_count(); ++k) page["modes"].push_back(mode_json(exported, k));
  return page.dump(1, ' ', false, OrderedJson::error_handler_t::replace) + "\n";
}

}  // namespace modebank::app
