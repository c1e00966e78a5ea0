#include <tbb/parallel_for.h>

#include <cmath>
#include <optional>
#include <vector>

#include "ident/error.hpp"
#include "ident/model_fit.hpp"
#include "ident/model_windows.hpp"
#include "ident/not_a_number.hpp"
#include "ident/parameter_prior.hpp"
#include "ident/robust_scale.hpp"
#include "ident/window_audit.hpp"
#include "ident/window_plan.hpp"

namespace modebank {

namespace {

constexpr int global_iterations = 1000;
constexpr int scale_passes = 3;  // of the global fit, each with the residuals' standard deviations of the one before

/// Root mean square per state.
Eigen::VectorXd root_mean_square(const Eigen::VectorXd& r, Index n) {
  const Index samples = std::max(Index{1}, r.size() / n);
  return (r.reshaped(n, r.size() / n).rowwise().squaredNorm() / static_cast<double>(samples)).cwiseSqrt();
}

Eigen::VectorXd positive_or_one(const Eigen::VectorXd& values) {
  return values.unaryExpr([](double value) { return value > 0.0 && std::isfinite(value) ? value : 1.0; });
}

Eigen::VectorXd start_of(const MotionModel& model) {
  Eigen::VectorXd theta(model.parameter_count());
  for (Index j = 0; j < theta.size(); ++j) theta(j) = model.parameters()[static_cast<std::size_t>(j)].start;
  return theta;
}

FitOptions solved_by_ceres(FitOptions options) {
  options.solver = WindowSolver::ceres;
  return options;
}

/// What the fits of all windows share.
struct ModelContext {
  const Recording& recording;
  const FitOptions& options;
  const MotionModel& model;
  const GlobalModel& global;
  ModelEstimator estimator;
  RobustLoss least_squares;
  Eigen::VectorXd floor;
  std::vector<Eigen::VectorXd> run_scale;
};

/// robust_scale of the residuals of least squares; NaN when there are too few.
Eigen::VectorXd least_squares_scale(const ModelContext& context, const ModelResiduals& residuals,
                                    const Eigen::VectorXd& sigma) {
  const Index n = residuals.states();
  const ModelMinimum minimum = minimise_model(residuals, sigma, context.least_squares, nullptr,
                                              context.estimator.search, residuals.unknowns_at(context.global.theta));
  if (minimum.status == FitStatus::failed) return Eigen::VectorXd::Constant(n, not_a_number);
  Eigen::VectorXd r;
  RowMajorJacobian J;
  residuals.evaluate(minimum.unknowns.data(), r, &J);
  const double lost = static_cast<double>(decompose(J, excitation_tolerance).rank()) / static_cast<double>(n);
  return robust_scale(r.reshaped(n, residuals.samples()).transpose(), residuals.weights(), lost);
}

Eigen::VectorXd scale_of_run(const ModelContext& context, const Trajectory& run) {
  const Eigen::VectorXd global_scale = positive_or_one(context.global.noise_variance().cwiseSqrt());
  const ModelResiduals residuals(context.model, {{&run, 0, run.transitions()}}, context.options.residual);
  if (residuals.samples() == 0) return global_scale;
  const Eigen::VectorXd scale = least_squares_scale(context, residuals, global_scale);
  return (scale.allFinite() ? scale : global_scale).cwiseMax(context.floor);
}

ModelContext make_model_context(const Recording& recording, const FitOptions& options, const MotionModel& model,
                                const GlobalModel& global) {
  const LinearStructure structure{model.states(), model.inputs(), false};
  ModelContext context{recording,
                       options,
                       model,
                       global,
                       make_model_estimator(model, options),
                       RobustLoss(Loss::trivial, 0.0),
                       scale_floor(recording, structure, global.noise_variance()),
                       std::vector<Eigen::VectorXd>(recording.runs.size())};
  tbb::parallel_for(std::size_t{0}, recording.runs.size(), [&](std::size_t i) {
    if (recording.runs[i].role == Role::train) context.run_scale[i] = scale_of_run(context, recording.runs[i]);
  });
  return context;
}

Eigen::VectorXd sigma_of_window(const ModelContext& context, const Window& window, const ModelResiduals& residuals) {
  const Eigen::VectorXd& run_scale = context.run_scale[static_cast<std::size_t>(window.run)];
  if (context.options.scale == ScaleSource::fixed)
    return Eigen::VectorXd::Constant(run_scale.size(), context.options.sigma);
  if (context.options.scale == ScaleSource::run || residuals.rows() <= residuals.unknowns()) return run_scale;
  const Eigen::VectorXd scale = least_squares_scale(context, residuals, run_scale);
  return scale.allFinite() ? Eigen::VectorXd(scale.cwiseMax(context.floor)) : run_scale;
}

LocalModel fit_model_window(const ModelContext& context, const Window& window, const ParameterPrior* prior) {
  const Trajectory& run = context.recording.runs[static_cast<std::size_t>(window.run)];
  const ModelResiduals residuals(context.model, {{&run, window.start, context.options.length}},
                                 context.options.residual);
  return fit_model(residuals, context.estimator, sigma_of_window(context, window, residuals), context.floor, prior,
                   residuals.unknowns_at(context.global.theta));
}

/// A window searched both ways; the fit by Ceres, to take the other's place where that is above.
AuditedWindow audit_model_window(const ModelContext& context, const Window& window, const ParameterPrior* prior,
                                 const LocalModel& fit) {
  const Trajectory& run = context.recording.runs[static_cast<std::size_t>(window.run)];
  const ModelResiduals residuals(context.model, {{&run, window.start, context.options.length}},
                                 context.options.residual);
  const Eigen::VectorXd sigma = sigma_of_window(context, window, residuals),
                        start = residuals.unknowns_at(context.global.theta);
  const ModelEstimator& estimator = context.estimator;
  const ModelSearch by_ceres{estimator.search.iterations, false};
  AuditedWindow result;
  const ModelMinimum ours = minimise_model(residuals, sigma, estimator.loss, prior, estimator.search, start),
                     theirs = minimise_model(residuals, sigma, estimator.loss, prior, by_ceres, start);
  if (ours.status == FitStatus::failed || theirs.status == FitStatus::failed) return result;
  result.compared = true;
  result.cost = relative_cost_above(ours.cost, theirs.cost, residuals.samples());
  const Eigen::ArrayXd difference = (ours.unknowns - theirs.unknowns).head(fit.theta.size()).cwiseAbs();
  const Eigen::ArrayXd errors = fit.covariance.diagonal().array().sqrt();
  if (errors.allFinite()) result.parameter = (difference / errors).maxCoeff();
  if (!(result.cost <= WindowAudit::tolerance))
    result.ceres = fit_model(residuals, make_model_estimator(context.model, solved_by_ceres(context.options)), sigma,
                             context.floor, prior, start);
  return result;
}

/// theta of windows fitted without prior, one per column; NaN where the rank is deficient.
Eigen::MatrixXd unregularised_fits(const ModelContext& context, const std::vector<Window>& windows) {
  const Index p = context.global.theta.size();
  Eigen::MatrixXd all = Eigen::MatrixXd::Constant(p, static_cast<Index>(windows.size()), not_a_number);
  tbb::parallel_for(std::size_t{0}, windows.size(), [&](std::size_t i) {
    const LocalModel fit = fit_model_window(context, windows[i], nullptr);
    if (fit.rank == p) all.col(static_cast<Index>(i)) = fit.theta;
  });
  return all;
}

void audit_model_windows(const ModelContext& context, const ParameterPrior* prior, WindowFits& fits) {
  const std::vector<Index> audited = audited_windows(fits.count(), context.options.seed);
  std::vector<AuditedWindow> results(audited.size());
  tbb::parallel_for(std::size_t{0}, audited.size(), [&](std::size_t i) {
    results[i] =
        audit_model_window(context, fits.windows[static_cast<std::size_t>(audited[i])], prior, fits.at(audited[i]));
  });
  fits.audit.batch = fits.count();
  for (std::size_t i = 0; i < audited.size(); ++i)
    if (add_to_audit(results[i], fits.audit)) fits.set(audited[i], results[i].ceres);
}

}  // namespace

GlobalModel fit_global(const Recording& recording, const MotionModel& model) {
  const ModelResiduals residuals(model, training_stretches(recording), ResidualKind::one_step);
  if (residuals.samples() == 0) throw DataError("the training runs hold no transition between two finite samples");
  const Index n = model.states(), p = model.parameter_count(), N = residuals.samples();
  const RobustLoss least_squares(Loss::trivial, 0.0);
  GlobalModel global;
  global.theta = start_of(model);
  Eigen::VectorXd r;
  residuals.evaluate(global.theta.data(), r, nullptr);
  for (int pass = 0; pass < (n > 1 ? scale_passes : 1); ++pass) {
    const Eigen::VectorXd sigma = positive_or_one(root_mean_square(r, n));
    global.theta = minimise_model(residuals, sigma, least_squares, nullptr, {global_iterations}, global.theta).unknowns;
    residuals.evaluate(global.theta.data(), r, nullptr);
  }
  const auto errors = r.reshaped(n, N);
  global.residual_covariance = errors * errors.transpose() / static_cast<double>(N);
  global.transitions = N;
  FitOptions options;
  options.loss = Loss::trivial;
  const Eigen::VectorXd sigma = positive_or_one(root_mean_square(r, n));
  global.covariance =
      fit_model(residuals, make_model_estimator(model, options), sigma, Eigen::VectorXd::Zero(n), nullptr, global.theta)
          .covariance;
  if (global.covariance.rows() != p) global.covariance = Eigen::MatrixXd::Constant(p, p, not_a_number);
  return global;
}

WindowFits fit_windows(const Recording& recording, const FitOptions& options, const MotionModel& model) {
  const std::vector<Window> windows = make_windows(recording, options.length, options.step);
  WindowFits fits = empty_fits(options, linear_structure(recording.state_count(), recording.input_count(), options),
                               static_cast<Index>(windows.size()));
  if (!is_linear(options)) fits.model_parameters = model.parameters();
  fits.windows = windows;
  fits.global = fit_global(recording, model);

  const ModelContext context = make_model_context(recording, options, model, fits.global);
  std::optional<ParameterPrior> prior;
  if (options.prior == Prior::global) {
    fits.prior_sd = make_prior_sd(options, fits.global, [&] { return unregularised_fits(context, windows); });
    prior = ParameterPrior{fits.global.theta, fits.prior_sd};
  }
  fits.resize(fits.count());
  tbb::parallel_for(std::size_t{0}, windows.size(), [&](std::size_t i) {
    fits.set(static_cast<Index>(i), fit_model_window(context, windows[i], prior ? &*prior : nullptr));
  });
  if (context.estimator.search.newton_first) audit_model_windows(context, prior ? &*prior : nullptr, fits);
  return fits;
}

}  // namespace modebank
