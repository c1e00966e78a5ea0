// Remarks on an exported bank's numbers.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>

#include "app/export/exported_bank.hpp"
#include "app/text/mode_words.hpp"

namespace modebank::app {
namespace {

using Eigen::Index;

constexpr double negligible_R = 1e-6;  // ratio of R to the process noise below which R counts as zero; the diagnostics
                                       // use the same ratio

std::string value_text(double value, double error) { return fmt::format("{:.3g} +- {:.2g}", value, error); }

/// Text such as "name (0.1 +- 0.3)" for each value that is smaller than its standard error.
template <class Values, class Errors>
void add_vague(const std::string& prefix, const std::vector<std::string>& names, const Values& values,
               const Errors& errors, std::vector<std::string>& vague) {
  if (errors.size() != values.size()) return;
  for (Index i = 0; i < values.size(); ++i)
    if (std::abs(values(i)) < errors(i))
      vague.push_back(
          fmt::format("{}{} ({})", prefix, names[static_cast<std::size_t>(i)], value_text(values(i), errors(i))));
}

std::vector<std::string> names_of_channels(const std::vector<Channel>& channels) {
  std::vector<std::string> names;
  for (const Channel& channel : channels) names.push_back(channel.name);
  return names;
}

void add_vague_of_mode(const ExportedBank& exported, Index k, std::vector<std::string>& list) {
  const Mode& mode = exported.bank.modes[static_cast<std::size_t>(k)];
  std::vector<std::string> vague, motion;
  for (const ModelParameter& parameter : exported.bank.motion_parameters) motion.push_back(parameter.name);
  add_vague("", exported.parameter_names, exported.bank.theta(k), mode.standard_error, vague);
  add_vague("", motion, mode.motion_theta, mode.motion_standard_error, vague);
  const Eigen::VectorXd Q = mode.Q.diagonal(), error = mode.Q_standard_error.diagonal();
  add_vague("Q of ", names_of_channels(exported.states), Q, error, vague);
  if (!vague.empty())
    list.push_back(fmt::format("{}: standard errors exceed the values, so even their signs are unknown: {}",
                               exported.mode_names[static_cast<std::size_t>(k)], fmt::join(vague, ", ")));
}

void add_open_parameters(const ExportedBank& exported, std::vector<std::string>& list) {
  std::vector<std::string> unidentifiable;
  for (std::size_t i = 0; i < exported.unidentifiable.size() && i < exported.parameter_names.size(); ++i)
    if (exported.unidentifiable[i]) unidentifiable.push_back(exported.parameter_names[i]);
  if (!unidentifiable.empty())
    list.push_back(fmt::format("not identifiable from the training runs (other values fit these runs equally well): {}",
                               fmt::join(unidentifiable, ", ")));
}

/// Adds modes whose parameters have no standard errors for another reason: a fit to predictions several steps ahead
/// gives none.
void add_unknown_errors(const ExportedBank& exported, std::vector<std::string>& list) {
  std::vector<std::string> modes;
  for (Index k = 0; k < exported.bank.mode_count(); ++k)
    for (Index i = 0; i < exported.structure().parameters(); ++i)
      if (doubt_about_parameter(exported, k, i) == doubt_about(0.0, NAN)) {
        modes.push_back(exported.mode_names[static_cast<std::size_t>(k)]);
        break;
      }
  if (!modes.empty()) list.push_back(fmt::format("standard errors are unknown: {}", fmt::join(modes, ", ")));
}

void add_measurement_noise(const ExportedBank& exported, std::vector<std::string>& list) {
  const Bank& bank = exported.bank;
  const std::vector<std::string> names = names_of_channels(exported.measurements);
  std::vector<std::string> vague;
  add_vague("R of ", names, Eigen::VectorXd(bank.R.diagonal()), Eigen::VectorXd(bank.R_standard_error.diagonal()),
            vague);
  if (!vague.empty()) list.push_back(fmt::format("standard errors exceed the values: {}", fmt::join(vague, ", ")));
  Eigen::VectorXd noise = Eigen::VectorXd::Zero(bank.C.rows());
  for (const Mode& mode : bank.modes) noise = noise.cwiseMax((bank.C * mode.Q * bank.C.transpose()).diagonal());
  for (Index i = 0; i < noise.size(); ++i)
    if (bank.R(i, i) <= negligible_R * noise(i))
      list.push_back(fmt::format(
          "R of {} is at its lower bound ({:.3g}, process noise {:.3g}): the data show no measurement noise "
          "at this rate; take R from the sensor's data sheet",
          names[static_cast<std::size_t>(i)], bank.R(i, i), noise(i)));
}

void add_switches(const Bank& bank, std::vector<std::string>& list) {
  const Eigen::MatrixXd &T = bank.transition.matrix(), &error = bank.transition_standard_error;
  if (error.size() == T.size() && (T.array() < error.array()).any())
    list.push_back(
        fmt::format("standard errors exceed {} of the {} entries of T", (T.array() < error.array()).count(), T.size()));
}

}  // namespace

std::string doubt_about(double value, double standard_error) {
  if (std::isnan(standard_error)) return "its standard error is unknown";
  return std::abs(value) < standard_error ? "its standard error exceeds it" : "";
}

std::string doubt_about_parameter(const ExportedBank& bank, Index mode, Index parameter) {
  const auto at = static_cast<std::size_t>(parameter);
  if (at < bank.unidentifiable.size() && bank.unidentifiable[at]) return not_identifiable;
  const Eigen::VectorXd& error = bank.bank.modes[static_cast<std::size_t>(mode)].standard_error;
  return doubt_about(bank.bank.theta(mode)(parameter), parameter < error.size() ? error(parameter) : NAN);
}

std::vector<std::string> ExportedBank::remarks() const {
  std::vector<std::string> list;
  if (!bank.motion_parameters.empty())
    list.push_back(
        fmt::format("A, B and c linearise the motion model {} at each mode's mean state and input", bank.model));
  add_open_parameters(*this, list);
  add_unknown_errors(*this, list);
  for (Index k = 0; k < bank.mode_count(); ++k) add_vague_of_mode(*this, k, list);
  add_measurement_noise(*this, list);
  add_switches(bank, list);
  return list;
}

}  // namespace modebank::app
