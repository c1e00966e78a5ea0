#include "mixture/assignment.hpp"

#include <limits>

namespace modebank {

using Eigen::Index;

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

/// The rows assigned so far, with dual prices that keep every reduced cost nonnegative. Column K is a placeholder at
/// which each search starts.
class Assigner {
 public:
  explicit Assigner(const Eigen::MatrixXd& cost)
      : cost_(cost),
        size_(cost.rows()),
        row_price_(Eigen::VectorXd::Zero(size_)),
        column_price_(Eigen::VectorXd::Zero(size_ + 1)),
        row_of_(Eigen::VectorX<Index>::Constant(size_ + 1, -1)) {}

  /// Assigns a column to `row` along the cheapest path of exchanges (Dijkstra on reduced costs).
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

}  // namespace

std::vector<Index> best_assignment(const Eigen::MatrixXd& values) {
  Assigner assigner(-values);
  for (Index row = 0; row < values.rows(); ++row) assigner.add(row);
  return assigner.columns();
}

}  // namespace modebank
