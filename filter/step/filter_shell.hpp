#pragma once

#include <Eigen/Core>

#include "filter/step/bank_filter.hpp"
#include "filter/step/feed/sample_feed.hpp"

namespace modebank {

/// What every filter has around its recursion: which samples are a start, a step or waited for, and an estimate in
/// which nothing stands that was not said. A filter derives from it and has start(), with feed.start() known, and
/// step(measurement), with feed.inputs() and feed.steps().
struct FilterShell {
  FilterEstimate estimate;
  bool started = false;
  SampleFeed feed;
  Eigen::VectorXd initial_probability;

  FilterShell(const Bank& bank);

  void restart();
  /// Nothing was said of this sample before it came.
  void clear_prediction();
  void clear_scores();
  /// Before a start nothing is known at all.
  void wait();
};

/// Takes in one sample: BankFilter::step for any filter.
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
