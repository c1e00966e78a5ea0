#include "mixture/window_responsibilities.hpp"

#include <algorithm>
#include <stdexcept>

#include "ident/base/not_a_number.hpp"

namespace modebank {

using Eigen::Index;

namespace {

void check_order(const FeatureCloud& cloud, Index windows) {
  const bool increasing = std::is_sorted(cloud.windows.begin(), cloud.windows.end(), std::less_equal<>());
  if (!increasing || (!cloud.windows.empty() && (cloud.windows.front() < 0 || cloud.windows.back() >= windows)))
    throw std::invalid_argument("the windows of a cloud must be strictly increasing");
}

/// Fills the columns of `result` that belong to windows first to first + count - 1 of the cloud.
void fill_block(const GaussianMixture& mixture, const FeatureCloud& cloud, Index first, Index count,
                Eigen::MatrixXd& result) {
  const auto begin = std::lower_bound(cloud.windows.begin(), cloud.windows.end(), first);
  const auto end = std::lower_bound(begin, cloud.windows.end(), first + count);
  const Index from = begin - cloud.windows.begin(), points = end - begin;
  if (points == 0) return;
  const Eigen::MatrixXd part = cloud.points.middleCols(from, points);
  Eigen::MatrixXd errors;
  if (cloud.covariances.size() > 0) errors = cloud.covariances.middleCols(from, points);
  const PointSet set(part, detail::no_weights, errors);
  visit_responsibilities(mixture, set, [&](Index at, const Eigen::Ref<const Eigen::MatrixXd>& columns) {
    for (Index i = 0; i < columns.cols(); ++i) result.col(*(begin + at + i) - first) = columns.col(i);
  });
}

}  // namespace

WindowResponsibilities::WindowResponsibilities(GaussianMixture mixture, FeatureCloud clustered, FeatureCloud assigned,
                                               Index windows)
    : windows_(windows) {
  check_order(clustered, windows);
  check_order(assigned, windows);
  // With few components the responsibilities take less memory than the inputs from which they are computed, so they are
  // stored.
  const Index kept_of_a_point = clustered.points.rows() + clustered.covariances.rows() + 1;
  const bool small = mixture.components() * windows <=
                     kept_of_a_point * static_cast<Index>(clustered.windows.size() + assigned.windows.size());
  for (FeatureCloud* cloud : {&clustered, &assigned}) std::vector<Index>().swap(cloud->runs);
  source_ = std::make_shared<const Source>(Source{std::move(mixture), {std::move(clustered), std::move(assigned)}});
  if (!small) return;
  stored_ = all();
  source_.reset();
}

Index WindowResponsibilities::components() const { return sums_.size() > 0 ? sums_.rows() : fitted(); }

Eigen::MatrixXd WindowResponsibilities::block(Index first, Index count) const {
  const Eigen::MatrixXd result = fitted_block(first, count);
  return sums_.size() > 0 ? Eigen::MatrixXd(sums_ * result) : result;
}

WindowResponsibilities WindowResponsibilities::merged(Index into, Index absorbed) && {
  Eigen::MatrixXd sums = sums_.size() > 0 ? sums_ : Eigen::MatrixXd(Eigen::MatrixXd::Identity(fitted(), fitted()));
  sums.row(into) += sums.row(absorbed);
  const Index later = sums.rows() - absorbed - 1;
  sums.middleRows(absorbed, later) = sums.bottomRows(later).eval();
  sums_ = sums.topRows(sums.rows() - 1);
  return std::move(*this);
}

Eigen::MatrixXd WindowResponsibilities::fitted_block(Index first, Index count) const {
  if (first < 0 || count < 0 || first + count > windows_) throw std::invalid_argument("windows out of range");
  if (!source_) return stored_.middleCols(first, count);
  Eigen::MatrixXd result = Eigen::MatrixXd::Constant(fitted(), count, not_a_number);
  for (const FeatureCloud& cloud : source_->clouds) fill_block(source_->mixture, cloud, first, count, result);
  return result;
}

void label_windows(const GaussianMixture& mixture, const FeatureCloud& cloud, Eigen::VectorXi& labels) {
  visit_responsibilities(mixture, cloud.point_set(), [&](Index first, const Eigen::Ref<const Eigen::MatrixXd>& block) {
    for (Index i = 0; i < block.cols(); ++i) {
      int component = 0;
      const double largest = block.col(i).maxCoeff(&component);
      const bool noise = mixture.noise.present() && 1.0 - block.col(i).sum() > largest;
      labels(cloud.windows[static_cast<std::size_t>(first + i)]) = noise ? -1 : component;
    }
  });
}

}  // namespace modebank
