// Parameter files for ROS 2, read as YAML, for robots with known width, wheels, delay and noise.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "app/export/forms.hpp"
#include "tests/app/export/exported.hpp"
#include "tests/app/export/hostile_names.hpp"
#include "tests/filter/filter_test_support.hpp"
#include "tests/support/run_program.hpp"

namespace modebank::app::test {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;
using ::testing::Not;

#define MODEBANK_NEEDS_YAML() \
  MODEBANK_NEEDS(modebank::test::has_python_modules("yaml"), "PyYAML is absent: apt-get install python3-yaml")

/// Parses a text as YAML.
json read_yaml(const std::string& text) {
  const modebank::test::TemporaryFolder folder;
  modebank::test::write_file(folder.path() / "file.yaml", text);
  const auto result = modebank::test::run_program(
      {"/usr/bin/python3", "-c",
       "import json, sys, yaml; print(json.dumps(yaml.safe_load(open(sys.argv[1], encoding='utf-8'))))",
       (folder.path() / "file.yaml").string()});
  EXPECT_EQ(result.status, 0) << result.err << text;
  return result.status == 0 ? json::parse(result.out) : json();
}

/// A robot whose speeds follow the wheels' speeds, each with one time constant.
struct Robot {
  double separation_m = 0.55, left = 1.02, right = 0.97;  ///< left, right: multipliers of the wheel radius
  double yaw_time_s = 0.3, forward_time_s = 0.2, dt_s = 0.05;
  double yaw_noise = 4e-4, forward_noise = 9e-4, shared_noise = 1e-4;
};

/// A bank that predicts [yaw rate, forward speed], or only the yaw rate, from the [left, right] speeds. `radius_m`
/// converts rad/s to m/s.
ExportedBank bank_of(const Robot& robot, bool forward, double radius_m = 1.0) {
  const Index n = forward ? 2 : 1;
  Bank bank = modebank::test::example_bank(n, 2, 1, 0.0);
  bank.dt_s = robot.dt_s;
  Mode& mode = bank.modes[0];
  const double yaw = 1.0 - std::exp(-robot.dt_s / robot.yaw_time_s),
               speed = 1.0 - std::exp(-robot.dt_s / robot.forward_time_s);
  mode.model.A = -Eigen::Vector2d(yaw, speed).head(n).asDiagonal().toDenseMatrix();
  mode.model.B.resize(n, 2);
  mode.model.B.row(0) << -yaw * robot.left * radius_m / robot.separation_m,
      yaw * robot.right * radius_m / robot.separation_m;
  if (forward) mode.model.B.row(1) << speed * robot.left * radius_m / 2.0, speed * robot.right * radius_m / 2.0;
  mode.Q =
      Eigen::Matrix2d{{robot.yaw_noise, robot.shared_noise}, {robot.shared_noise, robot.forward_noise}}.topLeftCorner(
          n, n);
  mode.model.c.setZero();
  mode.standard_error = Eigen::VectorXd::Constant(bank.structure.parameters(), 1e-3);
  mode.parameter_covariance.resize(0, 0);
  ExportedBank exported = as_exported(bank);
  exported.measurements[0] = {"wz", "rad/s"};
  if (forward) exported.measurements[1] = {"vx", "m/s"};
  const std::string unit = radius_m == 1.0 ? "m/s" : "rad/s";
  exported.recorded_inputs = {{"velL", unit}, {"velR", unit}};
  return exported;
}

json parameters(const ExportedBank& exported, const RobotSizes& sizes, const std::string& node) {
  return read_yaml(to_ros2(exported, sizes).at(0).second).at(node).at("ros__parameters");
}

TEST(ExportedRos2, GivesTheRobotBack) {
  MODEBANK_NEEDS_YAML();
  const Robot robot;
  for (const double radius_m : {1.0, 0.165}) {
    const ExportedBank exported = bank_of(robot, true, radius_m);
    const RobotSizes sizes{0.5, radius_m == 1.0 ? 0.0 : radius_m};
    const json drive = parameters(exported, sizes, "diff_drive_controller");
    EXPECT_NEAR(drive.at("wheel_separation_multiplier"), robot.separation_m / 0.5, 1e-9);
    EXPECT_NEAR(drive.at("left_wheel_radius_multiplier"), robot.left, 1e-9);
    EXPECT_NEAR(drive.at("right_wheel_radius_multiplier"), robot.right, 1e-9);
    const double f = std::exp(-robot.dt_s / robot.yaw_time_s), g = std::exp(-robot.dt_s / robot.forward_time_s);
    EXPECT_NEAR(drive.at("twist_covariance_diagonal").at(5), robot.yaw_noise / (1.0 - f * f), 1e-12);
    EXPECT_NEAR(drive.at("twist_covariance_diagonal").at(0), robot.forward_noise / (1.0 - g * g), 1e-12);
    const json noise = parameters(exported, sizes, "ekf_filter_node").at("process_noise_covariance");
    ASSERT_EQ(noise.size(), 225u);
    EXPECT_NEAR(noise[11 * 15 + 11], robot.yaw_noise / robot.dt_s, 1e-12);
    EXPECT_NEAR(noise[6 * 15 + 6], robot.forward_noise / robot.dt_s, 1e-12);
    EXPECT_NEAR(noise[6 * 15 + 11], robot.shared_noise / robot.dt_s, 1e-12);
    EXPECT_EQ(noise[11 * 15 + 6], noise[6 * 15 + 11]);
    const json plan = parameters(exported, sizes, "controller_server").at("FollowPath");
    // Delay of a first-order lag with held input: dt / 2 coth(dt / 2 tau), which is about tau.
    const double half = 0.5 * robot.dt_s;
    EXPECT_NEAR(plan.at("model_delay_wz"), half / std::tanh(half / robot.yaw_time_s), 1e-9);
    EXPECT_NEAR(plan.at("model_delay_vx"), half / std::tanh(half / robot.forward_time_s), 1e-9);
    EXPECT_NEAR(plan.at("model_delay_wz"), robot.yaw_time_s, 0.01 * robot.yaw_time_s);
  }
}

TEST(ExportedRos2, CountsDeadTimeAndLags) {
  MODEBANK_NEEDS_YAML();
  ExportedBank exported = bank_of(Robot(), false);
  const double without = parameters(exported, {0.5, 0.0}, "controller_server").at("FollowPath").at("model_delay_wz");
  exported.input_lag_s = 0.12;
  exported.bank.structure.input_delay = 3;
  const double later = parameters(exported, {0.5, 0.0}, "controller_server").at("FollowPath").at("model_delay_wz");
  EXPECT_NEAR(later - without, 0.12 + 2.0 * Robot().dt_s, 1e-9);
}

/// Without a forward speed, the mean multiplier of the wheels is set to one. A comment names what is missing.
TEST(ExportedRos2, SaysWhatIsMissing) {
  MODEBANK_NEEDS_YAML();
  Robot robot;
  const ExportedBank exported = bank_of(robot, false);
  const std::string text = to_ros2(exported, {}).at(0).second;
  EXPECT_THAT(text, HasSubstr("# wheel_separation_multiplier: "));
  EXPECT_THAT(text, HasSubstr("--wheel_separation_m"));
  EXPECT_THAT(text, HasSubstr("model_delay_vx: not determined: no state is the forward speed"));
  EXPECT_EQ(text.rfind("# Calibration: calibrated", 0), 0u);
  const json drive = read_yaml(text).at("diff_drive_controller").at("ros__parameters");
  EXPECT_FALSE(drive.contains("wheel_separation_multiplier"));
  EXPECT_NEAR(
      drive.at("right_wheel_radius_multiplier").get<double>() + drive.at("left_wheel_radius_multiplier").get<double>(),
      2.0, 1e-12);
  EXPECT_NEAR(
      drive.at("right_wheel_radius_multiplier").get<double>() / drive.at("left_wheel_radius_multiplier").get<double>(),
      robot.right / robot.left, 1e-9);
  ExportedBank nothing = exported;
  nothing.measurements[0] = {"temperature", "K"};
  const std::string empty = to_ros2(nothing, {}).at(0).second;
  EXPECT_TRUE(read_yaml(empty).is_null()) << empty;
  EXPECT_THAT(empty, HasSubstr("no state is the yaw rate"));
  const std::string spinning = to_ros2(bank_of(robot, false, 0.165), {}).at(0).second;
  EXPECT_THAT(spinning, HasSubstr("give --wheel_radius_m"));
}

/// A value below its standard error becomes a comment with both numbers. In a list, its place has the default of ROS.
TEST(ExportedRos2, LeavesOutWhatItsErrorExceeds) {
  MODEBANK_NEEDS_YAML();
  const Robot robot;
  ExportedBank vague = bank_of(robot, true);
  Mode& mode = vague.bank.modes[0];
  mode.standard_error.setConstant(10.0);  // large compared with gains of about one
  mode.Q_standard_error = Eigen::Matrix2d{{1e-6, 0.0}, {0.0, 2.0 * robot.forward_noise}};
  const std::string text = to_ros2(vague, {1.0, 0.0}).at(0).second;
  for (const std::string key : {"wheel_separation_multiplier", "left_wheel_radius_multiplier", "model_delay_wz"})
    EXPECT_THAT(text, testing::ContainsRegex("# " + key + ": not determined: .* its standard error exceeds it"));
  EXPECT_THAT(text, HasSubstr("its standard error exceeds it, and the default stays"));
  const json file = read_yaml(text);
  EXPECT_FALSE(file.contains("controller_server"));
  const json noise = file.at("ekf_filter_node").at("ros__parameters").at("process_noise_covariance");
  EXPECT_NEAR(noise[11 * 15 + 11], robot.yaw_noise / robot.dt_s, 1e-12);
  EXPECT_EQ(noise[6 * 15 + 6], 0.025) << "the project's default";
  EXPECT_EQ(noise[6 * 15 + 11], 0.0);
  mode.Q_standard_error(0, 0) = 2.0 * robot.yaw_noise;
  const std::string nothing = to_ros2(vague, {1.0, 0.0}).at(0).second;
  EXPECT_THAT(nothing, HasSubstr("# process_noise_covariance: not determined"));
  EXPECT_TRUE(read_yaml(nothing).is_null()) << nothing;
}

/// If only B is uncertain, sd(separation) = separation^2 / 2 sd(G_R - G_L).
TEST(ExportedRos2, StatesErrorsByTheDeltaMethod) {
  const Robot robot;
  ExportedBank exported = bank_of(robot, false);
  exported.bank.modes[0].standard_error << 0.0, 1e-3, 1e-3, 0.0;
  const double yaw = 1.0 - std::exp(-robot.dt_s / robot.yaw_time_s);
  const double difference = (robot.left + robot.right) / robot.separation_m;
  const double expected = 2.0 / (difference * difference) * std::sqrt(2.0) * 1e-3 / yaw;
  const std::string text = to_ros2(exported, {1.0, 0.0}).at(0).second;
  EXPECT_THAT(text, HasSubstr(fmt::format("# +- {:.2g} of wheel_separation = 1 m", expected)));
}

/// Two modes of one family have different widths. They are used for 60 and 20 % of the time. The width of a third mode
/// is too vague to count.
ExportedBank family_of_three() {
  Robot wide;
  wide.separation_m = 0.65;
  wide.yaw_noise = 8e-4;
  ExportedBank exported = bank_of(Robot(), true);
  Bank bank = modebank::test::example_bank(2, 2, 3, 0.0);
  bank.dt_s = exported.bank.dt_s;
  bank.modes[0] = bank.modes[2] = exported.bank.modes[0];
  bank.modes[1] = bank_of(wide, true).bank.modes[0];
  for (Mode& mode : bank.modes) mode.Q_standard_error = Eigen::Matrix2d::Constant(1e-6);
  bank.modes[2].standard_error.setConstant(10.0);
  const std::vector<Channel> measurements = exported.measurements, inputs = exported.recorded_inputs;
  exported = as_exported(bank);
  exported.measurements = measurements;
  exported.recorded_inputs = inputs;
  exported.mode_names = {"ice", "ice", "ice"};
  exported.use = {0.6, 0.2, 0.1};
  ModeFamily family;
  family.name = "ice";
  family.modes = {0, 1, 2};
  family.uses = exported.use;
  family.use = 0.9;
  exported.families = {family};
  return exported;
}

TEST(ExportedRos2, AFamilyIsOneFileOfMeansByUse) {
  MODEBANK_NEEDS_YAML();
  const auto files = to_ros2(family_of_three(), {1.0, 0.0});
  ASSERT_EQ(files.size(), 1u);
  const auto& [name, text] = files[0];
  EXPECT_EQ(name, "ice.yaml");
  EXPECT_THAT(text, HasSubstr("# ice (modes 0, 1, 2), 90.0 % of the judged samples"));
  EXPECT_THAT(text, HasSubstr("(0 60.0 %, 1 20.0 %, 2 10.0 %)"));
  EXPECT_THAT(text, HasSubstr("of modes 0, 1 alone"));
  const json drive = read_yaml(text).at("diff_drive_controller").at("ros__parameters");
  EXPECT_NEAR(drive.at("wheel_separation_multiplier"), 1.0 / (0.75 / 0.55 + 0.25 / 0.65), 1e-9);
  EXPECT_NEAR(drive.at("left_wheel_radius_multiplier"), Robot().left, 1e-9);
  const json noise = read_yaml(text).at("ekf_filter_node").at("ros__parameters").at("process_noise_covariance");
  EXPECT_NEAR(noise[11 * 15 + 11].get<double>() * Robot().dt_s, (0.7 * 4e-4 + 0.2 * 8e-4) / 0.9, 1e-12);
  EXPECT_THAT(text, HasSubstr(", its modes 0.008 to 0.016"));  // each value is Q / dt_s
}

/// Both modes have precise widths, so the standard error comes only from their difference. For 1 / width it is (1 /
/// 0.55 - 1 / 0.65) sqrt(0.75 0.25) per metre. For the width it is 0.5722^2 times this number.
TEST(ExportedRos2, TheErrorOfAFamilyHoldsHowFarItsModesAreApart) {
  ExportedBank exported = family_of_three();
  for (Mode& mode : exported.bank.modes) mode.standard_error.setConstant(1e-9);
  exported.families[0].modes = {0, 1};
  exported.families[0].uses = {0.6, 0.2};
  const std::string text = to_ros2(exported, {1.0, 0.0}).at(0).second;
  EXPECT_THAT(text, HasSubstr("# +- 0.04 of wheel_separation = 1 m\n"));
}

TEST(ExportedRos2, HoldsHostileNames) {
  MODEBANK_NEEDS_YAML();
  ExportedBank exported = bank_of(Robot(), true);
  for (const std::string& name : hostile_names()) {
    exported.archive = exported.mode_names[0] = exported.provenance.modebank_version = name;
    const auto files = to_ros2(exported, {0.5, 0.0});
    EXPECT_THAT(files[0].first, Not(HasSubstr("/")));
    const json file = read_yaml(files[0].second);
    ASSERT_TRUE(file.is_object()) << name;
    EXPECT_EQ(file.size(), 3u) << name;
  }
}

}  // namespace
}  // namespace modebank::app::test
