#include "ident/simulate/simulate_vehicle.hpp"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "modebank/base/error.hpp"
#include "tests/support/matrix_compare.hpp"

namespace modebank {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using test::near;

constexpr std::uint64_t vehicle_seed = 23;

VehicleSimulationOptions short_runs() {
  VehicleSimulationOptions options;
  options.runs = 2;
  options.commands.samples = 120;
  return options;
}

/// Row i of the true signals at any time, by linear interpolation.
double at(const VehicleRun& run, const MatrixXd& truth, Index i, double time_s) {
  const double position = std::clamp(time_s * 65.0, 0.0, static_cast<double>(run.time_s.size() - 2));
  const Index j = static_cast<Index>(position);
  const double share = position - static_cast<double>(j);
  return (1.0 - share) * truth(i, j) + share * truth(i, j + 1);
}

TEST(SimulateVehicle, RunsDependOnSeedAndIndexOnly) {
  VehicleSimulationOptions options = short_runs();
  options.runs = 3;
  options.commands.samples = 40;
  const auto first = simulate_vehicle(options, vehicle_seed), other = simulate_vehicle(options, vehicle_seed + 1);
  options.runs = 2;
  const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);
  const auto fewer = simulate_vehicle(options, vehicle_seed);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(first[i].measured, fewer[i].measured);
    EXPECT_EQ(first[i].wheel_speed, fewer[i].wheel_speed);
    EXPECT_EQ(first[i].kind, fewer[i].kind);
    EXPECT_NE(first[i].measured, other[i].measured);
  }
  EXPECT_NE(first[0].command, first[1].command);
  EXPECT_EQ(first[1].run, "01");
  EXPECT_EQ(first[1].role, Role::test);
}

TEST(SimulateVehicle, TwoRatesAndQuantisedWheels) {
  VehicleSimulationOptions options = short_runs();
  options.dt_s = 0.1;
  options.state_rate_hz = 100.0;
  options.sensors.wheel_quantum_m_s = 0.01;
  const VehicleRun run = simulate_vehicle(options, vehicle_seed).front();
  EXPECT_TRUE(near(run.inputs_time_s, VectorXd::LinSpaced(120, 0.0, 11.9), 1e-12));
  EXPECT_EQ(run.time_s(0), 0.0);
  EXPECT_NEAR(run.time_s(1), 0.01, 1e-15);
  EXPECT_GE(run.time_s(run.time_s.size() - 1), 11.91 - 1e-9) << "truth covers the last wheel sample";
  const MatrixXd quanta = run.wheel_speed / 0.01;
  EXPECT_TRUE(near(quanta, quanta.array().round(), 1e-9));
  for (Index k = 0; k < 120; ++k)
    for (Index side : {0, 1}) EXPECT_NEAR(run.wheel_speed(side, k), run.true_wheel(side, 10 * k), 0.005 + 1e-9);
  EXPECT_GT(run.wheel_speed.cwiseAbs().maxCoeff(), 0.2);
}

TEST(SimulateVehicle, WheelsFollowCommandsInQuanta) {
  VehicleSimulationOptions options = short_runs();
  options.friction = {0.6};
  options.commands.hold_samples = 40;
  options.commands.input_quantum = 1.0 / 127;
  options.sensors.wheel_quantum_m_s = 0.0;
  const VehicleRun run = simulate_vehicle(options, vehicle_seed).front();
  const MatrixXd quanta = run.command * 127.0;
  EXPECT_TRUE(near(quanta, quanta.array().round(), 1e-9));
  int settled = 0;
  for (Index k = 10; k < 120; ++k) {
    if (!(run.command.middleCols(k - 10, 10).colwise() - run.command.col(k)).isZero(0.0)) continue;
    ++settled;
    EXPECT_TRUE(near(run.wheel_speed.col(k), run.command.col(k), 1e-3)) << "ten samples are ten time constants";
  }
  EXPECT_GT(settled, 20);
}

TEST(SimulateVehicle, ForwardSpeedAndTurnScaleShapeTheCommands) {
  VehicleSimulationOptions options = short_runs();
  options.runs = 1;
  options.commands.samples = 2000;
  options.friction = {0.06};
  options.commands.standstill_fraction = 0.3;
  options.state_rate_hz = 6.5;
  options.forward_speed_m_s = 0.4;
  const VehicleRun run = simulate_vehicle(options, vehicle_seed).front();
  options.turn_scale = 0.0;
  const VehicleRun straight = simulate_vehicle(options, vehicle_seed).front();
  const Eigen::ArrayXd forward = run.command.colwise().mean().transpose().array();
  const Eigen::ArrayXd still = (run.command.colwise().squaredNorm().transpose().array() == 0.0).cast<double>();
  EXPECT_NEAR(still.mean(), 0.3, 4 * std::sqrt(2 * 0.3 * 0.7 / 200));
  EXPECT_NEAR(forward.sum() / (1.0 - still).sum(), 0.4, 0.1);
  EXPECT_EQ(straight.command.row(0), straight.command.row(1));
  EXPECT_TRUE(near(straight.command.row(0), run.command.colwise().mean(), 1e-12)) << "the forward part stays";
  EXPECT_EQ(straight.truth.row(0).cwiseAbs().maxCoeff(), 0.0);
}

