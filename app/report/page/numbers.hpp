#pragma once

#include <Eigen/Core>
#include <nlohmann/json_fwd.hpp>
#include <string>

/// Number formats of the report. All numbers are formatted here. The page contains each number as text and as exact
/// value.
namespace modebank::app::report {

/// A number with four significant digits; a dash if it is unknown.
std::string number_text(double value);
/// A value, rounded to the second digit of its standard error: "-0.597 ± 0.031".
std::string estimate_text(double value, double standard_error);
/// A share in percent with two decimals.
std::string percent_text(double share);
/// A count with spaces between thousands: "1 234 567".
std::string count_text(long long count);

/// {"t": text, "v": exact value}. The page shows the text. It uses the exact value to sort, filter and test.
nlohmann::json number(double value);
nlohmann::json number(double value, const std::string& text);
/// Several values in one cell, for example an RMSE for each state. "v" is the list of values.
nlohmann::json number_list(const Eigen::VectorXd& values);
nlohmann::json estimate(double value, double standard_error);
nlohmann::json percent(double share);
nlohmann::json count(long long value);

}  // namespace modebank::app::report
