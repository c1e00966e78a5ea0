#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "ident/simulate/simulate.hpp"
#include "ident/simulate/vehicle.hpp"

namespace modebank {

/// Errors of the robot's sensors.
struct SensorOptions {
  double gyro_noise_density = 5e-4;  ///< [rad/s/sqrt(Hz)]; the standard deviation of a sample is this density times
                                     ///< sqrt(rate)
  double gyro_bias = 0.0;            ///< bias at the start of a run [rad/s]
  double gyro_bias_walk = 0.0;       ///< random walk of the bias [rad/s/sqrt(s)]
  double speed_noise_sd = 0.02;  ///< noise of a measured forward or sideways speed, as from satellites or lidar [m/s]
  double wheel_quantum_m_s = 0.005;  ///< quantum of the wheel speeds; 0 means exact speeds
  double lag_s = 0.0;                ///< error of the inputs' stamps; the true time is stamp + lag + drift * stamp
  double drift = 0.0;                ///< drift of the clock [s/s], above -1
};

/// A skid-steer robot (ident/simulate/vehicle.hpp) on a plane of square tiles of ground (ident/simulate/ground.hpp).
struct VehicleSimulationOptions {
  VehicleParameters vehicle;
  std::vector<double> friction{0.06, 0.6};  ///< friction coefficient of each kind of ground, above 0
  std::vector<double> shear_m{0.005};       ///< shear modulus of each kind of ground, or one value for all kinds
  std::vector<double> resistance{0.02};     ///< motion resistance of each kind of ground, or one value for all kinds
  double patch_m = 4.0;  ///< side of a tile; with 0, run i stays on kind (i / 2) mod K. Training runs and held-out runs
                         ///< then both contain every kind
  double forward_speed_m_s = 0.2;  ///< speed [m/s] that is added to every command except standstill
  double turn_scale = 1.0;         ///< factor on the turning part (difference of the wheels) of the commands
  double step_s = 0.0;             ///< integration step; 0 means Vehicle::default_step_s
  SensorOptions sensors;
  CommandOptions commands;  ///< two inputs: left and right set-points [m/s]
  double outlier_fraction = 0.0;
  double outlier_sd = 0.0;
  Index measured = 1;  ///< number of measured signals, 1 to 3; their order is yaw rate, forward speed, sideways speed
  Index runs = 12;
  double dt_s = 1.0 / 6.5;  ///< sample period of commands and wheel speeds
  double state_rate_hz = 65.0;
};

/// One simulated run: N samples of the wheels, and M samples of gyro and truth. The M samples end one gyro period after
/// those of the wheels.
struct VehicleRun {
  std::string run;
  Role role = Role::train;
  Eigen::VectorXd inputs_time_s;  ///< N, stamps by the wheels' clock, which has a lag and a drift
  Eigen::MatrixXd wheel_speed;    ///< 2 x N, left and right as measured [m/s]
  Eigen::MatrixXd command;        ///< 2 x N, set-points that act from this sample on [m/s]
  Eigen::VectorXd time_s;         ///< M, times on the true clock
  Eigen::MatrixXd measured;       ///< `measured` x M: yaw rate [rad/s], forward and sideways speed [m/s]
  Eigen::MatrixXd truth;          ///< 3 x M: true values of yaw rate, forward and sideways speed
  Eigen::MatrixXd true_wheel;     ///< 2 x M, true speeds of the left and right wheels [m/s]
  Eigen::MatrixXd pose;           ///< 3 x M, pose: x, y [m], heading [rad]
  Eigen::VectorXd friction;       ///< M, mean friction coefficient of the four wheels
  Eigen::VectorXi kind;           ///< M, kind of ground under the robot's centre: the true mode
};

/// Simulates runs "00", "01", ... Even runs are training runs, odd runs are held-out runs. A run starts at rest in the
/// middle of a tile. Run i depends on options, seed and i alone, for any number of threads. Throws ConfigurationError
/// for values out of range.
std::vector<VehicleRun> simulate_vehicle(const VehicleSimulationOptions& options, std::uint64_t seed);

}  // namespace modebank
