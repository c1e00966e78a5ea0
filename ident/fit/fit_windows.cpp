#include "ident/fit/fit_windows.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include "ident/base/interruption.hpp"
#include "ident/base/not_a_number.hpp"
#include "ident/base/seed.hpp"
#include "ident/base/work_counter.hpp"
#include "ident/fit/detail/batch/windows.hpp"
#include "ident/fit/global_model.hpp"
#include "ident/fit/prior.hpp"
#include "ident/fit/window_fitter.hpp"
#include "modebank/base/error.hpp"

namespace modebank {

namespace {

void check_options(const FitOptions& options, Index parameters) {
  const auto require = [](bool ok, const std::string& name, const std::string& value, const std::string& range) {
    if (!ok) throw ConfigurationError(name + " = " + value + " is out of range: " + range);
  };
  require(options.length >= 1, "length", std::to_string(options.length), "at least 1");
  require(options.step >= 1, "step", std::to_string(options.step), "at least 1");
  require(options.loss_scale >= 0.0 && std::isfinite(options.loss_scale), "loss_scale",
          std::to_string(options.loss_scale), "positive, or 0 for the default");
  require(options.state_lags >= 1, "state_lags", std::to_string(options.state_lags), "at least 1");
  require(options.input_lags >= 1, "input_lags", std::to_string(options.input_lags), "at least 1");
  const Index earliest = options.input_delay.earliest();
  require(earliest >= 0, "input_delay", std::to_string(earliest), "at least 0");
  require(options.max_iterations >= 1, "max_iterations", std::to_string(options.max_iterations), "at least 1");
  require(options.sigma >= 0.0 && std::isfinite(options.sigma), "sigma", std::to_string(options.sigma),
          "positive, or 0 for the scale of each window");
  const std::vector<double>& sd = options.prior_sd;
  require(sd.size() <= 1 || std::ssize(sd) == parameters, "prior_sd", std::to_string(sd.size()) + " values",
          "one value, or one per parameter (" + std::to_string(parameters) + ")");
  for (const double value : sd)
    require(value > 0.0 && std::isfinite(value), "prior_sd", std::to_string(value), "positive");
}

/// Number of windows that stream_windows passes to `sink` per call.
constexpr Index streamed_windows = 65536;
/// Largest number of windows for the default prior. The windows are drawn in blocks.
constexpr Index prior_windows = 200000;
constexpr Index prior_block = 64;

/// The ranges of windows for the default prior.
std::vector<WindowPlan::Range> prior_ranges(const WindowPlan& plan, Index longest, std::uint64_t seed) {
  const Index M = plan.count(), blocks = prior_windows / prior_block;
  if (M <= prior_windows) return plan.ranges(0, M, longest);
  std::vector<WindowPlan::Range> ranges;
  std::mt19937_64 generator = make_generator(seed, "prior_windows");
  for (Index b = 0; b < blocks; ++b) {
    const Index begin = b * M / blocks, size = (b + 1) * M / blocks - begin;
    const Index offset =
        static_cast<Index>(generator() % static_cast<std::uint64_t>(std::max<Index>(1, size - prior_block + 1)));
    for (const auto& range : plan.ranges(begin + offset, std::min(prior_block, size), prior_block))
      ranges.push_back(range);
  }
  return ranges;
}

/// Each window that Ceres solves is a separate job.
Index longest_range(const BatchWindows* batch) { return batch ? BatchWindows::longest_range : 1; }

/// The linear structure of a model. Also the motion model, if the fit is not a linear regression.
struct ModelChoice {
  LinearStructure structure;
  std::shared_ptr<const MotionModel> motion;  ///< null: linear
};

ModelChoice choose_model(const Recording& recording, const FitOptions& options) {
  const Index states = recording.state_count(), inputs = recording.input_count();
  check_model(options, states, inputs);
  ModelChoice choice{linear_structure(states, inputs, options), motion_model(options, states, inputs)};
  check_options(options, choice.motion ? choice.motion->parameter_count() : choice.structure.parameters());
  return choice;
}

/// Fits all windows of a recording, range by range.
class Fitting {
 public:
  /// `motion` is null for linear models. `motion`, the recording and the options must outlive this object. `first` is
  /// the earliest transition at which a window may begin. Windows begin no earlier than their regressors allow.
  Fitting(const Recording& recording, const FitOptions& options, const LinearStructure& structure,
          const MotionModel* motion, Index first = 0)
      : plan_(recording, options.length, options.step, std::max(first, structure.first_transition())) {
    describe(options, structure, motion);
    common_.global = motion ? fit_global(recording, *motion) : fit_global(recording, structure);
    if (motion) {
      if (options.solver == WindowSolver::batch) throw ConfigurationError("solver = batch fits linear models only");
      fitter_ = std::make_unique<MotionWindows>(recording, options, *motion, common_.global);
    } else {
      auto linear = std::make_unique<LinearWindows>(recording, options, structure, common_.global);
      linear_ = linear.get();
      fitter_ = std::move(linear);
    }
    if (options.prior == Prior::global) {
      common_.prior_sd = make_prior_sd(options, common_.global, [this] { return unregularised_fits(); });
      prior_ = ParameterPrior{common_.global.theta, common_.prior_sd};
    }
    if (linear_) batch_ = BatchWindows::make(*linear_, plan_.count(), prior());
  }
  Fitting(const Fitting&) = delete;  // must not be copied, because `fitter` refers to the global model
  Fitting& operator=(const Fitting&) = delete;

