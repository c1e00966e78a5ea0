// The simulated vehicle, tested with physical laws that its code does not contain.
#include "ident/simulate/vehicle.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "ident/simulate/ground.hpp"

namespace modebank {
namespace {

using At = VehicleState;

constexpr double gravity = 9.80665;

Ground plane(const GroundKind& kind) { return {{kind}, 0.0, 0, 1}; }

const GroundKind grip{0.6, 0.005, 0.0}, ice{0.05, 0.005, 0.0};

double step_for(const VehicleParameters& vehicle, const GroundKind& kind) {
  return Vehicle::default_step_s(vehicle, {kind});
}

VehicleState settle(const VehicleParameters& parameters, const GroundKind& kind, const WheelCommand& command,
                    double duration_s = 5.0) {
  const Ground ground = plane(kind);
  VehicleState state;
  Vehicle(parameters, ground).advance(state, command, duration_s, step_for(parameters, kind));
  return state;
}

double kinetic_energy(const VehicleParameters& p, const VehicleState& s) {
  return 0.5 * p.mass_kg * (s[At::vx] * s[At::vx] + s[At::vy] * s[At::vy]) +
         0.5 * p.yaw_inertia_kg_m2 * s[At::yaw_rate] * s[At::yaw_rate];
}

double effective_track(const VehicleParameters& p, const GroundKind& kind, double forward, double turn) {
  const VehicleState s = settle(p, kind, {forward - turn, forward + turn}, 20.0);
  return (s[At::wheel_right] - s[At::wheel_left]) / s[At::yaw_rate];
}

TEST(TyreForce, IsTheMeanShearStressOverThePatch) {
  const VehicleParameters vehicle;
  const GroundKind kind{0.4, 0.02, 0.0};
  const Eigen::Vector2d velocity(0.3, 0.04);
  const double wheel = 0.5, load = 100.0;
  const Eigen::Vector2d slip(-0.2, 0.04);
  constexpr int parts = 20000;  // integral over the patch by the midpoint rule, element by element
  double stress = 0.0;
  for (int i = 0; i < parts; ++i) {
    const double from_front = (i + 0.5) / parts * vehicle.contact_m;
    const double displacement = slip.norm() * from_front / (wheel + vehicle.slip_speed_m_s);
    stress += kind.friction * (1.0 - std::exp(-displacement / kind.shear_m)) / parts;
  }
  const Eigen::Vector2d expected = -load * stress * slip.normalized();
  EXPECT_LT((tyre_force(velocity, wheel, load, kind, vehicle) - expected).norm(), 1e-7 * load);
}

TEST(TyreForce, NeverExceedsFrictionAndOpposesSlip) {
  const VehicleParameters vehicle;
  for (const double speed : {1e-9, 1e-4, 0.03, 0.5, 20.0})
    for (double angle = 0.0; angle < 6.3; angle += 0.3)
      for (const double wheel : {-1.0, 0.0, 1e-3, 0.7}) {
        const Eigen::Vector2d slip = speed * Eigen::Vector2d(std::cos(angle), std::sin(angle));
        const Eigen::Vector2d force = tyre_force(slip + Eigen::Vector2d(wheel, 0.0), wheel, 150.0, grip, vehicle);
        EXPECT_LE(force.norm(), 0.6 * 150.0);
        EXPECT_NEAR(force.dot(slip), -force.norm() * speed, 1e-7 * force.norm() * speed + 1e-12);
      }
  EXPECT_EQ(tyre_force({0.5, 0.0}, 0.5, 150.0, grip, vehicle).norm(), 0.0);
  EXPECT_GT(tyre_force({20.0, 0.0}, 0.0, 150.0, grip, vehicle).norm(), 0.6 * 150.0 * 0.999) << "sliding is Coulomb's";
}

TEST(Vehicle, DrivenStraightOnGripFollowsItsWheels) {
  const VehicleState state = settle({}, grip, {0.5, 0.5});
  EXPECT_NEAR(state[At::vx], 0.5, 1e-6);
  EXPECT_NEAR(state[At::wheel_left], 0.5, 1e-6);
  EXPECT_EQ(state[At::yaw_rate], 0.0);
  EXPECT_EQ(state[At::vy], 0.0);
}

TEST(Vehicle, MotionResistanceIsPaidWithSlip) {
  GroundKind snow = grip;
  snow.resistance = 0.05;
  const VehicleState state = settle({}, snow, {0.5, 0.5});
  // Small slip: mu N z / 2 = resistance N.
  const double z = 2.0 * 0.05 / 0.6 * (1.0 + 0.05 / 0.6 / 1.5);  // the next term of 1 - (1 - exp(-z)) / z
  const double slip = z * 0.005 * (0.5 + 0.05) / 0.1;
  EXPECT_NEAR(0.5 - state[At::vx], slip, 0.02 * slip);
}

TEST(Vehicle, AccelerationNeverExceedsFriction) {
  const VehicleParameters vehicle;
  const Ground ground = plane(ice);
  const Vehicle robot(vehicle, ground);
  VehicleState state;
  const double step = 1e-3;
  const auto world_velocity = [](const VehicleState& s) {
    const double c = std::cos(s[At::heading]), n = std::sin(s[At::heading]);
    return Eigen::Vector2d(c * s[At::vx] - n * s[At::vy], n * s[At::vx] + c * s[At::vy]);
  };
  double largest = 0.0;
  for (const WheelCommand command : {WheelCommand{1, 1}, {-1, 1}, {1, 0.2}, {0, 0}, {-1, -0.5}})
    for (int i = 0; i < 2000; ++i) {
      const Eigen::Vector2d before = world_velocity(state);
      robot.advance(state, command, step, step_for(vehicle, ice));
      largest = std::max(largest, (world_velocity(state) - before).norm() / step);
    }
  EXPECT_LE(largest, ice.friction * gravity * (1.0 + 1e-9));
  EXPECT_GT(largest, 0.9 * ice.friction * gravity) << "ice is used up";
}

TEST(Vehicle, LockedWheelsStopLikeASlidingBox) {
  VehicleParameters vehicle;
  vehicle.slip_speed_m_s = 0.002;  // a slip near the step of Coulomb friction
  const Ground ground = plane(ice);
  const Vehicle robot(vehicle, ground);
  const double step = step_for(vehicle, ice), speed = 1.0, deceleration = ice.friction * gravity;
  VehicleState state;
  state[At::vx] = 0.6 * speed;
  state[At::vy] = 0.8 * speed;
  double energy = kinetic_energy(vehicle, state);
  constexpr double tick = 0.01;
  for (int i = 1; i <= 300; ++i) {
    robot.advance(state, {}, tick, step);
    EXPECT_LE(kinetic_energy(vehicle, state), energy) << "at " << i * tick << " s";
    energy = kinetic_energy(vehicle, state);
    const double box_speed = std::max(0.0, speed - deceleration * i * tick);
    EXPECT_NEAR(std::hypot(state[At::vx], state[At::vy]), box_speed, 2e-3) << "at " << i * tick << " s";
  }
  const double distance = std::hypot(state[At::x], state[At::y]);
  EXPECT_NEAR(distance, speed * speed / (2.0 * deceleration), 2e-3 * distance);
  EXPECT_LT(energy, 1e-6);
  EXPECT_EQ(state[At::wheel_left], 0.0);
}

// For a robot that turns on the spot, the slip velocities of the four wheels are (w b - v, w a). With equal loads and
// forces along the slip, the yaw moments balance at w = v b / (a^2 + b^2) for any friction law. So the effective track
// is track (1 + (wheelbase / track)^2). For the Husky it is 1.867 times the track; the Husky's driver software uses
// 1.875. The BorealTC runs show 1.03 to 1.05 m on flooring and on ice (with set-points in true m/s).
TEST(Vehicle, EffectiveTrackOnTheSpotIsGeometryWhateverTheFriction) {
  const VehicleParameters husky;
  const double ratio = 1.0 + std::pow(husky.wheelbase_m / husky.track_m, 2);
  for (const GroundKind& kind : {grip, ice})
    for (const double turn : {0.02, 0.1, 0.4})
      EXPECT_NEAR(effective_track(husky, kind, 0.0, turn) / husky.track_m, ratio, 1e-4) << kind.friction << " " << turn;
  EXPECT_NEAR(ratio, 1.875, 0.01);
}

TEST(Vehicle, TurnsLessThanKinematicsAlongTheWayToo) {
  const VehicleParameters husky;
  const double on_grip = effective_track(husky, grip, 0.5, 0.1), on_ice = effective_track(husky, ice, 0.5, 0.1);
  EXPECT_GT(on_grip, husky.track_m);
  EXPECT_NEAR(on_grip, 1.03, 0.05);
  EXPECT_GT(on_ice, husky.track_m);
}

TEST(Vehicle, AnswersSlowlyOnIce) {
  const auto after = [](const GroundKind& kind) {
    return settle({}, kind, {-0.3, 0.3}, 0.25)[At::yaw_rate] / settle({}, kind, {-0.3, 0.3}, 20.0)[At::yaw_rate];
  };
  EXPECT_NEAR(after(grip), 1.0 - std::exp(-0.25 / 0.15), 0.05) << "as the wheels: their time constant is 0.15 s";
  EXPECT_LT(after(ice), 0.6 * after(grip));
}

TEST(Vehicle, MotorsAreLimited) {
  VehicleParameters weak;
  weak.drive_force_N = 20.0;  // on grip, sideways scrub takes about 120 N from each side
  const VehicleState stuck = settle(weak, grip, {-0.5, 0.5}, 5.0);
  EXPECT_LT(stuck[At::wheel_right], 0.1);
  EXPECT_GT(settle(weak, ice, {-0.5, 0.5}, 5.0)[At::wheel_right], 0.45) << "ice takes less than they give";
  // While driving straight, the whole force accelerates mass and wheels.
  const VehicleState pushed = settle(weak, grip, {1.0, 1.0}, 0.5);
  EXPECT_NEAR(pushed[At::wheel_left], 0.5 * 2 * 20.0 / (weak.mass_kg + 2 * weak.drive_mass_kg), 0.01);
}

TEST(Vehicle, LeftAndRightAreMirrorImages) {
  const VehicleParameters vehicle;
  const Ground ground = plane(ice);
  const Vehicle robot(vehicle, ground);
  VehicleState state, mirror;
  const double step = step_for(vehicle, ice);
  for (const WheelCommand command : {WheelCommand{0.8, 0.1}, {-0.3, 0.6}, {0.5, 0.5}}) {
    robot.advance(state, command, 1.0, step);
    robot.advance(mirror, {command.right, command.left}, 1.0, step);
  }
  EXPECT_GT(std::abs(state[At::y]), 0.02);
  for (const At::Entry same : {At::x, At::vx}) EXPECT_NEAR(mirror[same], state[same], 1e-12);
  for (const At::Entry opposite : {At::y, At::heading, At::vy, At::yaw_rate})
    EXPECT_NEAR(mirror[opposite], -state[opposite], 1e-12);
  EXPECT_NEAR(mirror[At::wheel_left], state[At::wheel_right], 1e-12);
}

TEST(Vehicle, MotionDoesNotDependOnHeading) {
  const VehicleParameters vehicle;
  const Ground ground = plane(ice);
  VehicleState state, turned;
  turned[At::heading] = 2.0;
  for (VehicleState* s : {&state, &turned})
    Vehicle(vehicle, ground).advance(*s, {0.2, 0.7}, 3.0, step_for(vehicle, ice));
  EXPECT_NEAR(std::hypot(turned[At::x], turned[At::y]), std::hypot(state[At::x], state[At::y]), 1e-10);
  EXPECT_NEAR(turned[At::yaw_rate], state[At::yaw_rate], 1e-12);
}

/// Largest difference from a reference with much shorter steps, after half a second on ice.
double integration_error(double step, const VehicleState& reference, const Vehicle& robot) {
  VehicleState state;
  state[At::vx] = 0.4;
  state[At::wheel_left] = state[At::wheel_right] = 0.4;
  for (const WheelCommand command : {WheelCommand{0.3, 0.6}, {0.7, 0.2}}) robot.advance(state, command, 0.25, step);
  double error = 0.0;
  for (std::size_t i = 0; i < At::entries; ++i)
    error = std::max(error, std::abs(state.values[i] - reference.values[i]));
  return error;
}

TEST(Vehicle, ConvergesWithTheFourthPowerOfTheStep) {
  const VehicleParameters vehicle;
  const Ground ground = plane(ice);
  const Vehicle robot(vehicle, ground);
  VehicleState reference;
  reference[At::vx] = reference[At::wheel_left] = reference[At::wheel_right] = 0.4;
  for (const WheelCommand command : {WheelCommand{0.3, 0.6}, {0.7, 0.2}})
    robot.advance(reference, command, 0.25, 0.25 / 8192);
  const double coarse = integration_error(0.25 / 32, reference, robot),
               fine = integration_error(0.25 / 64, reference, robot);
  EXPECT_GT(coarse, 1e-12) << "above rounding";
  EXPECT_NEAR(std::log2(coarse / fine), 4.0, 0.5);
  EXPECT_LT(integration_error(step_for(vehicle, ice), reference, robot), 1e-8);
}

TEST(Vehicle, DefaultStepIsStableWhereItIsStiffest) {
  VehicleParameters vehicle;
  vehicle.drive_force_N = 5.0;  // motors at their limit: the tyres determine the wheels' speeds
  const GroundKind stiff{0.9, 0.001, 0.0};
  const Ground ground = plane(stiff);
  const Vehicle robot(vehicle, ground);
  VehicleState state, halved;
  const double step = step_for(vehicle, stiff);
  for (const WheelCommand command : {WheelCommand{1, -1}, {0, 0}, {0.5, 0.5}}) {
    robot.advance(state, command, 0.2, step);
    robot.advance(halved, command, 0.2, step / 2);
    for (std::size_t i = 0; i < At::entries; ++i) EXPECT_NEAR(state.values[i], halved.values[i], 1e-5);
  }
}

TEST(Ground, TilesAreDrawnEvenlyAndStay) {
  const std::vector<GroundKind> kinds{ice, grip, grip};
  const Ground ground(kinds, 2.0, 0, 5), same(kinds, 2.0, 0, 5), other(kinds, 2.0, 0, 6);
  std::vector<double> counts(3, 0.0);
  int different = 0;
  constexpr int side = 100;
  for (int i = -side / 2; i < side / 2; ++i)
    for (int j = -side / 2; j < side / 2; ++j) {
      const int kind = ground.kind_at(2.0 * i + 0.1, 2.0 * j + 0.1);
      EXPECT_EQ(ground.kind_at(2.0 * i + 1.9, 2.0 * j + 1.9), kind) << "one kind per tile";
      EXPECT_EQ(same.kind_at(2.0 * i + 1.0, 2.0 * j + 1.0), kind);
      different += other.kind_at(2.0 * i + 1.0, 2.0 * j + 1.0) != kind ? 1 : 0;
      counts[static_cast<std::size_t>(kind)] += 1.0;
    }
  const double tiles = side * side, sd = std::sqrt(tiles * 2.0 / 9.0);
  for (const double count : counts) EXPECT_NEAR(count, tiles / 3.0, 4 * sd);
  EXPECT_NEAR(different, tiles * 2.0 / 3.0, 4 * sd);
  EXPECT_EQ(Ground(kinds, 0.0, 1, 5).kind_at(1e3, -1e3), 1);
}

}  // namespace
}  // namespace modebank
