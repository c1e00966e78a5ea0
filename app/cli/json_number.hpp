#pragma once

#include <Eigen/Core>
#include <cmath>
#include <nlohmann/json.hpp>

/// Numbers for JSON.
namespace modebank::app {

/// The number; null for NaN, because JSON has no NaN.
inline nlohmann::json json_number(double value) {
  return std::isfinite(value) ? nlohmann::json(value) : nlohmann::json(nullptr);
}

inline nlohmann::json json_numbers(const Eigen::VectorXd& values) {
  nlohmann::json list = nlohmann::json::array();
  for (const double value : values) list.push_back(json_number(value));
  return list;
}

}  // namespace modebank::app
