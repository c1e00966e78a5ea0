// A bank written into the program, stepped with what any program has: arrays of doubles.
#include <array>
#include <cmath>
#include <cstdio>
#include <modebank/filter/bank_filter.hpp>

#include "other_eigen.hpp"

int main() {
  modebank::filter::BankDescription bank;
  for (const double grip : {1.0, 0.3}) {  // wheels that hold, wheels that slip
    modebank::filter::Mode mode;
    mode.A = {{-0.6 * grip}};
    mode.B = {{-0.5 * grip, 0.5 * grip}};
    mode.Q = {{1e-4}};
    bank.modes.push_back(mode);
  }
  bank.inputs = 2;
  bank.R = {{1e-6}};
  bank.transition = {{0.95, 0.05}, {0.05, 0.95}};
  modebank::filter::BankFilter filter{modebank::filter::Bank(bank)};

  const double before = other_eigen_sum();
  double yaw_rate = 0.0, slip_while_gripping = 1.0;
  for (int k = 0; k < 200; ++k) {
    const double grip = k < 100 ? 1.0 : 0.3;
    const std::array wheels{-0.4 * std::sin(0.1 * k), 0.4 * std::sin(0.1 * k)};
    filter.step(k, wheels, std::array{yaw_rate});  // measured now; the wheels act until the next sample
    if (k == 100) slip_while_gripping = filter.estimate().mode_probability[1];
    yaw_rate += grip * (-0.6 * yaw_rate + 0.5 * (wheels[1] - wheels[0]));
  }
  const double slip = filter.estimate().mode_probability[1];
  std::printf("P(slip) = %.4f while gripping, %.4f while slipping\n", slip_while_gripping, slip);
  return slip_while_gripping < 0.1 && slip > 0.9 && other_eigen_sum() == before ? 0 : 1;
}
