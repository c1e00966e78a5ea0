// combined ARCHIVE: predicts the next sample with the bank and its competitors combined, each weighted by its score so
// far.
#include <cmath>
#include <cstdio>
#include <exception>
#include <modebank/archive/load_bank.hpp>
#include <modebank/filter/bank_filter.hpp>
#include <modebank/filter/forecast_weights.hpp>
#include <string>
#include <vector>

int main(int argc, char** argv) try {
  if (argc < 2) return std::fprintf(stderr, "usage: combined ARCHIVE\n"), 2;
  std::vector<modebank::filter::BankFilter> filters;
  for (const std::string which : {"bank", "baseline", "noise_only", "one_motion"})
    filters.emplace_back(modebank::archive::load_bank(argv[1], which));
  const modebank::filter::Bank bank = modebank::archive::load_bank(argv[1]);

  modebank::filter::ForecastWeights weights(filters.size());
  std::vector<double> said(filters.size()), input(static_cast<std::size_t>(bank.inputs())),
      measurement(static_cast<std::size_t>(bank.measurements()));
  double squares = 0.0;
  constexpr int samples = 200;
  for (int k = 0; k < samples; ++k) {
    const double time_s = bank.dt_s() * k;
    for (double& command : input) command = 0.2 * std::sin(time_s);    // your robot's commands
    for (double& value : measurement) value = 0.1 * std::cos(time_s);  // its gyro's measurement
    double prediction = 0.0;
    for (std::size_t i = 0; i < filters.size(); ++i) {
      const modebank::filter::Estimate& estimate = filters[i].step(time_s, input, measurement);
      said[i] = estimate.log_density;
      prediction += weights.weights()[i] * estimate.prediction[0];  // the prediction before this measurement
    }
    if (k > 0) squares += std::pow(measurement[0] - prediction, 2);
    weights.observe(said);
  }
  double sum = 0.0;
  for (const double weight : weights.weights()) sum += weight;
  std::printf("%d samples predicted, RMSE %.4f, weights of %zu filters sum to %.3f\n", samples - 1,
              std::sqrt(squares / (samples - 1)), filters.size(), sum);
  return 0;
} catch (const std::exception& error) {
  return std::fprintf(stderr, "combined: %s\n", error.what()), 1;
}
