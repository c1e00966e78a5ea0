// robot_loop ARCHIVE [SECONDS]: a control loop at 1 kHz that steps a bank.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <modebank/archive/load_bank.hpp>
#include <modebank/base/eigen.hpp>
#include <modebank/filter/bank_filter.hpp>
#include <thread>
#include <vector>

#include "other_eigen.hpp"

int main(int argc, char** argv) try {
  if (argc < 2) return std::fprintf(stderr, "usage: robot_loop ARCHIVE [SECONDS]\n"), 2;
  const modebank::filter::Bank bank = modebank::archive::load_bank(argv[1]);
  modebank::filter::BankFilter filter(bank);  // this loop is faster than the bank, so each sample is one step

  const int ticks = 1000 * (argc > 2 ? std::atoi(argv[2]) : 1);
  Eigen::VectorXd input(bank.inputs()), measurement(bank.measurements());
  const auto begin = std::chrono::steady_clock::now();
  std::chrono::nanoseconds worst{0};
  for (int tick = 0; tick < ticks; ++tick) {
    std::this_thread::sleep_until(begin + std::chrono::milliseconds(tick));
    const double time_s = 1e-3 * tick;
    input.setConstant(0.2 * std::sin(time_s));        // your robot's commands
    measurement.setConstant(0.1 * std::cos(time_s));  // its gyro's measurement
    const auto before = std::chrono::steady_clock::now();
    const modebank::filter::Estimate& estimate = filter.step(time_s, input, measurement);
    worst = std::max<std::chrono::nanoseconds>(worst, std::chrono::steady_clock::now() - before);
    if (!std::isfinite(estimate.state[0])) return std::fprintf(stderr, "no estimate at tick %d\n", tick), 1;
  }
  const modebank::filter::Estimate& last = filter.estimate();
  const Eigen::MatrixXd covariance = modebank::view(last.covariance);  // as a matrix of your Eigen
  std::printf("%d ticks, %ld modes, state %.6f +- %.6f, most probable mode at %.3f, longest step %.1f us (%.0f)\n",
              ticks, static_cast<long>(bank.modes()), last.state[0], std::sqrt(covariance(0, 0)),
              *std::max_element(last.mode_probability.begin(), last.mode_probability.end()),
              1e-3 * static_cast<double>(worst.count()), other_eigen_sum());
  return 0;
} catch (const std::exception& error) {
  return std::fprintf(stderr, "robot_loop: %s\n", error.what()), 1;
}