TEST(SimulateVehicle, GyroNoiseBiasAndWalkHaveTheirSizes) {
  VehicleSimulationOptions options = short_runs();
  options.runs = 1;
  options.friction = {0.01};  // long steps are accurate enough, because nothing moves
  options.commands.samples = 4000;
  options.commands.standstill_fraction = 1.0;
  options.commands.equal_fraction = 0.0;
  options.sensors = {.gyro_noise_density = 1e-3, .gyro_bias = 0.02, .gyro_bias_walk = 0.0, .speed_noise_sd = 0.05};
  options.measured = 3;
  const VehicleRun run = simulate_vehicle(options, vehicle_seed).front();
  ASSERT_EQ(run.measured.rows(), 3);
  const double count = static_cast<double>(run.time_s.size()), sd = 1e-3 * std::sqrt(65.0);
  const MatrixXd error = run.measured - run.truth;
  EXPECT_NEAR(error.row(0).mean(), 0.02, 4 * sd / std::sqrt(count));
  EXPECT_NEAR(std::sqrt((error.row(0).array() - 0.02).square().mean()), sd, 4 * sd / std::sqrt(2 * count));
  EXPECT_NEAR(std::sqrt(error.bottomRows(2).array().square().mean()), 0.05, 4 * 0.05 / std::sqrt(4 * count));
  options.sensors = {.gyro_noise_density = 0.0, .gyro_bias = 0.02, .gyro_bias_walk = 1e-3};
  const VehicleRun walking = simulate_vehicle(options, vehicle_seed).front();
  const Eigen::ArrayXd bias = (walking.measured - walking.truth).row(0).transpose().array();
  const Index second = 65;
  const Eigen::ArrayXd steps = bias.tail(bias.size() - second) - bias.head(bias.size() - second);
  EXPECT_NEAR(bias(0), 0.02, 1e-15);
  EXPECT_NEAR(std::sqrt(steps.square().mean()), 1e-3, 4 * 1e-3 * std::sqrt(65.0 / count)) << "of increments over 1 s";
}

double mismatch(const VehicleRun& run, double lag_s, double drift) {
  double sum = 0.0;
  for (Index k = 0; k < run.inputs_time_s.size(); k += 3) {
    const double time_s = run.inputs_time_s(k) * (1.0 + drift) + lag_s;
    sum += std::pow(run.wheel_speed(0, k) - at(run, run.true_wheel, 0, time_s), 2);
  }
  return sum;
}

TEST(SimulateVehicle, LagAndDriftAreWhatMatchingTheTruthFinds) {
  VehicleSimulationOptions options = short_runs();
  options.friction = {0.06};
  options.runs = 1;
  options.commands.samples = 1200;
  options.sensors.lag_s = 0.4;
  options.sensors.drift = -0.005;
  const VehicleRun run = simulate_vehicle(options, vehicle_seed).front();
  double best_lag = 0.0, best_drift = 0.0, least = std::numeric_limits<double>::infinity();
  for (int i = -40; i <= 40; ++i)
    for (int j = -40; j <= 40; ++j) {
      const double lag = 0.02 * i, drift = 0.00025 * j, sum = mismatch(run, lag, drift);
      if (sum < least) best_lag = lag, best_drift = drift;
      least = std::min(least, sum);
    }
  EXPECT_NEAR(best_lag, 0.4, 1e-9) << "the grid's point";
  EXPECT_NEAR(best_drift, -0.005, 1e-9);
  EXPECT_LT(std::sqrt(least / 400), 0.004) << "what the quantum of 0.005 m/s and the truth's rate leave";
}

TEST(SimulateVehicle, SensorsLeaveTheDriveAlone) {
  VehicleSimulationOptions options = short_runs();
  const auto plain = simulate_vehicle(options, vehicle_seed);
  options.sensors = {.gyro_noise_density = 0.1,
                     .gyro_bias = 0.1,
                     .gyro_bias_walk = 0.1,
                     .wheel_quantum_m_s = 0.1,
                     .lag_s = 0.3,
                     .drift = 0.01};
  options.outlier_fraction = 0.1;
  options.outlier_sd = 1.0;
  options.measured = 2;
  const auto rough = simulate_vehicle(options, vehicle_seed);
  EXPECT_EQ(plain[1].truth, rough[1].truth);
  EXPECT_EQ(plain[1].command, rough[1].command);
  EXPECT_EQ(plain[1].kind, rough[1].kind);
  EXPECT_NE(plain[1].inputs_time_s, rough[1].inputs_time_s);
}

