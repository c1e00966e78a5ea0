#include "mixture/bootstrap.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <boost/random/uniform_int_distribution.hpp>
#include <cmath>
#include <limits>
#include <map>

#include "ident/base/not_a_number.hpp"
#include "ident/base/seed.hpp"
#include "ident/base/work_counter.hpp"
#include "mixture/detail/cloud.hpp"
#include "mixture/detail/whole_loop.hpp"

namespace modebank {

using Eigen::Index;

namespace {

constexpr Index points_to_match = 2000;
constexpr double infinity = std::numeric_limits<double>::infinity();

/// Rows assigned so far, with the dual prices that keep every reduced cost nonnegative. Column K is a stand-in at which
/// each search begins.
class Assigner {
 public:
  explicit Assigner(const Eigen::MatrixXd& cost)
      : cost_(cost),
        size_(cost.rows()),
        row_price_(Eigen::VectorXd::Zero(size_)),
        column_price_(Eigen::VectorXd::Zero(size_ + 1)),
        row_of_(Eigen::VectorX<Index>::Constant(size_ + 1, -1)) {}

  /// Gives `row` a column along the cheapest path of exchanges (Dijkstra on reduced costs).
  void add(Index row) {
    Eigen::VectorXd distance = Eigen::VectorXd::Constant(size_, infinity);
    Eigen::VectorX<Index> previous = Eigen::VectorX<Index>::Constant(size_, size_);
    std::vector<bool> visited(static_cast<std::size_t>(size_ + 1), false);
    Index column = size_;
    row_of_(size_) = row;
    while (row_of_(column) >= 0) {
      visited[static_cast<std::size_t>(column)] = true;
      const Index from = row_of_(column);
      Index nearest = -1;
      for (Index j = 0; j < size_; ++j) {
        if (visited[static_cast<std::size_t>(j)]) continue;
        const double step = cost_(from, j) - row_price_(from) - column_price_(j);
        if (step < distance(j)) {
          distance(j) = step;
          previous(j) = column;
        }
        if (nearest < 0 || distance(j) < distance(nearest)) nearest = j;
      }
      const double shift = distance(nearest);
      for (Index j = 0; j <= size_; ++j)
        if (visited[static_cast<std::size_t>(j)]) {
          row_price_(row_of_(j)) += shift;
          column_price_(j) -= shift;
        } else {
          distance(j) -= shift;
        }
      column = nearest;
    }
    for (; column != size_; column = previous(column)) row_of_(column) = row_of_(previous(column));
  }

  std::vector<Index> columns() const {
    std::vector<Index> result(static_cast<std::size_t>(size_));
    for (Index j = 0; j < size_; ++j) result[static_cast<std::size_t>(row_of_(j))] = j;
    return result;
  }

 private:
  Eigen::MatrixXd cost_;
  Index size_;
  Eigen::VectorXd row_price_;
  Eigen::VectorXd column_price_;
  Eigen::VectorX<Index> row_of_;  // -1: free
};

/// Runs numbered from 0.
struct Runs {
  std::vector<Index> of_point;
  Index count = 0;

