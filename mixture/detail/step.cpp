#include "mixture/detail/step.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <vector>

#include "mixture/detail/density.hpp"
#include "mixture/detail/whole_loop.hpp"

namespace modebank {

using Eigen::Index;

namespace {

constexpr Index blocks_per_group = 32;
/// If there are fewer points, a pass is too short to use several threads. Restarts and candidates run in parallel
/// instead.
constexpr Index parallel_points = 20000;
constexpr double starved_share = 1e-14;

MixtureMoments expect_group(const PointBlocks& points, const FactoredMixture& mixture, const double* background,
                            bool with_sums, Index first, Index last) {
  const em::Components components = mixture.components();
  const em::Kernels& kernels = mixture.kernels();
  KernelScratch memory(mixture);
  AlignedBuffer stage = points.stage();
  if (mixture.has_noise()) std::fill_n(memory.noise(), block_size, mixture.log_noise());
  for (Index b = first; b < last; ++b) {
    em::Block block = points.block(b, stage);
    block.noise = background ? background + b * block_size : mixture.has_noise() ? memory.noise() : nullptr;
    (with_sums ? kernels.accumulate : kernels.measure)(components, block, memory.scratch());
  }
  MixtureMoments moments;
  moments.sums.resize(with_sums ? kernels.entries : 0, components.count);
  const double* const lanes = memory.scratch().lanes;
  const Index lane_count = em::lanes();
  em::reduce_lanes(lanes, 1, &moments.log_likelihood);
  em::reduce_lanes(lanes + lane_count, 1, &moments.noise);
  em::reduce_lanes(lanes + 2 * lane_count, moments.sums.size(), moments.sums.data());
  return moments;
}

/// Mean and covariance of one component from its sums; `offset` is the new mean minus the old one.
void update_component(const Eigen::Ref<const Eigen::VectorXd>& sums, bool diagonal, Eigen::VectorXd& offset,
                      Eigen::MatrixXd& covariance) {
  const Index features = offset.size();
  offset = sums.segment(1, features) / sums(0);
  covariance.setZero(features, features);
  Index row = 1 + features;
  for (Index i = 0; i < features; ++i)
    for (Index j = diagonal ? i : 0; j <= i; ++j, ++row)
      covariance(i, j) = covariance(j, i) = sums(row) / sums(0) - offset(i) * offset(j);
}

MixtureMoments pass(const PointBlocks& points, const FactoredMixture& factored, const double* background,
                    bool with_sums) {
  const Index groups = (points.blocks() + blocks_per_group - 1) / blocks_per_group;
  std::vector<MixtureMoments> partial(groups);
  const auto group = [&](Index g) {
    const Index first = g * blocks_per_group;
    partial[g] = expect_group(points, factored, background, with_sums, first,
                              std::min(first + blocks_per_group, points.blocks()));
  };
  if (points.count() > parallel_points) {
    tbb::parallel_for(Index(0), groups, group);
    require_whole_loop();
  } else {
    for (Index g = 0; g < groups; ++g) group(g);
  }
  for (Index g = 1; g < groups; ++g) {
    partial[0].log_likelihood += partial[g].log_likelihood;
    partial[0].noise += partial[g].noise;
    partial[0].sums += partial[g].sums;
  }
  return std::move(partial[0]);
}

}  // namespace

MixtureMoments expect(const PointBlocks& points, const GaussianMixture& mixture, const double* background) {
  const FactoredMixture factored(mixture, points.has_errors());
  MixtureMoments moments = pass(points, factored, background, true);
  for (Index k = 0; k < mixture.components(); ++k) factored.to_plain_sums(k, moments.sums.col(k));
  return moments;
}

MixtureMoments measure(const PointBlocks& points, const GaussianMixture& mixture) {
  return pass(points, FactoredMixture(mixture, points.has_errors()), nullptr, false);
}

bool maximise(const MixtureMoments& moments, double floor, GaussianMixture& mixture) {
  const Eigen::VectorXd mass = moments.sums.row(0);
  const double total = mass.sum() + moments.noise;
  if (mixture.noise.present()) mixture.noise.weight = moments.noise / total;
  const bool diagonal = mixture.type == CovarianceType::diagonal;
  Eigen::VectorXd offset(mixture.features());
  bool floor_active = false;
  for (Index k = 0; k < mixture.components(); ++k) {
    mixture.weights(k) = mass(k) / total;
    if (!(mixture.weights(k) > starved_share)) continue;
    update_component(moments.sums.col(k), diagonal, offset, mixture.covariances[k]);
    mixture.means.col(k) += offset;
    floor_active |= raise_to_floor(mixture.covariances[k], floor, mixture.type);
  }
  return floor_active;
}

}  // namespace modebank
