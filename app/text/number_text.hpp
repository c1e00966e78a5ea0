#pragma once

#include <cstddef>
#include <map>
#include <string>

namespace modebank::app {

/// The value with `decimals` decimals if this text fits a column, else with four significant digits: 0.03480,
/// 1.235e+15.
std::string fixed_or_short(double value, int decimals);

/// A value, rounded to the second digit of its standard error: "-0.597 +- 0.031". Four digits if the error is unknown.
std::string estimate_text(double value, double standard_error, const char* plus_minus = "+-");

/// A gain of log score as a likelihood ratio per sample: "1.3 times as likely", "3.4 % less likely".
std::string likelihood_words(double nats);

/// Text such as "0.0301 rad/s (1.72 deg/s)": three digits and the unit. Angles are also given in degrees.
std::string with_degrees(double value, const std::string& unit);

/// Same as fixed_or_short, for sizes such as an RMSE. Uses three significant digits if `decimals` would show fewer.
std::string size_text(double value, int decimals);

/// Same as size_text for several values, separated by spaces.
template <class Values>
std::string size_list(const Values& values, int decimals) {
  std::string text;
  for (const double value : values) text += (text.empty() ? "" : " ") + size_text(value, decimals);
  return text;
}

/// A number of things: "1 state lag", "2 state lags".
std::string counted(std::ptrdiff_t count, const char* what);

/// A duration such as "3 s", "4.2 min" or "1.5 h".
std::string duration_text(double seconds);

/// A rate such as "12.3 per s" or "40 per h".
std::string rate_text(double per_second);

/// The unit in which the screen counts time: "samples" if the log has neither times nor a stated rate, else "s".
/// `settings`: the archive's resolved configuration.
std::string time_unit(const std::map<std::string, std::string>& settings);

}  // namespace modebank::app
