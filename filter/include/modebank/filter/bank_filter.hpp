#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "modebank/base/matrix.hpp"
#include "modebank/filter/bank.hpp"
#include "modebank/filter/options.hpp"

namespace modebank::filter {

/// Results of a filter for one sample; NaN before the start and for missing measurements.
struct Estimate {
  std::vector<double> prediction;  ///< n, state before the measurement, all modes combined
  std::vector<double> innovation;  ///< n_y, measurement minus prediction
  Matrix innovation_covariance;    ///< n_y x n_y, covariance of the combined prediction
  std::vector<double> state;       ///< n, state after the measurement
  Matrix covariance;               ///< n x n, covariance of the state after the measurement
  std::vector<double> pit;  ///< n_y, probability integral transform (Rosenblatt 1952), uniform if the model is correct.
                            ///< For a rounded signal it is drawn within its interval, by the number of samples so far
  std::vector<double> mode_probability_predicted;  ///< K, mode probabilities before the measurement
  std::vector<double> mode_probability;            ///< K, mode probabilities after the measurement
  double nis = 0.0;                                ///< normalised innovation squared of the available signals
  double log_density = 0.0;                        ///< log density of the measurement under the prediction [nats]
  std::ptrdiff_t steps = 0;  ///< number of model steps since the previous sample; 0 where the filter (re)started
};

/// Prediction of one later sample, all modes combined. State and covariance are NaN before the filter's start.
struct Forecast {
  std::vector<double> state;             ///< n
  Matrix covariance;                     ///< n x n, covariance of the predicted state
  std::vector<double> mode_probability;  ///< K
};

/// Filters one stream with a bank, sample by sample. Different objects may run in different threads.
class BankFilter {
 public:
  /// Throws std::invalid_argument if the bank does not support the options.
  explicit BankFilter(const Bank& bank, const FilterOptions& options = {});
  ~BankFilter();
  /// Moves the filter and its stream.
  BankFilter(BankFilter&&) noexcept;
  /// Moves the filter and its stream.
  BankFilter& operator=(BankFilter&&) noexcept;

  /// Processes the next sample in time order. `time_s`: seconds; NaN means one step after the last sample. `input`: the
  /// inputs() numbers recorded at that time. A non-finite input is replaced by its last known value, which is zero at
  /// first. `measurement`: the measurements() numbers, NaN where missing. The first complete measurement starts the
  /// filter, also after a long gap or a time before the last one; the estimate's `steps` is then 0. Does not allocate.
  const Estimate& step(double time_s, const double* input, const double* measurement);
  /// `step` for any type with data() and size(). Throws std::invalid_argument for other sizes.
  template <class Input, class Measurement>
  const Estimate& step(double time_s, const Input& input, const Measurement& measurement) {
    check_sizes(static_cast<std::ptrdiff_t>(input.size()), static_cast<std::ptrdiff_t>(measurement.size()));
    return step(time_s, static_cast<const double*>(input.data()), static_cast<const double*>(measurement.data()));
  }
  /// The result of the last step.
  const Estimate& estimate() const;
  /// Predicts the next `steps` samples without measurements, one sample period apart, as `judge` scores them. Element 0
  /// is the next sample. Column i of `inputs` (inputs() x c) is the planned input of the sample i + 1 ahead. An input
  /// first acts input_delay samples later, so c = steps - the smallest input_delay columns are enough. Throws
  /// std::invalid_argument for steps below 1 and for missing or non-finite inputs. Allocates.
  std::vector<Forecast> forecast(const Matrix& inputs, std::ptrdiff_t steps) const;
  /// The complete state of the filter as numbers for storage; some are NaN. It does not contain estimate().
  std::vector<double> snapshot() const;
  /// Continues, to the bit, from a snapshot of a filter with the same bank and options. Throws std::invalid_argument
  /// for a snapshot of other sizes and for invalid numbers; the filter is then unchanged.
  void restore(const std::vector<double>& snapshot);
  /// Resets the filter; the next complete measurement starts it again.
  void restart();
  /// Whether the filter has started.
  bool started() const;

 private:
  void check_sizes(std::ptrdiff_t inputs, std::ptrdiff_t measurements) const;
  struct Internal;
  std::unique_ptr<Internal> internal_;
};

}  // namespace modebank::filter
