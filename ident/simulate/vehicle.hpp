#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "ident/simulate/ground.hpp"

namespace modebank {

/// A four-wheeled skid-steer robot. The default geometry and mass are those of a Clearpath Husky A200. The defaults of
/// tyres and drive are plausible values, not measurements.
struct VehicleParameters {
  double mass_kg = 60.0;
  double yaw_inertia_kg_m2 = 7.0;  ///< a uniform box of the robot's size, 0.99 m x 0.67 m, has 7.1
  double track_m = 0.55;           ///< distance between left and right wheels
  double wheelbase_m = 0.512;      ///< distance between front and rear axle
  double contact_m = 0.1;          ///< length of a tyre's contact patch
  double slip_speed_m_s = 0.05;    ///< added to the wheel speed by which slip is divided; see tyre_force
  double drive_mass_kg = 10.0;     ///< inertia of one side's wheels and gears, divided by the wheel radius squared
  double drive_time_s = 0.15;      ///< time constant of the wheel speed loop
  double drive_force_N = 300.0;    ///< largest force of one side's motor at the wheels' rim
};

/// Forces of the ground on one tyre. Inputs: velocity of the contact patch over the ground (body frame: x forward, y
/// left) and speed of the tyre's surface [m/s]. The shear stress over the patch opposes the slip velocity and is p mu
/// (1 - exp(-j / K)) (Janosi & Hanamoto 1961). The shear displacement j grows evenly from the front of the patch, by
/// |v_slip| / |v_wheel| per length (Wong & Chiang 2001, "A general theory for skid steering of tracked vehicles on firm
/// ground", Proc. IMechE D 215; for wheels Yu, Chuy, Collins & Hollis 2010, IEEE T-RO 26). With even pressure p:
///   F = mu N (1 - (1 - exp(-z)) / z),  z = l |v_slip| / (K (|v_wheel| + slip_speed)), never more than mu N.
/// slip_speed is an addition to the theory. It avoids the Coulomb step of a locked wheel, which integrators cannot
/// handle.
Eigen::Vector2d tyre_force(const Eigen::Vector2d& patch_velocity, double wheel_speed, double load_N,
                           const GroundKind& ground, const VehicleParameters& vehicle);

/// Position, heading, velocities in the body frame, and the speed of the tyres' surface on each side [m, rad, s].
struct VehicleState {
  enum Entry { x, y, heading, vx, vy, yaw_rate, wheel_left, wheel_right, entries };
  std::array<double, entries> values{};

  double& operator[](Entry entry) { return values[entry]; }
  double operator[](Entry entry) const { return values[entry]; }
};

/// Set-points of the tyres' surface speeds [m/s].
struct WheelCommand {
  double left = 0.0, right = 0.0;
};

/// A rigid body in the plane: m (vx' - vy w) = sum Fx, m (vy' + vx w) = sum Fy, I w' = sum (x Fy - y Fx). Each of four
/// tyres has a quarter of the weight (no load transfer). Motion resistance acts against each wheel's forward velocity.
/// Both wheels of a side turn together. The wheel loop is of first order, v' = (set-point - v) / drive_time, as long as
/// the motor has enough force. Otherwise the motor's largest force works against tyres and inertia.
class Vehicle {
 public:
  Vehicle(const VehicleParameters& parameters, const Ground& ground) : parameters_(parameters), ground_(ground) {}

  /// Integrates over `duration_s` in equal steps of at most `step_s` by the classical Runge-Kutta method. Within a
  /// step, each wheel stays on the ground on which it is at the start of the step, so that the forces are smooth.
  void advance(VehicleState& state, const WheelCommand& command, double duration_s, double step_s) const;

  /// A step for stable and accurate integration on the stiffest ground. It is computed for tyres without slip on a
  /// standing vehicle: one over the sum of the rates of the linearised lateral, yaw and wheel motion.
  static double default_step_s(const VehicleParameters& parameters, const std::vector<GroundKind>& kinds);
  static constexpr double stability_margin = 1.39;  ///< integration is stable for steps up to this factor times the
                                                    ///< default step

  /// Mean friction coefficient under the four wheels.
  double mean_friction(const VehicleState& state) const;

 private:
  VehicleParameters parameters_;
  const Ground& ground_;
};

}  // namespace modebank
