#include "filter/learn/switching/mean_square_growth.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "filter/learn/from_mixture/pooled_modes.hpp"
#include "ident/base/linalg.hpp"

namespace modebank {
namespace {

/// The operator on the modes' second moments. The moments are symmetric matrices, stored as lower triangles one after
/// the other.
class SecondMoments {
 public:
  SecondMoments(const LinearStructure& structure, const SwitchingRegression& model)
      : transition_(model.transition), n_(structure.dimension()) {
    for (Index j = 0; j < model.modes(); ++j) F_.push_back(unpack(structure, model.theta.col(j)).full_form());
  }

  bool finite() const {
    return std::all_of(F_.begin(), F_.end(), [](const Eigen::MatrixXd& F) { return F.allFinite(); });
  }
  bool one_motion() const {
    return std::all_of(F_.begin(), F_.end(), [&](const Eigen::MatrixXd& F) { return F == F_.front(); });
  }
  Eigen::VectorXd of_white_noise() const {
    return packed(Eigen::MatrixXd::Identity(n_, n_)).replicate(std::ssize(F_), 1);
  }
  Eigen::VectorXd after_a_step(const Eigen::VectorXd& moments) const {
    const Index size = n_ * (n_ + 1) / 2;
    Eigen::MatrixXd moved(size, std::ssize(F_));
    for (Index i = 0; i < moved.cols(); ++i) {
      const Eigen::MatrixXd& F = F_[static_cast<std::size_t>(i)];
      moved.col(i) = packed(F * unpacked(moments.segment(i * size, size)) * F.transpose());
    }
    return (moved * transition_).reshaped();
  }

 private:
  std::vector<Eigen::MatrixXd> F_;
  const Eigen::MatrixXd& transition_;
  Index n_;

  Eigen::VectorXd packed(const Eigen::MatrixXd& X) const {
    Eigen::VectorXd triangle(n_ * (n_ + 1) / 2);
    for (Index j = 0, at = 0; j < n_; at += n_ - j, ++j) triangle.segment(at, n_ - j) = X.col(j).tail(n_ - j);
    return triangle;
  }
  Eigen::MatrixXd unpacked(const Eigen::VectorXd& triangle) const {
    Eigen::MatrixXd X(n_, n_);
    for (Index j = 0, at = 0; j < n_; at += n_ - j, ++j) {
      X.col(j).tail(n_ - j) = triangle.segment(at, n_ - j);
      X.row(j).tail(n_ - j) = triangle.segment(at, n_ - j).transpose();
    }
    return X;
  }
};

}  // namespace

double mean_square_growth(const LinearStructure& structure, const SwitchingRegression& model) {
  const SecondMoments moments(structure, model);
  if (!moments.finite()) return std::numeric_limits<double>::infinity();
  // If all modes have one motion, the sum of their moments evolves like the moment of a single mode, because rows of T
  // sum to one. A root of the n x n matrix is exact even if the larger operator has multiple eigenvalues.
  if (moments.one_motion()) return std::pow(spectral_radius(unpack(structure, model.theta.col(0))), 2);
  // The operator maps positive semidefinite matrices to positive semidefinite matrices. So its spectral radius is an
  // eigenvalue (Krein & Rutman 1948), and no other eigenvalue has a larger real part.
  return largest_real_eigenvalue([&](const Eigen::VectorXd& x) { return moments.after_a_step(x); },
                                 moments.of_white_noise());
}

}  // namespace modebank