  Index count() const { return plan_.count(); }
  const WindowFits& common() const { return common_; }

  /// Fits windows first .. first + count - 1 into the columns of `fits`.
  void fit(Index first, Index count, WindowFits& fits) {
    if (!counter_) counter_.emplace("windows", static_cast<std::size_t>(plan_.count()));
    fits.resize(count);
    fits.by_batch.assign(static_cast<std::size_t>(count), 0);
    const auto ranges = plan_.ranges(first, count, longest_range(batch_.get()));
    tbb::parallel_for(std::size_t{0}, ranges.size(),
                      [&](std::size_t j) { fit_range(ranges[j], ranges[j].first - first, fits); });
  }

 private:
  const ParameterPrior* prior() const { return prior_ ? &*prior_ : nullptr; }

  /// Fills the fields that the options determine for all windows.
  void describe(const FitOptions& options, const LinearStructure& structure, const MotionModel* motion) {
    if (plan_.count() == 0)
      throw DataError("no training run has the " + std::to_string(options.length) + " transitions of a window");
    common_.model = options.model;
    common_.structure = structure;
    if (motion && !is_linear(options)) common_.model_parameters = motion->parameters();
    common_.length = options.length;
    common_.step = options.step;
    common_.loss = options.loss;
  }

  /// theta of windows fitted without a prior, one column per window; NaN for rank-deficient windows.
  Eigen::MatrixXd unregularised_fits() {
    const auto batch = linear_ ? BatchWindows::make(*linear_, plan_.count(), nullptr) : nullptr;
    const auto ranges = prior_ranges(plan_, longest_range(batch.get()), fitter_->options().seed);
    std::vector<Index> column{0};
    for (const auto& range : ranges) column.push_back(column.back() + range.count);
    Eigen::MatrixXd all(common_.global.theta.size(), column.back());
    const auto fit_range = [&](std::size_t j) {
      interruption_point();
      const std::vector<batch::Verdict>* verdict = nullptr;
      if (batch) verdict = &batch->solve(ranges[j], {.theta = all.col(column[j]).data()});
      for (Index i = 0; i < ranges[j].count; ++i) {
        const auto v = verdict ? (*verdict)[static_cast<std::size_t>(i)] : batch::Verdict::failed;
        if (v == batch::Verdict::solved) continue;
        if (v == batch::Verdict::rank_deficient)
          all.col(column[j] + i).setConstant(not_a_number);
        else
          all.col(column[j] + i) = fitter_->unregularised_theta(plan_.window(ranges[j].first + i));
      }
    };
    tbb::parallel_for(std::size_t{0}, ranges.size(), fit_range);
    return all;
  }

  void fit_range(const WindowPlan::Range& range, Index column, WindowFits& fits) {
    interruption_point();
    counter_->add(static_cast<std::size_t>(range.count));
    const std::vector<batch::Verdict>* const verdict =
        batch_ ? &batch_->solve(range, columns_from(fits, column)) : nullptr;
    for (Index i = 0; i < range.count; ++i) {
      const Window window = plan_.window(range.first + i);
      const auto w = static_cast<std::size_t>(column + i);
      fits.windows[w] = window;
      fits.by_batch[w] = verdict && (*verdict)[static_cast<std::size_t>(i)] == batch::Verdict::solved ? 1 : 0;
      if (fits.by_batch[w]) continue;
      fits.set(column + i, fitter_->fit(window, prior()));
    }
  }

