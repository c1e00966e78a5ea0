// A bank as part of the program, stepped with plain arrays of doubles.
#include <array>
#include <cmath>
#include <cstdio>
#include <modebank/modebank.hpp>
#include <vector>

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
    filter.step(k, wheels, std::array{yaw_rate});  // measured now; the wheel speeds act until the next sample
    if (k == 100) slip_while_gripping = filter.estimate().mode_probability[1];
    yaw_rate += grip * (-0.6 * yaw_rate + 0.5 * (wheels[1] - wheels[0]));
  }

  // The yaw rate in five samples if the wheels stop now. The first of these steps still has the present wheel speeds.
  const std::vector<modebank::filter::Forecast> ahead = filter.forecast(modebank::Matrix(2, 4), 5);
  std::printf("in 5 samples: %.3f +- %.3f\n", ahead[4].state[0], std::sqrt(ahead[4].covariance(0, 0)));

  // Survives a restart of the program: another filter of the bank continues from these numbers.
  const std::vector<double> kept = filter.snapshot();
  modebank::filter::BankFilter resumed{modebank::filter::Bank(bank)};
  resumed.restore(kept);
  const std::array still{0.0, 0.0};
  const std::array measured{yaw_rate};
  const bool goes_on = resumed.step(200, still, measured).state == filter.step(200, still, measured).state;

  const double slip = filter.estimate().mode_probability[1];
  std::printf("P(slip) = %.4f while gripping, %.4f while slipping\n", slip_while_gripping, slip);
  return slip_while_gripping < 0.1 && slip > 0.9 && goes_on && other_eigen_sum() == before ? 0 : 1;
}
