#include "app/report/page/numbers.hpp"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "app/text/number_text.hpp"
#include "app/text/text_units.hpp"

namespace modebank::app::report {
namespace {

constexpr const char* not_known = "–";

}  // namespace

std::string number_text(double value) {
  if (std::isnan(value)) return not_known;
  return std::isinf(value) ? (value > 0 ? "∞" : "−∞") : fmt::format("{:.4g}", value);
}

std::string estimate_text(double value, double standard_error) {
  if (!std::isfinite(value) || !std::isfinite(standard_error) || standard_error <= 0.0) return number_text(value);
  return app::estimate_text(value, standard_error, "±");
}

std::string percent_text(double share) {
  return std::isnan(share) ? not_known : fmt::format("{:.2f} %", app::percent * share);
}

std::string count_text(long long count) {
  std::string digits = fmt::format("{}", count);
  for (std::size_t i = digits.size(); i > 3 + (count < 0 ? 1u : 0u);) digits.insert(i -= 3, "\u202f");
  return digits;
}

nlohmann::json number(double value, const std::string& text) {
  return {{"t", text}, {"v", std::isfinite(value) ? nlohmann::json(value) : nlohmann::json()}};
}

nlohmann::json number(double value) { return number(value, number_text(value)); }

nlohmann::json number_list(const Eigen::VectorXd& values) {
  if (values.size() == 1) return number(values(0));
  std::string text;
  nlohmann::json list = nlohmann::json::array();
  for (const double value : values) {
    text += (text.empty() ? "" : ", ") + number_text(value);
    list.push_back(std::isfinite(value) ? nlohmann::json(value) : nlohmann::json());
  }
  return {{"t", text}, {"v", list}};
}

nlohmann::json estimate(double value, double standard_error) {
  return number(value, estimate_text(value, standard_error));
}

nlohmann::json percent(double share) { return number(share, percent_text(share)); }

nlohmann::json count(long long value) { return {{"t", count_text(value)}, {"v", value}}; }

}  // namespace modebank::app::report
