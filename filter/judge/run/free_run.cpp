#include "filter/judge/run/free_run.hpp"

#include <algorithm>
#include <optional>
#include <stdexcept>
#include <utility>

#include "filter/judge/run/free_run_forecasts.hpp"
#include "filter/step/equations/filter_memory.hpp"
#include "filter/step/feed/run_samples.hpp"
#include "filter/step/forecast.hpp"
#include "ident/base/interruption.hpp"
#include "ident/base/not_a_number.hpp"
#include "ident/base/seed.hpp"

namespace modebank {

namespace {

using Eigen::Index;

constexpr double band_level = 0.95;

FreeRun sized_free_run(Index n_y, Index samples) {
  FreeRun result;
  for (Eigen::MatrixXd* values : {&result.mean, &result.deviation, &result.lower, &result.upper, &result.pit})
    values->setConstant(n_y, samples, not_a_number);
  result.log_density.setConstant(samples, not_a_number);
  result.mode.setConstant(samples, -1);
  return result;
}

/// Samples [first, end) of a run between gaps at which filters restart.
struct SampleRange {
  Index first = 0, end = 0;
};

std::vector<SampleRange> stretches_of(const Trajectory& run, double dt_s) {
  std::vector<SampleRange> stretches;
  for (Index k = 0; k < run.samples(); ++k) {
    const bool gap =
        k > 0 && SampleFeed::steps_between(sample_time_s(run, k - 1), sample_time_s(run, k), dt_s) > longest_gap_steps;
    if (k == 0 || gap) stretches.push_back({k, k});
    stretches.back().end = k + 1;
  }
  return stretches;
}

/// A run, the samples that a free run may use, and the start of the free run.
class Given {
 public:
  Given(const Bank& bank, const Trajectory& run, const FreeRunOptions& options)
      : options_(options), run_(run), stretches_(stretches_of(run, bank.dt_s)) {
    const Index fewest = fewest_start_samples(bank.structure);
    if (options.samples < fewest)
      throw std::invalid_argument("a free run of this model starts from at least " + std::to_string(fewest) +
                                  " measured samples, not " + std::to_string(options.samples));
    if (options.start == FreeRunStart::fixed) see_only_the_last(bank.structure.state_lags);
    instants_.emplace(bank, run_);
  }

  const Trajectory& run() const { return run_; }
  const RunInstants& instants() const { return *instants_; }

  /// Calls from(first, last, end) for every stretch that can be predicted. `first` to `last` are the moments from the
  /// filter's start to the last measured sample. `end` is the end of the predictions. Records the reason for stretches
  /// that cannot be predicted.
  template <class From>
  void for_each(FreeRun& out, From from) const {
    for (const SampleRange& stretch : stretches_) {
      const Index last = stretch.first + options_.samples - 1;
      const std::string where = stretches_.size() > 1 ? " from sample " + std::to_string(stretch.first) + " on" : "";
      if (last + 1 >= stretch.end) {
        out.notes.push_back("has " + std::to_string(stretch.end - stretch.first) + " samples" + where + ", of which " +
                            std::to_string(options_.samples) + " are used as measured: no sample is left to predict");
        continue;
      }
      const auto [t_first, t_last] = moments(stretch.first, last);
      if (t_first < 0) {
        out.notes.push_back("has too few complete measurements among its first " + std::to_string(options_.samples) +
                            " samples" + where + " for a filter to start");
        continue;
      }
      const bool to_end = options_.horizon == 0;
      from(t_first, t_last, to_end ? stretch.end : std::min(stretch.end, last + 1 + options_.horizon));
    }
  }

 private:
  const FreeRunOptions& options_;
  Trajectory run_;
  std::vector<SampleRange> stretches_;
  std::optional<RunInstants> instants_;

  void see_only_the_last(Index lags) {
    for (const SampleRange& stretch : stretches_) {
      const Index unseen = std::min(options_.samples - lags, stretch.end - stretch.first);
      run_.state.middleCols(stretch.first, unseen).setConstant(not_a_number);
    }
  }

