#pragma once

#include <Eigen/Core>

#include "filter/step/bank_filter.hpp"
#include "filter/step/feed/sample_feed.hpp"

namespace modebank {

/// The part that is common to all filters. It decides whether a filter starts at a sample, makes a step, or waits. It
/// also clears old values of the estimate. A filter derives from this class and provides start() and step(measurement).
/// feed.start() is valid in start(); feed.inputs() and feed.steps() are valid in step().
struct FilterShell {
  FilterEstimate estimate;
  bool started = false;
  SampleFeed feed;
  Eigen::VectorXd initial_probability;

  FilterShell(const Bank& bank);

  void restart();
  /// Clears the prediction, because no prediction was made for this sample.
  void clear_prediction();
  void clear_scores();
  /// Clears all values before a start.
  void wait();
};

/// Processes one sample: BankFilter::step for any filter.
template <class Filter>
const FilterEstimate& take_sample(Filter& filter, double time_s, const Eigen::Ref<const Eigen::VectorXd>& input,
                                  const Eigen::Ref<const Eigen::VectorXd>& measurement) {
  filter.feed.push(time_s, input, measurement);
  if (filter.started && filter.feed.steps() > longest_gap_steps) filter.started = false;
  if (filter.started) {
    filter.step(measurement);
  } else if (filter.feed.can_start()) {
    filter.clear_prediction();
    filter.start();
    filter.started = true;
  } else {
    filter.wait();
  }
  return filter.estimate;
}

}  // namespace modebank
