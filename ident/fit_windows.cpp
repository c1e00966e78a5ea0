#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "ident/batch_solver.hpp"
#include "ident/error.hpp"
#include "ident/linear_motion.hpp"
#include "ident/model_choice.hpp"
#include "ident/model_windows.hpp"
#include "ident/not_a_number.hpp"
#include "ident/parameter_prior.hpp"
#include "ident/seed.hpp"
#include "ident/window_audit.hpp"
#include "ident/window_plan.hpp"

namespace modebank {

namespace {

void check_options(const FitOptions& options, Index parameters) {
  const auto require = [](bool ok, const std::string& key, const std::string& value, const std::string& range) {
    if (!ok) throw ConfigurationError(key + " = " + value + " is out of range: " + range);
  };
  require(options.length >= 1, "window.length", std::to_string(options.length), "at least 1");
  require(options.step >= 1, "window.step", std::to_string(options.step), "at least 1");
  require(options.loss_scale >= 0.0 && std::isfinite(options.loss_scale), "window.loss_scale",
          std::to_string(options.loss_scale), "positive, or 0 for the default");
  require(options.state_lags >= 1, "window.state_lags", std::to_string(options.state_lags), "at least 1");
  require(options.input_lags >= 1, "window.input_lags", std::to_string(options.input_lags), "at least 1");
  require(options.input_delay >= 0, "window.input_delay", std::to_string(options.input_delay), "at least 0");
  require(options.max_iterations >= 1, "window.max_iterations", std::to_string(options.max_iterations), "at least 1");
  if (options.scale == ScaleSource::fixed)
    require(options.sigma > 0.0 && std::isfinite(options.sigma), "window.sigma", std::to_string(options.sigma),
            "positive");
  const Eigen::VectorXd& sd = options.prior_sd;
  require(sd.size() <= 1 || sd.size() == parameters, "window.prior_sd", std::to_string(sd.size()) + " values",
          "one value, or one per parameter (" + std::to_string(parameters) + ")");
  for (const double value : sd)
    require(value > 0.0 && std::isfinite(value), "window.prior_sd", std::to_string(value), "positive");
}

/// The model of the general door, or null for the linear one.
std::shared_ptr<const MotionModel> general_model(const FitOptions& options, Index states, Index inputs) {
  if (is_linear(options) && options.residual == ResidualKind::simulation)
    return make_linear_motion(linear_structure(states, inputs, options));
  return motion_model(options, states, inputs);
}

/// A batch solver's unit of work: long enough to pay for its staging, short enough to stay in a core's second cache.
constexpr Index job_windows = 1024;
/// What stream_windows hands over at a time.
constexpr Index streamed_windows = 65536;
/// The default prior is made from so many windows at most, drawn in blocks.
constexpr Index prior_windows = 200000;
constexpr Index prior_block = 64;

/// What one thread needs for its jobs.
struct Worker {
  BatchWorkspace workspace;
  std::vector<batch::Verdict> verdict = std::vector<batch::Verdict>(static_cast<std::size_t>(job_windows));
};
using Workers = tbb::enumerable_thread_specific<Worker>;

std::optional<BatchSolver> make_batch_solver(const WindowContext& context, const ParameterPrior* prior) {
  const FitOptions& options = context.options();
  const bool possible = BatchSolver::handles(context.structure(), options.length) && !context.recording().weighted();
  if (options.solver == WindowSolver::batch && !possible)
    throw ConfigurationError("window.solver = batch: the batch solver fits one state with at most " +
                             std::to_string(batch::max_regressors) +
                             " regressors, fewer than window.length, without sample weights; take auto or ceres");
  if (options.solver == WindowSolver::ceres || !possible) return std::nullopt;
  return BatchSolver(batch_settings(context.structure(), options, prior, context.floor()(0)));
}

double chunk_sigma(const WindowContext& context, Index run) {
  if (context.options().scale == ScaleSource::fixed) return context.options().sigma;
  return context.options().scale == ScaleSource::run ? context.run_scale(run)(0) : 1.0;
}

/// Solves one stretch; the worker's verdicts say which windows are left.
void solve_stretch(const WindowContext& context, const BatchSolver& solver, const WindowPlan::Stretch& stretch,
                   Worker& worker, batch::Output out) {
  const batch::Settings& settings = solver.settings();
  batch::Chunk chunk = worker.workspace.stage(context.run_of(stretch.window), stretch.window.start, stretch.count,
                                              context.structure(), settings);
  chunk.sigma = chunk_sigma(context, stretch.window.run);
  out.verdict = worker.verdict.data();
  solver(chunk, worker.workspace.scratch(settings.length), out);
}

batch::Output columns_from(WindowFits& fits, Index i) {
  batch::Output out;
  out.theta = fits.parameters.col(i).data();
  out.covariance = fits.covariance.col(i).data();
  out.noise_variance = fits.noise_variance.col(i).data();
  out.condition = fits.condition.data() + i;
  out.information = fits.information.col(i).data();
  out.inlier_fraction = fits.inlier_fraction.data() + i;
  out.r_squared = fits.r_squared.col(i).data();
  out.aic = fits.aic.data() + i;
  out.transitions = fits.transitions.data() + i;
  out.rank = fits.rank.data() + i;
  out.status = fits.status.data() + i;
  return out;
}

/// theta of windows fitted without prior, one per column; NaN where the rank is deficient.
Eigen::MatrixXd unregularised_fits(const WindowContext& context, const WindowPlan& plan, Workers& workers) {
  const Index M = plan.count(), blocks = prior_windows / prior_block;
  std::vector<WindowPlan::Stretch> jobs;
  if (M <= prior_windows) {
    jobs = plan.stretches(0, M, job_windows);
  } else {
    std::mt19937_64 generator = make_generator(context.options().seed, "prior_windows");
    for (Index b = 0; b < blocks; ++b) {
      const Index begin = b * M / blocks, size = (b + 1) * M / blocks - begin;
      const Index offset =
          static_cast<Index>(generator() % static_cast<std::uint64_t>(std::max<Index>(1, size - prior_block + 1)));
      for (const auto& stretch : plan.stretches(begin + offset, std::min(prior_block, size), prior_block))
        jobs.push_back(stretch);
    }
  }
  std::vector<Index> column{0};
  for (const auto& job : jobs) column.push_back(column.back() + job.count);
  const std::optional<BatchSolver> solver = make_batch_solver(context, nullptr);
  Eigen::MatrixXd all = Eigen::MatrixXd::Constant(context.structure().parameters(), column.back(), not_a_number);
  tbb::parallel_for(std::size_t{0}, jobs.size(), [&](std::size_t j) {
    const WindowPlan::Stretch& job = jobs[j];
    Worker& worker = workers.local();
    batch::Output out;
    out.theta = all.col(column[j]).data();
    if (solver) solve_stretch(context, *solver, job, worker, out);
    for (Index i = 0; i < job.count; ++i) {
      const auto verdict = solver ? worker.verdict[static_cast<std::size_t>(i)] : batch::Verdict::failed;
      if (verdict == batch::Verdict::solved) continue;
      if (verdict == batch::Verdict::rank_deficient)
        all.col(column[j] + i).setConstant(not_a_number);
      else
        all.col(column[j] + i) = context.unregularised_theta(plan.window(job.first + i));
    }
  });
  return all;
}

/// All windows of a recording, to be fitted range by range.
class Fitting {
 public:
  Fitting(const Recording& recording, const FitOptions& options, const LinearStructure& structure)
      : plan_(recording, options.length, options.step, structure.first_transition()) {
    common_ = empty_fits(options, structure, plan_.count());
    common_.global = fit_global(recording, structure);
    context_.emplace(recording, options, structure, common_.global);
    if (options.prior == Prior::global) {
      common_.prior_sd =
          make_prior_sd(options, common_.global, [this] { return unregularised_fits(*context_, plan_, workers_); });
      prior_ = ParameterPrior{common_.global.theta, common_.prior_sd};
    }
    solver_ = make_batch_solver(*context_, prior());
    if (solver_) audited_ = audited_windows(plan_.count(), options.seed);
  }
  Fitting(const Fitting&) = delete;  // the context refers to the global model
  Fitting& operator=(const Fitting&) = delete;

