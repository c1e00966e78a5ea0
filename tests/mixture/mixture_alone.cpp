// The mixture library alone, without windows or files. Draws points from a known mixture and fits a mixture to them.
// Exit status 0 if the fitted mixture equals the known one.
#include <cstdio>
#include <random>

#include "mixture/select.hpp"

int main() {
  modebank::GaussianMixture truth;
  truth.weights = Eigen::Vector2d(0.7, 0.3);
  truth.means = (Eigen::MatrixXd(2, 2) << 0.0, 4.0, 0.0, 4.0).finished();
  truth.covariances.assign(2, Eigen::Matrix2d::Identity());
  std::mt19937_64 generator(1);
  const Eigen::MatrixXd points = modebank::sample(truth, 500, generator);

  modebank::SelectionOptions options;
  options.components = {1, 2, 3, 4};
  const modebank::Selection found = modebank::select(points, 0.0, options, 1);
  for (const modebank::Candidate& row : found.candidates)
    std::printf("K = %td: BIC %.1f%s\n", row.components, row.bic, row.selected ? "  <- selected" : "");
  for (Eigen::Index k = 0; k < found.mixture.components(); ++k) std::printf("weight %.3f\n", found.mixture.weights(k));

  const Eigen::MatrixXd memberships = modebank::responsibilities(found.mixture, points);
  const modebank::EmResult refit = modebank::fit_em(points, found.mixture, options.em);
  std::printf("log density %.3f per point, %.1f points in the first component\n",
              modebank::log_density(refit.mixture, points).mean(), memberships.row(0).sum());
  return found.mixture.components() == 2 ? 0 : 1;
}
