#include "mixture/hierarchical.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace modebank {

using Eigen::Index;

namespace {

struct Cluster {
  double count = 1.0;
  Eigen::VectorXd mean;
  Eigen::MatrixXd scatter;  ///< F x F, about the mean
  double cost = 0.0;
};

/// The cheapest partner of a cluster among those after it.
struct Partner {
  int cluster = -1;
  double loss = std::numeric_limits<double>::infinity();
};

class Agglomerator {
 public:
  explicit Agglomerator(const Eigen::MatrixXd& points) {
    const Index features = points.rows(), count = points.cols();
    const Eigen::MatrixXd offsets = points.colwise() - points.rowwise().mean();
    spread_ = std::max(offsets.squaredNorm() / static_cast<double>(count * features), smallest_spread);
    clusters_.resize(static_cast<std::size_t>(count));
    for (Index i = 0; i < count; ++i) {
      Cluster& cluster = at(i);
      cluster.mean = points.col(i);
      cluster.scatter.setZero(features, features);
      cluster.cost = std::log(spread_);
      alive_.push_back(static_cast<int>(i));
    }
    partners_.resize(static_cast<std::size_t>(count));
    for (const int i : alive_) find_partner(i);
  }

  Agglomeration run() {
    Agglomeration result;
    while (alive_.size() > 1) {
      const int kept = *std::min_element(alive_.begin(), alive_.end(),
                                         [&](int a, int b) { return partner(a).loss < partner(b).loss; });
      const int absorbed = partner(kept).cluster;
      result.merges.push_back({kept, absorbed});
      merge(kept, absorbed);
    }
    return result;
  }

 private:
  static constexpr double smallest_spread = 1e-12;  // all points coincide

  Cluster& at(Index i) { return clusters_[static_cast<std::size_t>(i)]; }
  Partner& partner(int i) { return partners_[static_cast<std::size_t>(i)]; }

  /// Of a cluster whose covariance is in `scratch_`, which is used up.
  double cost_of_scratch(double count) {
    const double trace = scratch_.trace();
    const Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>> cholesky(scratch_);
    const double root = cholesky.info() == Eigen::Success ? scratch_.diagonal().prod() : 0.0;
    return count * std::log(root * root + trace + spread_);
  }

  /// What merging a and b costs; called for every pair, so without allocation.
  double loss(int a, int b) {
    const Cluster &first = at(a), &second = at(b);
    const double count = first.count + second.count;
    gap_ = second.mean - first.mean;
    scratch_ = (first.scatter + second.scatter) / count;
    scratch_.noalias() += gap_ * gap_.transpose() * (first.count * second.count / (count * count));
    return cost_of_scratch(count) - first.cost - second.cost;
  }

  void absorb(Cluster& a, const Cluster& b) {
    const double count = a.count + b.count;
    gap_ = b.mean - a.mean;
    a.scatter += b.scatter + gap_ * gap_.transpose() * (a.count * b.count / count);
    a.mean += gap_ * (b.count / count);
    a.count = count;
    scratch_ = a.scatter / count;
    a.cost = cost_of_scratch(count);
  }

  void find_partner(int i) {
    partner(i) = {};
    for (auto j = std::upper_bound(alive_.begin(), alive_.end(), i); j != alive_.end(); ++j) {
      const double candidate = loss(i, *j);
      if (candidate < partner(i).loss) partner(i) = {*j, candidate};
    }
  }

  void merge(int kept, int absorbed) {
    absorb(at(kept), at(absorbed));
    alive_.erase(std::find(alive_.begin(), alive_.end(), absorbed));
    for (const int i : alive_) {
      if (i == kept || partner(i).cluster == kept || partner(i).cluster == absorbed) {
        find_partner(i);
      } else if (i < kept) {
        const double candidate = loss(i, kept);
        if (candidate < partner(i).loss) partner(i) = {kept, candidate};
      }
    }
  }

  double spread_ = 0.0;
  Eigen::VectorXd gap_;
  Eigen::MatrixXd scratch_;
  std::vector<Cluster> clusters_;
  std::vector<int> alive_;  // sorted
  std::vector<Partner> partners_;
};

}  // namespace

std::vector<int> Agglomeration::labels(Index components) const {
  std::vector<int> owner(merges.size() + 1);
  std::iota(owner.begin(), owner.end(), 0);
  const std::size_t done = owner.size() - static_cast<std::size_t>(std::min<Index>(components, std::ssize(owner)));
  // From the last merge to the first, so that every owner is final when it is passed on.
  for (std::size_t m = done; m-- > 0;) {
    const auto absorbed = static_cast<std::size_t>(merges[m].absorbed);
    owner[absorbed] = owner[static_cast<std::size_t>(merges[m].kept)];
  }
  std::vector<int> number(owner.size(), -1);
  int next = 0;
  for (int& cluster : owner) {
    int& known = number[static_cast<std::size_t>(cluster)];
    if (known < 0) known = next++;
    cluster = known;
  }
  return owner;
}

Agglomeration agglomerate(const Eigen::MatrixXd& points) { return Agglomerator(points).run(); }

}  // namespace modebank