  Index count() const { return plan_.count(); }
  const WindowFits& common() const { return common_; }

  /// Windows first .. first + count - 1 into the columns of `fits`.
  void fit(Index first, Index count, WindowFits& fits) {
    fits.resize(count);
    std::vector<batch::Verdict> verdicts(static_cast<std::size_t>(count), batch::Verdict::failed);
    const std::vector<WindowPlan::Stretch> jobs = plan_.stretches(first, count, solver_ ? job_windows : 1);
    tbb::parallel_for(std::size_t{0}, jobs.size(),
                      [&](std::size_t j) { fit_stretch(jobs[j], jobs[j].first - first, verdicts, fits); });
    const auto solved = std::count(verdicts.begin(), verdicts.end(), batch::Verdict::solved);
    common_.audit.batch += solved;
    common_.audit.ceres += count - solved;
    audit(first, count, verdicts, fits);
    fits.audit = common_.audit;
  }

 private:
  const ParameterPrior* prior() const { return prior_ ? &*prior_ : nullptr; }

  void fit_stretch(const WindowPlan::Stretch& stretch, Index column, std::vector<batch::Verdict>& verdicts,
                   WindowFits& fits) {
    Worker& worker = workers_.local();
    if (solver_) solve_stretch(*context_, *solver_, stretch, worker, columns_from(fits, column));
    for (Index i = 0; i < stretch.count; ++i) {
      const Window window = plan_.window(stretch.first + i);
      const auto w = static_cast<std::size_t>(column + i);
      fits.windows[w] = window;
      if (solver_) verdicts[w] = worker.verdict[static_cast<std::size_t>(i)];
      if (verdicts[w] != batch::Verdict::solved) fits.set(column + i, context_->fit(window, prior()));
    }
  }

