#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "modebank/base/matrix.hpp"
#include "modebank/filter/bank.hpp"
#include "modebank/filter/options.hpp"

namespace modebank::filter {

/// What a filter says about one sample. Before it has started, and where a measurement is missing, the numbers that
/// there are none of are NaN.
struct Estimate {
  std::vector<double> prediction;                  ///< n, of the state before the measurement, all modes combined
  std::vector<double> innovation;                  ///< n_y, measurement minus prediction
  Matrix innovation_covariance;                    ///< n_y x n_y, of the combined prediction
  std::vector<double> state;                       ///< n, after the measurement
  Matrix covariance;                               ///< n x n, after the measurement
  std::vector<double> pit;                         ///< n_y, probability integral transform (Rosenblatt 1952), uniform
                                                   ///< in a true filter: of a quantised signal drawn uniformly within
                                                   ///< its interval, by the sample's number since construction
  std::vector<double> mode_probability_predicted;  ///< K, before the measurement
  std::vector<double> mode_probability;            ///< K, after the measurement
  double nis = 0.0;                                ///< normalised innovation squared of the signals that are there
  double log_density = 0.0;                        ///< of the measurement as predicted [nats]
  double spread_share = 0.0;                       ///< of the modes' differences in the innovation covariance's trace
  std::ptrdiff_t steps = 0;                        ///< model steps since the sample before; 0: (re)started here
};

/// Prediction of one later sample, all modes combined. Before the filter's start state and covariance are
/// NaN.
struct Forecast {
  std::vector<double> state;             ///< n
  Matrix covariance;                     ///< n x n
  std::vector<double> mode_probability;  ///< K
};

/// A bank at work, sample by sample. One object per stream; different objects may run in different threads.
class BankFilter {
 public:
  /// Throws std::invalid_argument when the bank and the options do not fit each other.
  explicit BankFilter(const Bank& bank, const FilterOptions& options = {});
  ~BankFilter();
  /// Takes over the other's stream.
  BankFilter(BankFilter&&) noexcept;
  /// Takes over the other's stream.
  BankFilter& operator=(BankFilter&&) noexcept;

  /// The next sample in the order of time: its time in seconds (NaN: one step after the last), the input recorded at it
  /// (inputs() numbers; what is not finite is the last known one, at first zero) and the measurement (measurements()
  /// numbers; NaN where missing). The first whole measurement is the start. Allocates nothing.
  const Estimate& step(double time_s, const double* input, const double* measurement);
  /// The same for anything that has data() and size(): std::vector, std::array, Eigen's vectors. Throws
  /// std::invalid_argument for other sizes.
  template <class Input, class Measurement>
  const Estimate& step(double time_s, const Input& input, const Measurement& measurement) {
    check_sizes(static_cast<std::ptrdiff_t>(input.size()), static_cast<std::ptrdiff_t>(measurement.size()));
    return step(time_s, static_cast<const double*>(input.data()), static_cast<const double*>(measurement.data()));
  }
  /// What the last step said.
  const Estimate& estimate() const;
  /// Predictions of the next `steps` samples, element 0 of the next one, each a sample period of the bank after the one
  /// before it and without measurements; the filter stays as it is. Column i of `inputs` (inputs() x c) is the input
  /// planned for the sample i + 1 ahead, as step will be given it. An input first acts input_delay samples later, so
  /// that c = steps - input_delay columns are enough. One step ahead it is the prediction of the next step, further
  /// ahead what `judge` scores at that horizon. Throws std::invalid_argument when steps is below 1, when inputs are
  /// missing and when one is not finite. Allocates.
  std::vector<Forecast> forecast(const Matrix& inputs, std::ptrdiff_t steps) const;
  /// All that the filter remembers, as numbers to keep or to write; some are NaN. estimate() is not among them.
  std::vector<double> snapshot() const;
  /// Goes on from a snapshot of a filter of the same bank and options: later steps give the same bits as that filter's.
  /// Throws std::invalid_argument for a snapshot of another bank and for numbers that are none; the filter is then as
  /// it was.
  void restore(const std::vector<double>& snapshot);
  /// Forgets everything; the next whole measurement is a start.
  void restart();
  /// Whether it has had a start.
  bool started() const;

 private:
  void check_sizes(std::ptrdiff_t inputs, std::ptrdiff_t measurements) const;
  struct Inside;
  std::unique_ptr<Inside> inside_;
};

}  // namespace modebank::filter
