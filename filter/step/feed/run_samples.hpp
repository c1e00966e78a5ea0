#pragma once

#include <Eigen/Core>
#include <vector>

#include "filter/step/equations/filter_step.hpp"
#include "filter/step/feed/sample_feed.hpp"
#include "ident/base/not_a_number.hpp"
#include "ident/data/trajectory.hpp"

/// A recorded run as filters need it: sample by sample, or moment by moment for random access.
namespace modebank {

/// Throws std::invalid_argument if sizes of the bank do not fit each other, or do not fit the run. Throws DataError for
/// an input that is not finite.
void check_run(const Bank& bank, const Trajectory& run);

/// Time of a sample; NaN for a run without times.
inline double sample_time_s(const Trajectory& run, Eigen::Index k) {
  return run.time_s.size() > 0 ? run.time_s(k) : not_a_number;
}

/// Samples of a run at distances of one model step. Only the first sample may be further from its predecessor.
struct SampleStretch {
  Eigen::Index first = 0;                      ///< index of the first sample in the run
  Eigen::Index steps = 1;                      ///< number of model steps to the first sample
  Eigen::Ref<const Eigen::MatrixXd> inputs;    ///< acting inputs x samples; column k acts on the step to sample k
  Eigen::Ref<const Eigen::MatrixXd> measured;  ///< n_y x samples
};

/// The samples of a run, prepared for a filter.
class RunSamples {
 public:
  RunSamples(const Bank& bank, const Trajectory& run)
      : run_(run), feed_(bank), acting_(bank.structure.acting_inputs(), most_at_once) {}

  /// Calls visit(feed, k, starts) for every sample k from the first start on. `starts`: whether the filter (re)starts
  /// at this sample.
  template <class Visit>
  void for_each(Visit visit) {
    bool started = false;
    for (Eigen::Index k = 0; k < run_.samples(); ++k) {
      feed_.push(sample_time_s(run_, k), run_.input.col(k).data(), run_.state.col(k).data());
      started = started && feed_.steps() <= longest_gap_steps;
      const bool starts = !started && feed_.can_start();
      if (started || starts) visit(feed_, k, starts);
      started = started || starts;
    }
  }

  /// Visits many samples at a time. Calls start(feed) at samples where the filter (re)starts, and follow(stretch) for
  /// the samples between.
  template <class Start, class Follow>
  void for_each_stretch(Start start, Follow follow) {
    Eigen::Index first = 0, count = 0, steps = 1;
    const auto flush = [&] {
      if (count > 0) follow(SampleStretch{first, steps, acting_.leftCols(count), run_.state.middleCols(first, count)});
      count = 0;
    };
    for_each([&](const SampleFeed& feed, Eigen::Index k, bool starts) {
      if (starts || feed.steps() != 1 || count == most_at_once) flush();
      if (starts) return start(feed);
      if (count == 0) {
        first = k;
        steps = feed.steps();
      }
      const double* v = feed.inputs().data();
      double* to = acting_.data() + acting_.rows() * count++;
      for (Eigen::Index i = 0; i < acting_.rows(); ++i) to[i] = v[i];
    });
    flush();
  }

 private:
  static constexpr Eigen::Index most_at_once = 128;
  const Trajectory& run_;
  SampleFeed feed_;
  Eigen::MatrixXd acting_;  ///< acting inputs of the present stretch
};

/// One moment of a filtered run: a sample, or a model step between two distant samples.
struct Instant {
  Eigen::Index sample = -1;    ///< index of the sample; -1 between samples
  bool starts = false;         ///< whether the filter (re)starts here
  Eigen::VectorXd start = {};  ///< measurements for the start; empty at other moments
};

/// All moments of a run with the acting inputs, in the filter's order.
struct RunInstants {
  std::vector<Instant> instants;
  Eigen::MatrixXd inputs;  ///< m x instants; column t acts on the step to moment t

  RunInstants(const Bank& bank, const Trajectory& run) {
    std::vector<Eigen::VectorXd> acting;
    RunSamples(bank, run).for_each([&](const SampleFeed& feed, Eigen::Index k, bool starts) {
      for (Eigen::Index i = 1; !starts && i < feed.steps(); ++i) add({}, feed.inputs(), acting);
      add({k, starts, starts ? Eigen::VectorXd(feed.start()) : Eigen::VectorXd()}, feed.inputs(), acting);
    });
    inputs.resize(bank.structure.acting_inputs(), std::ssize(acting));
    for (std::size_t t = 0; t < acting.size(); ++t) inputs.col(static_cast<Eigen::Index>(t)) = acting[t];
  }

  Eigen::Index count() const { return std::ssize(instants); }
  /// Whether the moment after t belongs to the same stretch.
  bool continues(Eigen::Index t) const { return t + 1 < count() && !instants[static_cast<std::size_t>(t + 1)].starts; }

 private:
  void add(const Instant& instant, const Eigen::VectorXd& v, std::vector<Eigen::VectorXd>& acting) {
    instants.push_back(instant);
    acting.push_back(v);
  }
};

/// Advances `state` from the previous moment to moment t of a run. Returns false if no signal was measured at t.
template <int N, int NY>
bool step_to(const FilterModel<N, NY>& model, const RunInstants& run, Eigen::Index t, const Trajectory& trajectory,
             FilterState<N>& state, FilterStep<N, NY>& step) {
  const Instant& instant = run.instants[static_cast<std::size_t>(t)];
  if (instant.starts) {
    start(model, instant.start, state);
    return true;
  }
  predict(model, state, run.inputs.col(t), step);
  if (instant.sample < 0) {
    skip_measurement(step, state);
    return false;
  }
  const auto y = trajectory.state.col(instant.sample);
  update(model, y, step, state);
  return step.partial.missing < y.size();
}

}  // namespace modebank
