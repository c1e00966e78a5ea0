#include "io/archive/bank/units.hpp"

#include <algorithm>
#include <map>

namespace modebank {

namespace {

std::string parenthesized(const std::string& unit) {
  return unit.find_first_of("*/ ") == std::string::npos ? unit : "(" + unit + ")";
}

std::string at(const Unit& unit, Eigen::Index i) {
  const auto position = static_cast<std::size_t>(i);
  return position < unit.size() ? unit[position] : std::string();
}

}  // namespace

std::string unit_product(const std::string& a, const std::string& b) {
  if (a.empty() || b.empty()) return {};
  if (a == "1" || b == "1") return a == "1" ? b : a;
  return a == b ? "(" + a + ")^2" : "(" + a + ")*(" + b + ")";
}

std::string unit_ratio(const std::string& a, const std::string& b) {
  if (a.empty() || b.empty()) return {};
  if (a == b) return "1";
  return b == "1" ? a : parenthesized(a) + "/" + parenthesized(b);
}

Unit squared(const Unit& unit) {
  Unit result;
  for (const std::string& u : unit) result.push_back(unit_product(u, u));
  return result;
}

Unit outer(const Unit& unit) {
  Unit result;
  for (const std::string& a : unit)
    for (const std::string& b : unit) result.push_back(unit_product(a, b));
  return result;
}

Unit ratios(const Unit& to, const Unit& from) {
  Unit result;
  for (const std::string& a : to)
    for (const std::string& b : from) result.push_back(unit_ratio(a, b));
  return result;
}

std::string joined(const Unit& unit) {
  if (unit.empty() || std::find(unit.begin(), unit.end(), "") != unit.end()) return {};
  const bool common = std::count(unit.begin(), unit.end(), unit.front()) == static_cast<std::ptrdiff_t>(unit.size());
  if (common) return unit.front();
  std::string all = unit.front();
  for (std::size_t i = 1; i < unit.size(); ++i) all += ", " + unit[i];
  return all;
}

Unit Units::of(const std::vector<Channel>& channels) {
  Unit result;
  for (const Channel& channel : channels) result.push_back(channel.unit);
  return result;
}

Unit Units::of(const std::vector<Channel>& channels, const std::vector<std::string>& names) {
  Unit result;
  for (const std::string& name : names) {
    const std::string base = name.substr(0, name.rfind("[k"));
    const auto found = std::find_if(channels.begin(), channels.end(),
                                    [&](const Channel& c) { return c.name == name || c.name == base; });
    result.push_back(found == channels.end() ? std::string() : found->unit);
  }
  return result;
}

Unit unit_of(const std::vector<ModelParameter>& parameters) {
  Unit result;
  for (const ModelParameter& parameter : parameters) result.push_back(parameter.unit);
  return result;
}

Unit feature_units(const std::vector<std::string>& names, const WindowFits& fits, const Units& units) {
  std::map<std::string, std::string> unit_of_name;
  const auto add = [&](const std::vector<std::string>& parameters, const Unit& of_parameters) {
    for (std::size_t i = 0; i < parameters.size(); ++i) unit_of_name.emplace(parameters[i], of_parameters[i]);
  };
  const LinearStructure one_lag = fits.structure.with_one_lag();
  if (fits.model_parameters.empty()) {
    add(fits.parameter_names(), parameter_units(fits.structure, units.states(), units.inputs()));
    add(one_lag.parameter_names(), parameter_units(one_lag, units.states(), units.inputs()));
  } else {
    add(fits.parameter_names(), unit_of(fits.model_parameters));
  }
  Unit result;
  for (const std::string& name : names) {
    const auto found = unit_of_name.find(name);
    result.push_back(found == unit_of_name.end() ? "1" : found->second);
  }
  return result;
}

Unit parameter_units(const LinearStructure& structure, const Unit& states, const Unit& inputs) {
  Unit result;
  for (Eigen::Index i = 0; i < structure.states; ++i) {
    // A diagonal entry of A has the unit 1, whatever the state's unit is.
    for (Eigen::Index j = 0; j < structure.dimension(); ++j) {
      const Eigen::Index state = j % structure.states;
      result.push_back(i == state ? "1" : unit_ratio(at(states, i), at(states, state)));
    }
    for (Eigen::Index j = 0; j < structure.acting_inputs(); ++j)
      result.push_back(unit_ratio(at(states, i), at(inputs, j % structure.inputs)));
    if (structure.intercept) result.push_back(at(states, i));
  }
  return result;
}

}  // namespace modebank
