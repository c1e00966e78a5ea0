#pragma once

#include <cstddef>
#include <vector>

namespace modebank::filter {

/// How much each of several forecasters of one run counts, by how well each has predicted it so far: dynamic model
/// averaging (Raftery, Karny & Ettler 2010, Technometrics 52(1), equations 15 and 16). Log densities are forgotten with
/// their factor 0.99 per sample. The weights at the start are not: they come from other runs, and a run too short to
/// tell forecasters apart keeps them. Forecasts h samples ahead overlap, so that h of them hold what one does: each
/// counts as 1/h of a sample. One object per run and horizon.
class ForecastWeights {
 public:
  /// Starts with equal weights. `horizon`: samples ahead, at least 1, else std::invalid_argument, as without
  /// forecasters.
  explicit ForecastWeights(std::size_t forecasters, std::ptrdiff_t horizon = 1);
  /// Starts with these weights, those of other runs, say; none is negative and they need not sum to one, else
  /// std::invalid_argument.
  ForecastWeights(const std::vector<double>& start, std::ptrdiff_t horizon);

  /// A sample was measured: `log_densities` [nats] are those that the forecasts made `horizon` samples before had given
  /// it. One that said nothing (NaN) keeps its weight against the others'. Throws std::invalid_argument for another
  /// number of them.
  void observe(const std::vector<double>& log_densities);
  /// Of the forecasts made now; they sum to one.
  const std::vector<double>& weights() const { return weights_; }
  /// The weights at the start again.
  void restart();

  /// The constant weights under which these forecasts were most likely (stacking: Yao, Vehtari, Simpson & Gelman 2018,
  /// Bayesian Analysis 13(3)), none below 0.001: the weights to start other runs with. `log_densities` [nats]: of each
  /// forecaster as many, NaN where one has none. Equal weights without any.
  static std::vector<double> stacked(const std::vector<std::vector<double>>& log_densities);

  /// Weights of those that said something (not NaN), made to sum to one; 0 for the others, and for all without any.
  static std::vector<double> spoken_weights(const std::vector<double>& weights,
                                            const std::vector<double>& log_densities);
  /// Log of the weighted mean of densities [nats] by spoken_weights; NaN without any.
  static double mixed_log_density(const std::vector<double>& weights, const std::vector<double>& log_densities);

 private:
  double share_of_a_sample_;
  std::vector<double> start_, evidence_, weights_;  ///< logs at the start, log densities so far, and weights now

  void normalise();
};

}  // namespace modebank::filter
