#pragma once

#include <Eigen/Core>
#include <nlohmann/json_fwd.hpp>
#include <string>

/// Number formats of the report. Each number is formatted only here, and goes to the page together with its exact
/// value.
namespace modebank::app::report {

/// Four significant digits; a dash for an unknown value.
std::string number_text(double value);
/// A value to the second digit of its standard error: "-0.597 ± 0.031".
std::string estimate_text(double value, double standard_error);
/// A share as percent with two decimals.
std::string percent_text(double share);
/// 1234567 as "1 234 567".
std::string count_text(long long count);

/// {"t": text, "v": exact value}. The page shows t; it sorts, filters and tests by v.
nlohmann::json number(double value);
nlohmann::json number(double value, const std::string& text);
/// Several values in one cell, e.g. an RMSE per state; "v" is the list of values.
nlohmann::json number_list(const Eigen::VectorXd& values);
nlohmann::json estimate(double value, double standard_error);
nlohmann::json percent(double share);
nlohmann::json count(long long value);

}  // namespace modebank::app::report