  explicit Runs(const std::vector<Index>& runs) {
    std::map<Index, Index> numbers;
    for (const Index run : runs) numbers.try_emplace(run, 0);
    for (auto& [run, number] : numbers) number = count++;
    for (const Index run : runs) of_point.push_back(numbers[run]);
  }
};

/// The points' weights when runs are drawn with replacement: a run drawn twice counts twice.
Eigen::VectorXd resampled_weights(const PointSet& points, const Runs& runs, std::mt19937_64& generator) {
  Eigen::VectorXd copies = Eigen::VectorXd::Zero(runs.count);
  boost::random::uniform_int_distribution<Index> any(0, runs.count - 1);
  for (Index i = 0; i < runs.count; ++i) copies(any(generator)) += 1.0;
  Eigen::VectorXd weights(points.count());
  for (Index i = 0; i < points.count(); ++i)
    weights(i) = copies(runs.of_point[static_cast<std::size_t>(i)]) * (points.weights.size() ? points.weights(i) : 1.0);
  return weights;
}

std::vector<Index> evenly_spread(Index count, Index most) {
  std::vector<Index> positions(static_cast<std::size_t>(std::min(count, most)));
  for (std::size_t i = 0; i < positions.size(); ++i)
    positions[i] = static_cast<Index>(i) * count / std::ssize(positions);
  return positions;
}

/// Weights and means of every replicate, matched with the chosen mixture.
struct Replicates {
  Eigen::MatrixXd weights;             // K x replicates
  std::vector<Eigen::MatrixXd> means;  // K of F x replicates, NaN where the replicate lacks the component
};

/// Standard deviation over the columns that are finite, NaN if those are fewer than half.
Eigen::VectorXd deviation(const Eigen::MatrixXd& values) {
  std::vector<Index> present;
  for (Index i = 0; i < values.cols(); ++i)
    if (values.col(i).allFinite()) present.push_back(i);
  const Index count = std::ssize(present);
  if (count < 2 || 2 * count < values.cols()) return Eigen::VectorXd::Constant(values.rows(), not_a_number);
  const Eigen::MatrixXd kept = values(Eigen::all, present);
  const Eigen::MatrixXd offsets = kept.colwise() - kept.rowwise().mean();
  return (offsets.rowwise().squaredNorm() / static_cast<double>(count - 1)).cwiseSqrt();
}

}  // namespace

std::vector<Index> best_assignment(const Eigen::MatrixXd& values) {
  Assigner assigner(-values);
  for (Index row = 0; row < values.rows(); ++row) assigner.add(row);
  return assigner.columns();
}

MixtureErrors bootstrap_runs(const PointSet& points, const std::vector<Index>& runs_of_points,
                             const GaussianMixture& mixture, const EmOptions& options, int replicates,
                             std::uint64_t seed) {
  const Index K = mixture.components(), F = mixture.features();
  const Runs runs(runs_of_points);
  if (runs.count < 2 || replicates < 2)
    return {Eigen::VectorXd::Constant(K, not_a_number), Eigen::MatrixXd::Constant(F, K, not_a_number)};
  const PointPart sample(points, evenly_spread(points.count(), points_to_match));
  const Eigen::MatrixXd chosen = responsibilities(mixture, sample.set());
  Replicates all{Eigen::MatrixXd(K, replicates),
                 std::vector<Eigen::MatrixXd>(static_cast<std::size_t>(K), Eigen::MatrixXd(F, replicates))};
  // From the chosen mixture alone, by extrapolated steps.
  EmOptions once = options;
  once.restarts = 1;
  once.split_merge = 0;
  WorkCounter counter("bootstrap replicates", static_cast<std::size_t>(replicates));
  tbb::parallel_for(0, replicates, [&](int b) {
    std::mt19937_64 generator = make_generator(seed, "bootstrap", static_cast<std::uint64_t>(b));
    const Eigen::VectorXd weights = resampled_weights(points, runs, generator);
    const PointSet resampled(points.points, weights, points.covariances, points.typical_error);
    const GaussianMixture fit = EmSweep(resampled, once).fit(K, 0, &mixture).mixture;
    const std::vector<Index> match = best_assignment(chosen * responsibilities(fit, sample.set()).transpose());
    // Less than one point's worth is no component any more.
    const double least = 1.0 / static_cast<double>((weights.array() > 0.0).count());
    for (Index k = 0; k < K; ++k) {
      const Index own = match[static_cast<std::size_t>(k)];
      all.weights(k, b) = fit.weights(own);
      all.means[static_cast<std::size_t>(k)].col(b) =
          fit.weights(own) > least ? Eigen::VectorXd(fit.means.col(own)) : Eigen::VectorXd::Constant(F, not_a_number);
    }
    counter.add();
  });
  require_whole_loop();
  // The variance of a mean of R resampled runs is (R - 1) / R of the unbiased one.
  const double unbiased = std::sqrt(static_cast<double>(runs.count) / static_cast<double>(runs.count - 1));
  MixtureErrors errors{unbiased * deviation(all.weights), Eigen::MatrixXd(F, K)};
  for (Index k = 0; k < K; ++k) errors.means.col(k) = unbiased * deviation(all.means[static_cast<std::size_t>(k)]);
  return errors;
}

}  // namespace modebank