  /// The moments of the filter's start and of sample `last`; -1 without a start between them.
  std::pair<Index, Index> moments(Index first, Index last) const {
    Index start = -1;
    for (Index t = 0; t < instants_->count(); ++t) {
      const Instant& instant = instants_->instants[static_cast<std::size_t>(t)];
      if (instant.starts && instant.sample >= first && instant.sample <= last) start = t;
      if (instant.sample == last) return {start, t};
    }
    return {-1, -1};
  }
};

/// Stores the prediction of sample k; `forecast` has been advanced to k.
void record(const Forecast& forecast, const Eigen::VectorXd& mean, Index k, FreeRun& out) {
  out.mean.col(k) = mean;
  out.deviation.col(k) = forecast.standard_deviation();
  forecast.mode_probability().maxCoeff(&out.mode(k));
  for (Index i = 0; i < mean.size(); ++i) {
    out.lower(i, k) = forecast.quantile(i, 0.5 * (1.0 - band_level));
    out.upper(i, k) = forecast.quantile(i, 0.5 * (1.0 + band_level));
  }
}

/// Predicts from the filter's moment t to the sample before `end`.
void predict_on(Forecast& forecast, const Given& given, Index t, Index end, FreeRun& out) {
  look_ahead(forecast, given.instants(), t, [&](Index ahead, Index k) {
    interruption_point();
    if (k >= end) return false;
    forecast.arrive(ahead);
    const Eigen::VectorXd mean = forecast.mean();
    if (!mean.allFinite()) {
      out.notes.push_back("is predicted up to sample " + std::to_string(k - 1) + "; later predictions are not finite");
      return false;
    }
    record(forecast, mean, k, out);
    const auto y = given.run().state.col(k);
    if (missing_entries(y) > 0) return true;
    for (Index i = 0; i < mean.size(); ++i) out.pit(i, k) = forecast.probability(i, y(i));
    out.log_density(k) = forecast.log_density(y);
    return true;
  });
}

/// Filters the samples before each start of a free run, then calls from(state, t, end).
template <int N, int NY, class From>
void from_each_start(const FilterModel<N, NY>& model, const Given& given, FreeRun& out, From from) {
  FilterStep<N, NY> step(model);
  FilterState<N> state = initial_state(model);
  given.for_each(out, [&](Index first, Index last, Index end) {
    for (Index t = first; t <= last; ++t) {
      interruption_point();
      step_to(model, given.instants(), t, given.run(), state, step);
    }
    from(state, last, end);
  });
}

void predict_with_running_noise(const Bank& bank, const Given& given, FreeRun& out) {
  DriftingRecursion recursion(bank);
  DriftingFreeForecast forecast(bank);
  given.for_each(out, [&](Index first, Index last, Index end) {
    for (Index t = first; t <= last; ++t) follow(given.instants(), t, given.run(), recursion);
    forecast.start(recursion);
    predict_on(forecast, given, last, end, out);
  });
}

}  // namespace

FreeRun free_run(const Bank& bank, const Trajectory& run, const FilterOptions& filter, const FreeRunOptions& options) {
  check_run(bank, run);
  const Given given(bank, run, options);
  FreeRun out = sized_free_run(bank.C.rows(), run.samples());
  if (!bank.running_noise.empty()) {
    predict_with_running_noise(bank, given, out);
    return out;
  }
  if (options.method == FreeRunMethod::paths) {
    const FilterModel<Eigen::Dynamic, Eigen::Dynamic> model(bank, filter);
    FilterMemory memory;
    PathForecast forecast(bank, options.paths, derive_seed(options.seed, "free run " + run.run));
    from_each_start(model, given, out, [&](const FilterState<Eigen::Dynamic>& state, Index t, Index end) {
      save(state, memory);
      forecast.start(memory);
      predict_on(forecast, given, t, end, out);
      out.lost_paths += forecast.lost();
    });
    return out;
  }
  with_sizes(bank.structure.dimension(), bank.C.rows(), [&]<int N, int NY>() {
    const FilterModel<N, NY> model(bank, filter);
    MomentForecast<N, NY> forecast(model);
    from_each_start(model, given, out, [&](const FilterState<N>& state, Index t, Index end) {
      forecast.start(state);
      predict_on(forecast, given, t, end, out);
    });
  });
  return out;
}

}  // namespace modebank