TEST(SimulateVehicle, TruthIsConsistent) {
  VehicleSimulationOptions options = short_runs();
  options.commands.samples = 300;
  options.state_rate_hz = 500.0;
  const VehicleRun run = simulate_vehicle(options, vehicle_seed).front();
  const Index last = run.time_s.size() - 1;
  double heading = run.pose(2, 0), x = run.pose(0, 0);
  for (Index j = 0; j < last; ++j) {
    const auto speed = [&](Index i) {
      return std::cos(run.pose(2, i)) * run.truth(1, i) - std::sin(run.pose(2, i)) * run.truth(2, i);
    };
    heading += 0.5 * (run.truth(0, j) + run.truth(0, j + 1)) / 500.0;  // trapezoidal rule
    x += 0.5 * (speed(j) + speed(j + 1)) / 500.0;
  }
  EXPECT_NEAR(run.pose(2, last), heading, 1e-3);
  EXPECT_NEAR(run.pose(0, last), x, 1e-3);
  EXPECT_EQ(run.pose(0, 0), 2.0) << "the middle of a tile of 4 m";
  EXPECT_GE(run.friction.minCoeff(), 0.06);
  EXPECT_LE(run.friction.maxCoeff(), 0.6);
  EXPECT_GT(run.pose.topRows(2).rowwise().maxCoeff().maxCoeff() - run.pose.topRows(2).minCoeff(), 0.5);
}

TEST(SimulateVehicle, WithoutPatchesEveryFoldSeesEveryGround) {
  VehicleSimulationOptions options = short_runs();
  options.runs = 6;
  options.commands.samples = 10;
  options.patch_m = 0.0;
  options.friction = {0.05, 0.3, 0.8};
  const auto runs = simulate_vehicle(options, vehicle_seed);
  for (std::size_t i = 0; i < runs.size(); ++i) {
    EXPECT_TRUE((runs[i].kind.array() == static_cast<int>(i / 2)).all()) << i;
    EXPECT_TRUE(
        near(runs[i].friction.array(), VectorXd::Constant(runs[i].friction.size(), options.friction[i / 2]), 1e-12));
  }
}

TEST(SimulateVehicle, HalvingTheStepChangesLittle) {
  VehicleSimulationOptions options = short_runs();
  options.runs = 1;
  options.commands.samples = 60;
  options.friction = {0.06};  // a single kind of ground, because the time at which a wheel crosses an edge depends on
                              // the step
  const VehicleRun coarse = simulate_vehicle(options, vehicle_seed).front();
  options.step_s = 0.5 * Vehicle::default_step_s(options.vehicle, {{0.06, 0.005, 0.02}});
  const VehicleRun fine = simulate_vehicle(options, vehicle_seed).front();
  EXPECT_TRUE(near(coarse.truth, fine.truth, 1e-4)) << "wheels that change direction bend the force";
}

TEST(SimulateVehicle, OptionsAreChecked) {
  const auto rejects = [](auto change) {
    VehicleSimulationOptions options = short_runs();
    options.commands.samples = 5;
    change(options);
    EXPECT_THROW(simulate_vehicle(options, vehicle_seed), ConfigurationError);
  };
  using Options = VehicleSimulationOptions;
  rejects([](Options& o) { o.friction = {}; });
  rejects([](Options& o) { o.friction = {0.0}; });
  rejects([](Options& o) { o.shear_m = {0.1, 0.1, 0.1}; });
  rejects([](Options& o) { o.resistance = {-0.1}; });
  rejects([](Options& o) { o.vehicle.mass_kg = 0.0; });
  rejects([](Options& o) { o.vehicle.slip_speed_m_s = 0.0; });
  rejects([](Options& o) { o.sensors.drift = -1.0; });
  rejects([](Options& o) { o.sensors.lag_s = std::nan(""); });
  rejects([](Options& o) { o.measured = 4; });
  rejects([](Options& o) { o.commands.inputs = 3; });
  rejects([](Options& o) { o.runs = 0; });
  rejects([](Options& o) { o.state_rate_hz = 0.0; });
  rejects([](Options& o) { o.step_s = 0.1; });  // an unstable step must be rejected
}

}  // namespace
}  // namespace modebank