  WindowPlan plan_;
  WindowFits common_;
  std::unique_ptr<WindowFitter> fitter_;
  const LinearWindows* linear_ = nullptr;  ///< the fitter of linear models
  std::optional<ParameterPrior> prior_;
  std::unique_ptr<BatchWindows> batch_;
  std::optional<WorkCounter> counter_;  ///< counts of all windows so far
};

WindowFits collect(Fitting&& fitting) {
  WindowFits fits = fitting.common();
  fitting.fit(0, fitting.count(), fits);
  return fits;
}

}  // namespace

FitOptions options_for(const MotionModel& model, const Recording& recording, FitOptions options) {
  options.model = model.name();
  if (is_linear(options))
    throw std::invalid_argument("a motion model must not have the name of a linear model: " + options.model);
  if (model.states() != recording.state_count() || model.inputs() != recording.input_count())
    throw std::invalid_argument("the motion model " + options.model + " has other states or inputs than the runs");
  return options;
}

void check_model(const FitOptions& options, Index states, Index inputs) {
  if (has_lags(options) && options.model != "varx")
    throw ConfigurationError("state_lags, input_lags and input_delay need model = varx, not " + options.model);
  if (!options.input_delay.fits(inputs))
    throw ConfigurationError("input_delay takes one number, or one for each of the " + std::to_string(inputs) +
                             " inputs");
  if (!options.centre.empty() && (!options.intercept || std::ssize(options.centre) != states + inputs))
    throw ConfigurationError("centre takes one number for each state and input, and an intercept");
  motion_model(options, states, inputs);
}

std::vector<std::string> model_names() {
  std::vector<std::string> names{"linear", "varx"};
  for (const std::string& name : motion_model_names()) names.push_back(name);
  return names;
}

std::shared_ptr<const MotionModel> motion_model(const FitOptions& options, Index states, Index inputs) {
  if (is_linear(options)) return nullptr;
  return make_motion_model(options.model, {states, inputs, options.wheel_radius_m});
}

Index parameter_count(const FitOptions& options, Index states, Index inputs) {
  const auto motion = motion_model(options, states, inputs);
  return motion ? motion->parameter_count() : linear_structure(states, inputs, options).parameters();
}

Index count_windows(const Recording& recording, const FitOptions& options) {
  const LinearStructure structure = linear_structure(recording.state_count(), recording.input_count(), options);
  return WindowPlan(recording, options.length, options.step, structure.first_transition()).count();
}

WindowFits fit_windows(const Recording& recording, const FitOptions& options) {
  const ModelChoice model = choose_model(recording, options);
  return collect(Fitting(recording, options, model.structure, model.motion.get()));
}

WindowFits fit_one_lag(const Recording& recording, const WindowFits& fits, FitOptions options) {
  const LinearStructure structure = fits.structure.with_one_lag();
  options.state_lags = options.input_lags = 1;
  options.input_delay = structure.input_delay;
  options.intercept = structure.intercept;
  options.model = structure.lagged() ? "varx" : "linear";
  options.length = fits.length;
  options.step = fits.step;
  if (options.prior_sd.size() > 1) options.prior_sd.clear();
  check_options(options, structure.parameters());
  return collect(Fitting(recording, options, structure, nullptr, fits.structure.first_transition()));
}

WindowFits fit_windows(const Recording& recording, const FitOptions& options, const MotionModel& model) {
  check_options(options, model.parameter_count());
  const LinearStructure structure = linear_structure(recording.state_count(), recording.input_count(), options);
  return collect(Fitting(recording, options, structure, &model));
}

WindowFits stream_windows(const Recording& recording, const FitOptions& options, const WindowSink& sink) {
  const ModelChoice model = choose_model(recording, options);
  Fitting fitting(recording, options, model.structure, model.motion.get());
  WindowFits chunk = fitting.common();
  for (Index first = 0; first < fitting.count(); first += streamed_windows) {
    fitting.fit(first, std::min(streamed_windows, fitting.count() - first), chunk);
    sink(chunk, first);
  }
  return fitting.common();
}

}  // namespace modebank
