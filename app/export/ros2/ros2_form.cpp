#include <fmt/format.h>
#include <fmt/ranges.h>

#include <array>
#include <cmath>
#include <iterator>

#include "app/export/forms.hpp"
#include "app/export/names.hpp"
#include "app/text/robot_numbers.hpp"
#include "ident/base/not_a_number.hpp"

namespace modebank::app {
namespace {

/// ROS reads "1" as an integer. It rejects an integer for a parameter of type double.
std::string yaml_number(double value) {
  const std::string text = fmt::format("{}", value);
  return text.find_first_of(".e") == std::string::npos ? text + ".0" : text;
}

RobotBank robot_of(const ExportedBank& exported) {
  return {exported.bank, exported.measurements, exported.recorded_inputs, exported.input_lag_s};
}

std::string error_text(const Estimate& estimate) {
  if (!std::isfinite(estimate.error)) return "standard error unknown";
  const std::string doubt = doubt_about(estimate.value, estimate.error);
  return fmt::format("+- {:.2g}{}", estimate.error, doubt.empty() ? "" : ": " + doubt);
}

/// Text with the modes that enter a mean. Empty if all modes of the family enter the mean.
std::string of_modes_text(const Estimate& estimate) {
  if (estimate.modes.empty()) return "";
  return fmt::format(", of mode{} {} alone", estimate.modes.size() == 1 ? "" : "s", fmt::join(estimate.modes, ", "));
}

/// Whether the value is precise enough for use on a robot.
bool is_told(const Estimate& estimate) { return estimate.known() && !estimate.vague(); }

/// A line with the key and its value, if the bank determines this value. Otherwise a comment with the reason.
std::string key_line(const char* key, const Estimate& estimate, const std::string& unit, const std::string& reason) {
  if (!estimate.known()) return fmt::format("    # {}: not determined: {}\n", key, comment_text(reason));
  if (estimate.vague())
    return fmt::format("    # {}: not determined: {:.6g} {}{}\n", key, estimate.value, error_text(estimate),
                       unit + of_modes_text(estimate));
  return fmt::format("    {}: {}  # {}{}{}\n", key, yaml_number(estimate.value), error_text(estimate), unit,
                     of_modes_text(estimate));
}

std::string missing_text(const RobotChannels& channels) {
  std::string text;
  for (const std::string& missing : channels.missing) text += (text.empty() ? "" : "; ") + missing;
  return text.empty() ? "no mode here settles and turns with its wheels" : text;
}

/// A list of six numbers. A number that the bank does not determine is 0, the default of ROS.
std::string twist_covariance(const RobotNumbers& numbers) {
  const Estimate &forward = numbers.forward_variance, &yaw = numbers.yaw_variance;
  if (!forward.known() && !yaw.known())
    return "    # twist_covariance_diagonal: not determined: neither speed is a state that settles\n";
  if (!is_told(forward) && !is_told(yaw))
    return key_line("twist_covariance_diagonal", yaw.known() ? yaw : forward, yaw.known() ? " of wz" : " of vx", "");
  std::string text = "    # Variances of vx, vy, vz, wx, wy, wz about their stationary values, P = A P A' + Q:";
  if (forward.known()) text += fmt::format(" vx [(m/s)^2] {};", error_text(forward));
  if (yaw.known()) text += fmt::format(" wz [(rad/s)^2] {};", error_text(yaw));
  text += "\n    # the others stay at the default, 0";
  if (!forward.known()) text += ": the forward speed is not among the states";
  if (!yaw.known()) text += ": the yaw rate is not among the states";
  return text + fmt::format("\n    twist_covariance_diagonal: [{}, 0.0, 0.0, 0.0, 0.0, {}]\n",
                            yaml_number(is_told(forward) ? forward.value : 0.0),
                            yaml_number(is_told(yaw) ? yaw.value : 0.0));
}

std::string diff_drive(const RobotNumbers& numbers, const RobotChannels& channels, const RobotSizes& sizes) {
  const std::string missing = missing_text(channels);
  std::string text =
      "# ros2_controllers of ROS 2 Humble to Jazzy, diff_drive_controller. Gains at steady state, C (I - A)^-1 B: G of "
      "the yaw rate\n# and H of the forward speed per left (L) and right (R) wheel speed, r the wheel radius (1 for "
      "speeds "
      "in m/s).\n# Standard errors by the delta method from those of the mode's parameters.\n"
      "diff_drive_controller:\n  ros__parameters:\n";
  text +=
      channels.forward_speed >= 0
          ? "    # separation = 2 (H_L + H_R) / (G_R - G_L), multipliers 2 H_L / r and 2 H_R / r\n"
          : "    # separation = 2 r / (G_R - G_L), multipliers -2 G_L / (G_R - G_L) and 2 G_R / (G_R - G_L): without a "
            "forward\n    # speed among the states their mean is taken as one\n";
  const Estimate& separation = numbers.separation_m;
  const bool lacks_radius = channels.wheels_in_rad_s && sizes.wheel_radius_m == 0.0;
  if (separation.known() && sizes.wheel_separation_m > 0.0) {
    const double nominal = sizes.wheel_separation_m;
    text += key_line("wheel_separation_multiplier",
                     {separation.value / nominal, separation.error / nominal, separation.modes},
                     fmt::format(" of wheel_separation = {} m", nominal), "");
  } else if (separation.known()) {
    text += fmt::format(
        "    # wheel_separation_multiplier: {:.6g} m {} m{} over your wheel_separation (give it as "
        "--wheel_separation_m)\n",
        separation.value, error_text(separation), of_modes_text(separation));
  } else {
    text += key_line("wheel_separation_multiplier", separation, "",
                     lacks_radius ? "wheel speeds are rad/s: give --wheel_radius_m" : missing);
  }
  const std::string reason = lacks_radius ? "wheel speeds are rad/s: give --wheel_radius_m" : missing;
  text += key_line("left_wheel_radius_multiplier", numbers.left_multiplier, "", reason);
  text += key_line("right_wheel_radius_multiplier", numbers.right_multiplier, "", reason);
  return text + twist_covariance(numbers) + "\n";
}

constexpr Index filter_states = 15;
/// Defaults of robot_localization for x y z roll pitch yaw, the velocities of these, ax ay az.
constexpr std::array<double, filter_states> default_noise{0.05, 0.05, 0.06, 0.03, 0.03, 0.06, 0.025, 0.025,
                                                          0.04, 0.01, 0.01, 0.02, 0.01, 0.01, 0.015};
constexpr Index filter_vx = 6, filter_vyaw = 11;

std::string noise_rows(const Eigen::MatrixXd& noise) {
  std::string text;
  for (Index i = 0; i < filter_states; ++i) {
    text += "      ";
    for (Index j = 0; j < filter_states; ++j)
      text += yaml_number(noise(i, j)) + (j + 1 < filter_states ? ", " : i + 1 < filter_states ? ",\n" : "]\n");
  }
  return text;
}

std::string process_noise(const ExportedBank& exported, const ModeFamily& family, const RobotChannels& channels) {
  std::string text =
      "# robot_localization of ROS 2 Humble to Jazzy, ekf_node and ukf_node.\nekf_filter_node:\n  ros__parameters:\n";
  if (channels.yaw_rate < 0 && channels.forward_speed < 0)
    return text + fmt::format("    # process_noise_covariance: not determined: {}\n\n", missing_text(channels));
  const FamilyNoise of = family_noise(robot_of(exported), family);
  Eigen::MatrixXd noise = Eigen::MatrixXd::Zero(filter_states, filter_states);
  for (Index i = 0; i < filter_states; ++i) noise(i, i) = default_noise[static_cast<std::size_t>(i)];
  text +=
      "    # It adds process_noise_covariance times the time between two predictions; the bank's Q is per step of "
      "dt_s:\n"
      "    # process_noise_covariance = Q / dt_s. Q is what the bank's model leaves unexplained, wheel speeds known; a "
      "filter\n    # that takes velocities for constant needs more where they change. All else is the project's "
      "default.\n";
  /// Sets an entry of the matrix. An entry with a vague value keeps its default.
  const auto set = [&](Index a, Index b, Index of_a, Index of_b, const char* name) {
    if (of_a < 0 || of_b < 0) return false;
    const double dt_s = exported.bank.dt_s, Q = of.Q(of_a, of_b);
    const Estimate entry{Q / dt_s, of.error.size() > 0 ? of.error(of_a, of_b) / dt_s : not_a_number};
    const std::string range =
        family.modes.size() == 1
            ? ""
            : fmt::format(", its modes {:.3g} to {:.3g}", of.least(of_a, of_b) / dt_s, of.largest(of_a, of_b) / dt_s);
    text += fmt::format("    # {}: Q {:.6g} / dt_s {:.6g} s = {:.6g} {}{}{}\n", name, Q, dt_s, entry.value,
                        error_text(entry), range, entry.vague() ? ", and the default stays" : "");
    if (entry.vague()) return false;
    noise(a, b) = noise(b, a) = entry.value;
    return true;
  };
  const bool yaw = set(filter_vyaw, filter_vyaw, channels.yaw_rate, channels.yaw_rate, "vyaw [(rad/s)^2/s]");
  const bool forward = set(filter_vx, filter_vx, channels.forward_speed, channels.forward_speed, "vx [(m/s)^2/s]");
  if (yaw && forward)
    set(filter_vx, filter_vyaw, channels.forward_speed, channels.yaw_rate, "vx and vyaw [(m/s)(rad/s)/s]");
  if (!yaw && !forward) return text + "    # process_noise_covariance: not determined\n\n";
  return text + "    process_noise_covariance: [\n" + noise_rows(noise) + "\n";
}

std::string model_delays(const RobotNumbers& numbers, const RobotChannels& channels) {
  const auto line = [&](const char* key, const Estimate& delay) {
    return "  " + key_line(key, delay, " s", missing_text(channels));
  };
  return "# Nav2 of ROS 2 Lyrical (nav2_mppi_controller has these keys since June 2026), under your plugin's name. "
         "Mean "
         "delay of\n# the response to wheel speeds: the first moment of the impulse response, dead time and time "
         "constants "
         "together.\ncontroller_server:\n  ros__parameters:\n    FollowPath:\n" +
         line("model_delay_vx", numbers.forward_delay_s) + line("model_delay_wz", numbers.yaw_delay_s);
}

/// A mapping that contains only comments has the value null, which ROS rejects. So its key also becomes a comment.
std::string without_empty_mappings(const std::string& block) {
  std::string text;
  bool any = false;
  for (std::size_t begin = 0; begin < block.size();) {
    const std::size_t end = std::min(block.find('\n', begin), block.size() - 1);
    const std::string line = block.substr(begin, end + 1 - begin);
    const std::size_t first = line.find_first_not_of(" \n");
    any = any || (first != std::string::npos && line[first] != '#' && line.find(": ") != std::string::npos);
    begin = end + 1;
  }
  for (std::size_t begin = 0; begin < block.size();) {
    const std::size_t end = std::min(block.find('\n', begin), block.size() - 1);
    const std::string line = block.substr(begin, end + 1 - begin);
    text += (any || line == "\n" || line.front() == '#' ? "" : "# ") + line;
    begin = end + 1;
  }
  return text;
}

/// File names: the family's name ("ice") if it has one, else "mode_4" or "modes_2_7".
std::vector<std::string> file_names(const ExportedBank& exported) {
  std::vector<std::string> names;
  for (const ModeFamily& family : exported.families)
    names.push_back(family.modes.size() == 1 ? exported.mode_names[static_cast<std::size_t>(family.modes.front())]
                    : family.name.empty()    ? family.title()
                                             : family.name);
  return identifiers(names, Language::c);
}

/// Comment on the family, its use, and the meaning of its numbers.
std::string family_text(const ExportedBank& exported, const ModeFamily& family) {
  const bool judged = !exported.use.empty();
  std::string text = fmt::format("{}, {:.1f} % of the {}", comment_text(family.title()), 100.0 * family.use,
                                 judged ? "judged samples" : "windows");
  if (family.modes.size() == 1) return text;
  std::string shares;
  for (std::size_t i = 0; i < family.modes.size(); ++i)
    shares += fmt::format("{}{} {:.1f} %", i > 0 ? ", " : "", family.modes[i], 100.0 * family.uses[i]);
  return text +
         fmt::format(
             ".\n# Numbers are means over its modes by use ({}). Standard errors hold those of the modes and how "
             "far\n# the modes are apart (law of total variance); those of variances and covariances are of the "
             "mean alone",
             shares);
}

}  // namespace

std::vector<std::pair<std::string, std::string>> to_ros2(const ExportedBank& exported, const RobotSizes& sizes) {
  const RobotChannels channels = robot_channels(robot_of(exported));
  std::vector<std::pair<std::string, std::string>> files;
  const std::vector<std::string> names = file_names(exported);
  std::string remarks;
  for (const std::string& remark : exported.remarks()) remarks += "# " + comment_text(remark) + "\n";
  for (std::size_t f = 0; f < names.size(); ++f) {
    const ModeFamily& family = exported.families[f];
    const RobotNumbers numbers = family_numbers(robot_of(exported), family, channels, sizes);
    const std::string opening = fmt::format(
        "# Calibration: {}\n# {}.\n# Of a bank made by modebank {} of {},\n# SHA-256 {}, filter {}.\n"
        "# {}\n# dt_s = {} s. {}.\n{}# Keys are those that the bank determines; what it does not is a comment that "
        "says "
        "why.\n\n",
        comment_text(exported.verdict_text()), family_text(exported, family),
        comment_text(exported.provenance.modebank_version), comment_text(exported.archive), exported.sha256,
        exported.filter, exported_equation, yaml_number(exported.bank.dt_s), transition_meaning, remarks);
    files.emplace_back(names[f] + ".yaml", opening + without_empty_mappings(diff_drive(numbers, channels, sizes)) +
                                               without_empty_mappings(process_noise(exported, family, channels)) +
                                               without_empty_mappings(model_delays(numbers, channels)));
  }
  return files;
}

}  // namespace modebank::app
