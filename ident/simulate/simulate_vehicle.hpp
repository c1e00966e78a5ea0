#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "ident/simulate/simulate.hpp"
#include "ident/simulate/vehicle.hpp"

namespace modebank {

/// What the robot's sensors do to the truth.
struct SensorOptions {
  double gyro_noise_density = 5e-4;  ///< [rad/s/sqrt(Hz)]; a sample's standard deviation is density * sqrt(rate)
  double gyro_bias = 0.0;            ///< at the start of a run [rad/s]
  double gyro_bias_walk = 0.0;       ///< random walk of the bias [rad/s/sqrt(s)]
  double speed_noise_sd = 0.02;      ///< of a measured forward or sideways speed, as from satellites or lidar [m/s]
  double wheel_quantum_m_s = 0.005;  ///< wheel speeds are multiples of this; 0: exact
  double lag_s = 0.0;                ///< true time = stamp + lag + drift * stamp, for the inputs' stamps
  double drift = 0.0;                ///< [s/s], above -1
};

/// A skid-steer robot (ident/simulate/vehicle.hpp) on a plane of square tiles of ground (ident/simulate/ground.hpp).
struct VehicleSimulationOptions {
  VehicleParameters vehicle;
  std::vector<double> friction{0.06, 0.6};  ///< one per kind of ground, each above 0
  std::vector<double> shear_m{0.005};       ///< one per kind, or one for all
  std::vector<double> resistance{0.02};     ///< one per kind, or one for all
  double patch_m = 4.0;  ///< side of a tile; 0: run i stays on kind (i / 2) mod K, so that training and test see all
  double forward_speed_m_s = 0.2;  ///< added to every command that is not standstill
  double turn_scale = 1.0;         ///< factor on the turning part (difference of the wheels) of the commands
  double step_s = 0.0;             ///< integration step; 0: Vehicle::default_step_s
  SensorOptions sensors;
  CommandOptions commands;  ///< two inputs: left and right set-points [m/s]
  double outlier_fraction = 0.0;
  double outlier_sd = 0.0;
  Index measured = 1;  ///< how many of yaw rate, forward and sideways speed are measured, 1 to 3
  Index runs = 12;
  double dt_s = 1.0 / 6.5;  ///< of commands and wheel speeds
  double state_rate_hz = 65.0;
};

/// One simulated run: N samples of the wheels, M of gyro and truth, M covering one gyro period more than the wheels.
struct VehicleRun {
  std::string run;
  Role role = Role::train;
  Eigen::VectorXd inputs_time_s;  ///< N stamps of the wheels' clock, wrong by lag and drift
  Eigen::MatrixXd wheel_speed;    ///< 2 x N, left and right as measured [m/s]
  Eigen::MatrixXd command;        ///< 2 x N, set-points in force from this sample on [m/s]
  Eigen::VectorXd time_s;         ///< M, true time
  Eigen::MatrixXd measured;       ///< `measured` x M: yaw rate [rad/s], forward and sideways speed [m/s]
  Eigen::MatrixXd truth;          ///< 3 x M: the same, true
  Eigen::MatrixXd true_wheel;     ///< 2 x M [m/s]
  Eigen::MatrixXd pose;           ///< 3 x M: x, y [m], heading [rad]
  Eigen::VectorXd friction;       ///< M, mean of the four wheels' coefficients
  Eigen::VectorXi kind;           ///< M, ground under the robot's centre: the true mode
};

/// Runs "00", "01", ..., even ones training runs, odd ones test runs. A run starts at rest in the middle of a tile. Run
/// i depends on options, seed and i alone, whatever the number of threads that simulate. Throws ConfigurationError for
/// values out of range.
std::vector<VehicleRun> simulate_vehicle(const VehicleSimulationOptions& options, std::uint64_t seed);

}  // namespace modebank
