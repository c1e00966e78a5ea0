// A bank written into the program, stepped with sizes that the compiler knows.
#include <cmath>
#include <cstdio>

#include "filter/fixed_imm.hpp"

int main() {
  modebank::Bank bank;
  bank.structure = {1, 2, false};
  for (const double grip : {1.0, 0.3}) {  // wheels that hold, wheels that slip
    modebank::Mode mode;
    mode.model = {Eigen::MatrixXd::Constant(1, 1, -0.6 * grip), Eigen::RowVector2d(-0.5 * grip, 0.5 * grip),
                  Eigen::VectorXd::Zero(1)};
    mode.Q = Eigen::MatrixXd::Constant(1, 1, 1e-4);
    bank.modes.push_back(mode);
  }
  bank.C = Eigen::MatrixXd::Identity(1, 1);
  bank.R = Eigen::MatrixXd::Constant(1, 1, 1e-6);
  bank.transition = modebank::TransitionMatrix::sticky(2, 0.95);
  bank.initial_probability = Eigen::Vector2d::Constant(0.5);

  using Filter = modebank::Imm<1, 2, 2>;
  Filter filter(bank);
  double yaw_rate = 0.0;
  filter.start(Filter::Measurement(yaw_rate));
  for (int k = 0; k < 200; ++k) {
    const double grip = k < 100 ? 1.0 : 0.3;
    const Eigen::Vector2d wheels(-0.4 * std::sin(0.1 * k), 0.4 * std::sin(0.1 * k));
    yaw_rate += grip * (-0.6 * yaw_rate + 0.5 * (wheels(1) - wheels(0)));
    filter.step(wheels, Filter::Measurement(yaw_rate));
    if (k == 99 || k == 199) std::printf("after %d steps: P(slip) = %.4f\n", k + 1, filter.mode_probability()(1));
    if (k == 99 && filter.mode_probability()(1) > 0.1) return 1;
  }
  return filter.mode_probability()(1) > 0.9 ? 0 : 1;
}
