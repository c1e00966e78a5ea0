#include "app/text/errors_ahead.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <boost/algorithm/string/join.hpp>
#include <set>

#include "app/text/judged_runs.hpp"
#include "app/text/number_text.hpp"
#include "app/text/operating_point.hpp"
#include "filter/step/combined_filter.hpp"

namespace modebank::app {
namespace {

/// For each state, the standard deviation of the judged measurements; 0 without measurements. Only samples that can be
/// predicted `steps` steps ahead count.
Eigen::VectorXd standard_deviation_of_measurements(const Archive& archive, Role role, Index steps) {
  if (!archive.recording || !archive.bank) return {};
  const Index first = archive.bank->structure.first_transition() + steps;
  Spread judged(archive.recording->state_count());
  for (const Trajectory& run : archive.recording->runs)
    if (run.role == role && run.state.cols() > first) judged.add(run.state.rightCols(run.state.cols() - first));
  return judged.deviation();
}

/// FIT as defined by `compare` in Ljung's System Identification Toolbox for MATLAB: 100 (1 - ||y - prediction|| / ||y -
/// mean of y||) percent. Empty if unknown.
Eigen::VectorXd fit_percent(const Eigen::VectorXd& rmse, const Eigen::VectorXd& deviation) {
  const bool known = rmse.size() == deviation.size() && (deviation.array() > 0.0).all();
  return known ? Eigen::VectorXd(100.0 * (1.0 - rmse.array() / deviation.array())) : Eigen::VectorXd();
}

/// Text such as "0.0301 rad/s (1.72 deg/s), FIT 92.3 %". With several states, each value follows the name of its state.
std::string error_words(const ErrorAhead& error, const std::vector<Channel>& states) {
  std::vector<std::string> parts;
  for (Index i = 0; i < error.rmse.size(); ++i) {
    const Channel state = static_cast<std::size_t>(i) < states.size() ? states[static_cast<std::size_t>(i)] : Channel{};
    const std::string name = error.rmse.size() > 1 ? state.name + " " : "";
    parts.push_back(name + with_degrees(error.rmse(i), state.unit) +
                    (error.fit_percent.size() > i ? fmt::format(", FIT {:.1f} %", error.fit_percent(i)) : ""));
  }
  return boost::algorithm::join(parts, ", ");
}

/// Text such as "0.0301", or "0.0301, 0.2" with two states.
std::string digits(const Eigen::VectorXd& values) { return fmt::format("{:.3g}", fmt::join(values, ", ")); }

ErrorAhead error_ahead(const Archive& archive, Role role, const std::string& filter, const std::string& other,
                       Index steps, const ScoresAhead& own) {
  const auto rmse_of = [&](const std::string& name) {
    const auto scores = scores_ahead(archive, name, role, steps);
    return scores ? scores->rmse : Eigen::VectorXd();
  };
  ErrorAhead error;
  error.steps = steps;
  error.rmse = own.rmse;
  error.coverage_95 = own.coverage_95;
  error.combined = rmse_of(combined_name);
  error.fit_percent = fit_percent(error.rmse, standard_deviation_of_measurements(archive, role, steps));
  error.words = error_words(error, archive.recording ? archive.recording->states : std::vector<Channel>());
  std::vector<std::string> others;
  for (const std::string& name : {other, std::string(combined_name)})
    if (name != filter && rmse_of(name).size() > 0) others.push_back(fmt::format("{} {}", name, digits(rmse_of(name))));
  error.other_words = boost::algorithm::join(others, ", ");
  return error;
}

}  // namespace

std::vector<ErrorAhead> errors_ahead(const Archive& archive, Role role, const std::string& filter,
                                     const std::string& other) {
  Index longest = 1;
  for (const HorizonRow& row : archive.horizons)
    if (row.filter == filter && row.role == role && row.run == "*") longest = std::max(longest, row.horizon);
  std::vector<ErrorAhead> errors;
  for (const Index steps : std::set<Index>{1, longest})
    if (const auto own = scores_ahead(archive, filter, role, steps))
      errors.push_back(error_ahead(archive, role, filter, other, steps, *own));
  return errors;
}

std::string fit_words(const Eigen::VectorXd& fit) {
  std::vector<std::string> parts;
  for (const double share : fit) parts.push_back(fmt::format("{:.1f} %", share));
  return boost::algorithm::join(parts, ", ");
}

}  // namespace modebank::app