  void audit(Index first, Index count, const std::vector<batch::Verdict>& verdicts, WindowFits& fits) {
    const auto begin = std::lower_bound(audited_.begin(), audited_.end(), first),
               end = std::lower_bound(audited_.begin(), audited_.end(), first + count);
    std::vector<AuditedWindow> results(static_cast<std::size_t>(end - begin));
    tbb::parallel_for(std::size_t{0}, results.size(), [&](std::size_t i) {
      const Index column = begin[static_cast<std::ptrdiff_t>(i)] - first;
      if (verdicts[static_cast<std::size_t>(column)] != batch::Verdict::solved) return;
      results[i] = audit_window(*context_, fits.windows[static_cast<std::size_t>(column)], prior(), fits.at(column));
    });
    for (std::size_t i = 0; i < results.size(); ++i)
      if (add_to_audit(results[i], common_.audit))
        fits.set(begin[static_cast<std::ptrdiff_t>(i)] - first, results[i].ceres);
  }

  WindowPlan plan_;
  WindowFits common_;
  Workers workers_;
  std::optional<WindowContext> context_;
  std::optional<ParameterPrior> prior_;
  std::optional<BatchSolver> solver_;
  std::vector<Index> audited_;
};

}  // namespace

WindowFits fit_windows(const Recording& recording, const FitOptions& options) {
  const LinearStructure structure = linear_structure(recording.state_count(), recording.input_count(), options);
  check_model(options, recording.state_count(), recording.input_count());
  if (const auto motion = general_model(options, recording.state_count(), recording.input_count())) {
    check_options(options, motion->parameter_count());
    return fit_windows(recording, options, *motion);
  }
  check_options(options, structure.parameters());
  Fitting fitting(recording, options, structure);
  WindowFits fits = fitting.common();
  fitting.fit(0, fitting.count(), fits);
  return fits;
}

Index count_windows(const Recording& recording, const FitOptions& options) {
  const LinearStructure structure = linear_structure(recording.state_count(), recording.input_count(), options);
  return WindowPlan(recording, options.length, options.step, structure.first_transition()).count();
}

WindowFits stream_windows(const Recording& recording, const FitOptions& options, const WindowSink& sink) {
  const LinearStructure structure = linear_structure(recording.state_count(), recording.input_count(), options);
  check_options(options, structure.parameters());
  Fitting fitting(recording, options, structure);
  WindowFits chunk = fitting.common();
  for (Index first = 0; first < fitting.count(); first += streamed_windows) {
    fitting.fit(first, std::min(streamed_windows, fitting.count() - first), chunk);
    sink(chunk, first);
  }
  return fitting.common();
}

}  // namespace modebank
