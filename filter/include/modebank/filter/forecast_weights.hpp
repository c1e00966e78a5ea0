#pragma once

#include <cstddef>
#include <vector>

namespace modebank::filter {

/// Weights of several forecasters of one run by their past success: dynamic model averaging (Raftery, Karny & Ettler
/// 2010, Technometrics 52(1), equations 15 and 16). Past log densities are discounted with the paper's factor 0.99 per
/// sample; the starting weights are not, so a run that is too short to separate the forecasters keeps them. Forecasts h
/// samples ahead overlap, so each counts as 1/h of a sample. Use one object per run and horizon.
class ForecastWeights {
 public:
  /// Starts with equal weights. `horizon`: samples ahead, at least 1. Throws std::invalid_argument for a smaller
  /// horizon and for zero forecasters.
  explicit ForecastWeights(std::size_t forecasters, std::ptrdiff_t horizon = 1);
  /// Starts with these weights, whose sum may differ from one. Throws std::invalid_argument for a negative weight.
  ForecastWeights(const std::vector<double>& start, std::ptrdiff_t horizon);

  /// Updates the weights with a measured sample. `log_densities` [nats]: the log density of this sample under each
  /// forecast that was made `horizon` samples earlier. A forecaster without a value (NaN) keeps its weight relative to
  /// the others. Throws std::invalid_argument for a wrong number of values.
  void observe(const std::vector<double>& log_densities);
  /// Weights of the forecasts made now; they sum to one.
  const std::vector<double>& weights() const { return weights_; }
  /// Returns to the starting weights.
  void restart();

  /// Constant weights that maximise the likelihood of these forecasts (stacking: Yao, Vehtari, Simpson & Gelman 2018,
  /// Bayesian Analysis 13(3)). Every weight is at least 0.001. Use them as starting weights of other runs.
  /// `log_densities` [nats]: the same number of values per forecaster, NaN where missing. Without data the weights are
  /// equal.
  static std::vector<double> stacked(const std::vector<std::vector<double>>& log_densities);

  /// Weights of the forecasters that have a value (not NaN), normalised to sum one. The others have weight 0.
  static std::vector<double> spoken_weights(const std::vector<double>& weights,
                                            const std::vector<double>& log_densities);
  /// Log of the mean density, weighted by spoken_weights [nats]. NaN if no forecaster has a value.
  static double mixed_log_density(const std::vector<double>& weights, const std::vector<double>& log_densities);

 private:
  double share_of_a_sample_;
  /// Log weights at the start, discounted log densities, present weights.
  std::vector<double> start_, evidence_, weights_;

  void normalise();
};

}  // namespace modebank::filter
