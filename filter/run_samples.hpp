#pragma once

#include "filter/filter_step.hpp"
#include "filter/sample_feed.hpp"
#include "ident/not_a_number.hpp"
#include "ident/trajectory.hpp"

namespace modebank {

/// Throws std::invalid_argument when the bank's sizes do not fit each other.
void check_bank(const Bank& bank);

/// Throws std::invalid_argument when the sizes of bank and run disagree, DataError for an input that is not finite.
void check_run(const Bank& bank, const Trajectory& run);

/// Of a run that was recorded without times: NaN.
inline double sample_time_s(const Trajectory& run, Eigen::Index k) {
  return run.time_s.size() > 0 ? run.time_s(k) : not_a_number;
}

/// The samples of a run as filters step on them.
class RunSamples {
 public:
  RunSamples(const Bank& bank, const Trajectory& run, TimeSteps time_steps) : run_(run), feed_(bank, time_steps) {}

  /// Calls visit(feed, k, starts) for every sample k from the first start on; `starts`: the filter begins (anew) here.
  template <class Visit>
  void for_each(Visit visit) {
    bool started = false;
    for (Eigen::Index k = 0; k < run_.samples(); ++k) {
      feed_.push(sample_time_s(run_, k), run_.input.col(k), run_.state.col(k));
      started = started && feed_.steps() <= longest_gap_steps;
      const bool starts = !started && feed_.can_start();
      if (started || starts) visit(feed_, k, starts);
      started = started || starts;
    }
  }

 private:
  const Trajectory& run_;
  SampleFeed feed_;
};

/// From the sample before to the prediction of this one, over as many steps as that takes.
template <int N, int NY>
void advance(const FilterModel<N, NY>& model, const SampleFeed& feed, FilterState<N>& state, FilterStep<N, NY>& step) {
  for (Eigen::Index i = 1; i < feed.steps(); ++i) {
    predict(model, state, feed.inputs(), step);
    skip_measurement(step, state);
  }
  predict(model, state, feed.inputs(), step);
}

}  // namespace modebank
