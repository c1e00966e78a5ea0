#include "mixture/window_over_switch.hpp"

#include "ident/base/distributions.hpp"

namespace modebank {
namespace {

using Eigen::Index;
constexpr double significance = 0.99;

/// Smallest distance, in windows, between two windows that share no transition.
Index neighbour_offset(const WindowFits& fits) { return (fits.length + fits.step - 1) / fits.step; }

bool same_run(const WindowFits& fits, Index a, Index b) {
  return fits.windows[static_cast<std::size_t>(a)].run == fits.windows[static_cast<std::size_t>(b)].run;
}

}  // namespace

std::vector<bool> windows_over_switch(const WindowFits& fits) {
  std::vector<bool> over_switch(static_cast<std::size_t>(fits.count()), false);
  const auto unknowns = static_cast<double>(fits.parameter_count()) / static_cast<double>(fits.structure.states);
  const double freedom = static_cast<double>(fits.length) - unknowns;  // degrees of freedom per state
  if (freedom <= 0.0) return over_switch;
  const double threshold = fisher_quantile(significance, freedom, freedom);
  const Index offset = neighbour_offset(fits);
  for (Index i = offset; i + offset < fits.count(); ++i) {
    if (!same_run(fits, i - offset, i) || !same_run(fits, i, i + offset)) continue;
    const Eigen::ArrayXd calm =
        fits.noise_variance.col(i - offset).cwiseMax(fits.noise_variance.col(i + offset)).array();
    over_switch[static_cast<std::size_t>(i)] = (fits.noise_variance.col(i).array() > threshold * calm).any();
  }
  return over_switch;
}

}  // namespace modebank
