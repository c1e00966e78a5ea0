#include "app/export/json_parts.hpp"

namespace modebank::app {

using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

OrderedJson rows_of(const Unit& units, Index rows, Index cols) {
  OrderedJson list = OrderedJson::array();
  for (Index i = 0; i < rows; ++i) {
    OrderedJson row = OrderedJson::array();
    for (Index j = 0; j < cols; ++j) row.push_back(units[static_cast<std::size_t>(i * cols + j)]);
    list.push_back(row);
  }
  return list;
}

}  // namespace

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

OrderedJson families_json(const ExportedBank& bank) {
  OrderedJson list = OrderedJson::array();
  const Unit units = ratios(units_of(bank.measurements), units_of(bank.recorded_inputs));
  for (std::size_t f = 0; f < bank.families.size(); ++f) {
    const ModeFamily& family = bank.families[f];
    list.push_back({{"family", f}, {"title", family.title()}, {"modes", family.modes}});
    list.back()["used"] = bank.use.empty() ? OrderedJson(nullptr) : OrderedJson(family.use);
    list.back()["stay_s"] = family.stay_s;
    list.back()["time_constant_s"] = {{"value", family.slowest.time_constant_s},
                                      {"standard_error", family.slowest.time_constant_error_s}};
    list.back()["gain"] = quantity(family.gain, family.gain_error, units);
  }
  return list;
}

OrderedJson family_of(const ExportedBank& bank, Index mode) {
  for (std::size_t f = 0; f < bank.families.size(); ++f)
    for (const Index member : bank.families[f].modes)
      if (member == mode) return f;
  return nullptr;
}

}  // namespace modebank::app
