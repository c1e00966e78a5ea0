#include "ident/simulate/vehicle.hpp"

#include <algorithm>
#include <boost/numeric/odeint/algebra/array_algebra.hpp>
#include <boost/numeric/odeint/stepper/runge_kutta4.hpp>
#include <cmath>
#include <cstdint>

namespace modebank {

namespace {

constexpr double gravity_m_s2 = 9.80665;
constexpr std::size_t wheel_count = 4;  // order of the wheels: front left, rear left, front right, rear right

using VehicleValues = decltype(VehicleState::values);
using Kinds = std::array<int, wheel_count>;
using At = VehicleState;

bool is_left(std::size_t wheel) { return wheel < 2; }

/// Position of a wheel in the body frame.
Eigen::Vector2d wheel_position(const VehicleParameters& p, std::size_t wheel) {
  return {(wheel % 2 == 0 ? 0.5 : -0.5) * p.wheelbase_m, (is_left(wheel) ? 0.5 : -0.5) * p.track_m};
}

/// (1 - (1 - exp(-z)) / z) / z; 1/2 at zero.
double mobilised_share_over_z(double z) {
  constexpr double series_below = 1e-3;  // the first neglected term is z^3 / 120
  if (z < series_below) return 0.5 - z / 6.0 + z * z / 24.0;
  return (1.0 + std::expm1(-z) / z) / z;
}

Kinds kinds_under(const VehicleParameters& p, const Ground& ground, const VehicleState& state) {
  const double c = std::cos(state[At::heading]), s = std::sin(state[At::heading]);
  Kinds kinds{};
  for (std::size_t i = 0; i < wheel_count; ++i) {
    const Eigen::Vector2d r = wheel_position(p, i);
    kinds[i] = ground.kind_at(state[At::x] + c * r.x() - s * r.y(), state[At::y] + s * r.x() + c * r.y());
  }
  return kinds;
}

/// Sums over the tyres: the forces on the body, the yaw moment, and the load of each side's tyres on its motor.
struct TyreSum {
  Eigen::Vector2d force = Eigen::Vector2d::Zero();
  double moment = 0.0, left_drive = 0.0, right_drive = 0.0;
};

TyreSum sum_tyres(const VehicleParameters& p, const Ground& ground, const Kinds& kinds, const VehicleValues& v) {
  const double load_N = p.mass_kg * gravity_m_s2 / static_cast<double>(wheel_count);
  TyreSum sum;
  for (std::size_t i = 0; i < wheel_count; ++i) {
    const Eigen::Vector2d r = wheel_position(p, i);
    const Eigen::Vector2d velocity{v[At::vx] - v[At::yaw_rate] * r.y(), v[At::vy] + v[At::yaw_rate] * r.x()};
    const GroundKind& kind = ground[kinds[i]];
    Eigen::Vector2d force = tyre_force(velocity, v[is_left(i) ? At::wheel_left : At::wheel_right], load_N, kind, p);
    (is_left(i) ? sum.left_drive : sum.right_drive) += force.x();
    force.x() -= kind.resistance * load_N * std::tanh(velocity.x() / p.slip_speed_m_s);
    sum.force += force;
    sum.moment += r.x() * force.y() - r.y() * force.x();
  }
  return sum;
}

double wheel_acceleration(const VehicleParameters& p, double command, double speed, double tyres_N) {
  const double wanted_N = p.drive_mass_kg * (command - speed) / p.drive_time_s + tyres_N;
  return (std::clamp(wanted_N, -p.drive_force_N, p.drive_force_N) - tyres_N) / p.drive_mass_kg;
}

}  // namespace

Eigen::Vector2d tyre_force(const Eigen::Vector2d& patch_velocity, double wheel_speed, double load_N,
                           const GroundKind& ground, const VehicleParameters& vehicle) {
  const Eigen::Vector2d slip{patch_velocity.x() - wheel_speed, patch_velocity.y()};
  const double z_per_speed = vehicle.contact_m / (ground.shear_m * (std::abs(wheel_speed) + vehicle.slip_speed_m_s));
  const double z = z_per_speed * slip.norm();
  return -ground.friction * load_N * z_per_speed * mobilised_share_over_z(z) * slip;
}

void Vehicle::advance(VehicleState& state, const WheelCommand& command, double duration_s, double step_s) const {
  if (!(duration_s > 0.0)) return;
  const VehicleParameters& p = parameters_;
  const auto steps = static_cast<std::int64_t>(std::ceil(duration_s / step_s));
  const double h = duration_s / static_cast<double>(steps);
  boost::numeric::odeint::runge_kutta4<VehicleValues> stepper;
  for (std::int64_t i = 0; i < steps; ++i) {
    const Kinds kinds = kinds_under(p, ground_, state);
    const auto derivative = [&](const VehicleValues& v, VehicleValues& rate, double /*time*/) {
      const TyreSum tyres = sum_tyres(p, ground_, kinds, v);
      const double c = std::cos(v[At::heading]), s = std::sin(v[At::heading]);
      rate[At::x] = c * v[At::vx] - s * v[At::vy];
      rate[At::y] = s * v[At::vx] + c * v[At::vy];
      rate[At::heading] = v[At::yaw_rate];
      rate[At::vx] = tyres.force.x() / p.mass_kg + v[At::vy] * v[At::yaw_rate];
      rate[At::vy] = tyres.force.y() / p.mass_kg - v[At::vx] * v[At::yaw_rate];
      rate[At::yaw_rate] = tyres.moment / p.yaw_inertia_kg_m2;
      rate[At::wheel_left] = wheel_acceleration(p, command.left, v[At::wheel_left], tyres.left_drive);
      rate[At::wheel_right] = wheel_acceleration(p, command.right, v[At::wheel_right], tyres.right_drive);
    };
    stepper.do_step(derivative, state.values, 0.0, h);
  }
}

double Vehicle::default_step_s(const VehicleParameters& p, const std::vector<GroundKind>& kinds) {
  double stiffest_N_s_m = 0.0;  // sum over the four tyres, without slip and with wheels at rest
  for (const GroundKind& kind : kinds) {
    const double shear = kind.friction * 0.5 * p.contact_m / kind.shear_m, resistance = kind.resistance;
    stiffest_N_s_m = std::max(stiffest_N_s_m, p.mass_kg * gravity_m_s2 * (shear + resistance) / p.slip_speed_m_s);
  }
  const double arm_squared = 0.25 * (p.track_m * p.track_m + p.wheelbase_m * p.wheelbase_m);
  const double rate = stiffest_N_s_m * (1.0 / p.mass_kg + arm_squared / p.yaw_inertia_kg_m2 + 0.5 / p.drive_mass_kg) +
                      1.0 / p.drive_time_s;
  return 2.0 / rate;
}

double Vehicle::mean_friction(const VehicleState& state) const {
  double sum = 0.0;
  for (const int kind : kinds_under(parameters_, ground_, state)) sum += ground_[kind].friction;
  return sum / static_cast<double>(wheel_count);
}

}  // namespace modebank
