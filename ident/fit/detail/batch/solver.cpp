#include "ident/fit/detail/batch/solver.hpp"

#include <hwy/targets.h>

#include <algorithm>
#include <cstdint>
#include <stdexcept>

#include "ident/fit/loss.hpp"

namespace modebank {

namespace {

/// Longest window of the batch solver. Longer windows exceed the cache of a core.
constexpr Index longest_window = 16384;

/// Comparators of Batcher's odd-even merge sort (1968) for n rows.
std::vector<batch::Comparator> sorting_network(Index n) {
  std::vector<batch::Comparator> network;
  for (Index p = 1; p < n; p *= 2)
    for (Index k = p; k >= 1; k /= 2)
      for (Index j = k % p; j + k < n; j += 2 * k)
        for (Index i = j; i < std::min(j + k, n - k); ++i)
          if (i / (2 * p) == (i + k) / (2 * p))
            network.push_back({static_cast<std::int32_t>(i), static_cast<std::int32_t>(i + k)});
  return network;
}

/// The comparators that determine the middle values of n rows.
std::vector<batch::Comparator> median_network(const std::vector<batch::Comparator>& sorting, Index n) {
  std::vector<bool> needed(static_cast<std::size_t>(n), false);
  needed[static_cast<std::size_t>(n / 2)] = true;
  if (n % 2 == 0) needed[static_cast<std::size_t>(n / 2 - 1)] = true;
  std::vector<batch::Comparator> network;
  for (auto c = sorting.rbegin(); c != sorting.rend(); ++c) {
    const auto low = static_cast<std::size_t>(c->low), high = static_cast<std::size_t>(c->high);
    if (!needed[low] && !needed[high]) continue;
    needed[low] = needed[high] = true;
    network.push_back(*c);
  }
  std::reverse(network.begin(), network.end());
  return network;
}

batch::Kernel choose_kernel(const batch::Settings& settings) {
  // Chooses the instruction set. Otherwise every call through Highway's pointers would first detect the processor.
  hwy::ChosenTarget& target = hwy::GetChosenTarget();
  if (!target.IsInitialized()) target.Update(hwy::SupportedTargets());
  return batch::find_kernel(settings.loss, settings.regressors);
}

/// Whether all rows are finite: if one is not, the sum of the values times zero is NaN.
bool finite(const Transitions& t, Index rows) {
  double sum = (t.increments.col(0).head(rows) * 0.0).sum();
  for (Index j = 0; j < t.regressors.cols(); ++j) sum += (t.regressors.col(j).head(rows) * 0.0).sum();
  return sum == 0.0;
}

}  // namespace

batch::Chunk BatchWorkspace::stage(const Trajectory& run, Index start, Index windows, const LinearStructure& structure,
                                   const batch::Settings& settings) {
  const Index rows = (windows - 1) * settings.step + settings.length, q = structure.regressors();
  if (transitions_.count() < rows + batch::padding || transitions_.regressors.cols() != q) {
    transitions_ = {Eigen::MatrixXd::Zero(rows + batch::padding, q), Eigen::MatrixXd::Zero(rows + batch::padding, 1)};
    present_ = Eigen::VectorXd::Zero(rows + batch::padding);
  }
  fill_transitions(run, start, rows, structure, transitions_);
  transitions_.regressors.middleRows(rows, batch::padding).setZero();
  transitions_.increments.middleRows(rows, batch::padding).setZero();
  batch::Chunk chunk;
  chunk.windows = windows;
  for (Index j = 0; j < q; ++j) chunk.regressors[j] = transitions_.regressors.col(j).data();
  chunk.increments = transitions_.increments.data();
  if (finite(transitions_, rows)) return chunk;
  present_.setZero();
  for (Index i = 0; i < rows; ++i) {
    const bool whole = transitions_.regressors.row(i).allFinite() && transitions_.increments.row(i).allFinite();
    present_(i) = whole ? 1.0 : 0.0;
    if (whole) continue;
    transitions_.regressors.row(i).setZero();
    transitions_.increments.row(i).setZero();
  }
  chunk.present = present_.data();
  return chunk;
}

double* BatchWorkspace::scratch(Index length) {
  constexpr std::size_t alignment = 64;
  const auto doubles = static_cast<std::size_t>(batch::scratch_doubles(length)) + alignment / sizeof(double);
  if (scratch_.size() < doubles) scratch_.resize(doubles);
  void* begin = scratch_.data();
  std::size_t space = scratch_.size() * sizeof(double);
  return static_cast<double*>(std::align(alignment, 1, begin, space));
}

bool BatchSolver::handles(const LinearStructure& structure, Index length) {
  return structure.states == 1 && structure.regressors() <= batch::max_regressors && length > structure.regressors() &&
         length <= longest_window;
}

BatchSolver::BatchSolver(batch::Settings settings) : settings_(std::move(settings)), kernel_(choose_kernel(settings_)) {
  if (!kernel_ || settings_.length <= settings_.regressors || settings_.length > longest_window)
    throw std::invalid_argument("the batch solver has no kernel for these windows");
  if (settings_.sigma == 0.0 && settings_.sort.empty()) {
    settings_.sort = sorting_network(settings_.length);
    settings_.median = median_network(settings_.sort, settings_.length);
  }
}

batch::Settings batch_settings(const LinearStructure& structure, const FitOptions& options, const ParameterPrior* prior,
                               double floor) {
  const RobustLoss loss(options.loss, options.loss_scale);
  batch::Settings settings;
  settings.regressors = static_cast<int>(structure.regressors());
  settings.length = options.length;
  settings.step = options.step;
  settings.loss = options.loss;
  settings.loss_scale = loss.scale();
  settings.consistency = gaussian_consistency(loss, structure.states);
  settings.sigma = options.sigma;
  settings.floor = floor;
  settings.covariance = options.covariance;
  settings.max_iterations = options.max_iterations;
  settings.prior = prior != nullptr;
  for (Index j = 0; prior && j < structure.parameters(); ++j) {
    settings.prior_mean[j] = prior->mean(j);
    settings.prior_sd[j] = prior->sd(j);
  }
  return settings;
}

}  // namespace modebank
