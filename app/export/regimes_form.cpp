#include <array>

#include "app/export/forms.hpp"
#include "app/export/json_parts.hpp"
#include "ident/base/distributions.hpp"

namespace modebank::app {
namespace {

using Eigen::MatrixXd;

constexpr std::array gate_shares{0.95, 0.99, 0.999};

/// Standard errors of the measured states' block of Q; empty if there are none.
MatrixXd measured_error(const ExportedBank& exported, const Mode& mode) {
  const Eigen::Index signals = exported.bank.C.rows();
  if (mode.Q_standard_error.rows() < signals || mode.Q_standard_error.cols() < signals) return {};
  return mode.Q_standard_error.topLeftCorner(signals, signals);
}

Unit per_second(Unit units) {
  for (std::string& unit : units)
    if (!unit.empty()) unit += "/s";
  return units;
}

OrderedJson regime_json(const ExportedBank& exported, Eigen::Index k) {
  const auto at = static_cast<std::size_t>(k);
  const Bank& bank = exported.bank;
  const Mode& mode = bank.modes[at];
  const MatrixXd Q = bank.C * mode.Q * bank.C.transpose(), error = measured_error(exported, mode);
  const Unit unit = outer(units_of(exported.measurements));
  const double leaves = 1.0 - bank.transition.matrix()(k, k);
  OrderedJson regime = {{"index", k}, {"name", exported.mode_names[at]}, {"family", family_of(exported, k)}};
  regime["used"] = exported.use.empty() ? OrderedJson(nullptr) : OrderedJson(exported.use[at]);
  regime["stay_s"] = leaves > 0.0 ? OrderedJson(bank.dt_s / leaves) : OrderedJson(nullptr);
  regime["Q"] = quantity(Q, error, unit);
  regime["Q_per_s"] = quantity(Q / bank.dt_s, error / bank.dt_s, per_second(unit));
  return regime;
}

/// Thresholds of the normalised innovation squared. There is one for each number of signals that a sample may have.
OrderedJson gates_json(Eigen::Index signals) {
  OrderedJson gates = OrderedJson::array();
  for (Eigen::Index n = 1; n <= signals; ++n)
    for (const double share : gate_shares)
      gates.push_back({{"signals", n}, {"share", share}, {"nis", chi_square_quantile(share, static_cast<double>(n))}});
  return gates;
}

}  // namespace

std::string to_regimes(const ExportedBank& exported) {
  const Bank& bank = exported.bank;
  OrderedJson page = {{"format", "modebank regimes"}, {"schema_version", regimes_schema_version}};
  page["verdict"] = verdict_json(exported);
  page["source"] = source_json(exported);
  page["remarks"] = exported.remarks();
  page["dt_s"] = bank.dt_s;
  page["signals"] = channels_json(exported.measurements);
  page["R"] = quantity(bank.R, bank.R_standard_error, outer(units_of(exported.measurements)));
  page["regimes"] = OrderedJson::array();
  for (Eigen::Index k = 0; k < bank.mode_count(); ++k) page["regimes"].push_back(regime_json(exported, k));
  page["families"] = families_json(exported);
  page["transition"] = {{"meaning", transition_meaning},
                        {"T", matrix_json(bank.transition.matrix())},
                        {"initial_probability", vector_json(bank.initial_probability)}};
  page["noise_follows_run"] = exported.options.noise == FilterNoise::adaptive;
  page["gates"] = gates_json(bank.C.rows());
  return page.dump(1, ' ', false, OrderedJson::error_handler_t::replace) + "\n";
}

}  // namespace modebank::app
