// The public API of clustering: converts between plain vectors and Eigen.
#include "ident/base/api.hpp"

#include <cmath>
#include <stdexcept>

#include "mixture/from_internal.hpp"
#include "mixture/select.hpp"
#include "modebank/base/eigen.hpp"

namespace modebank {

mixture::Mixture from_internal(const GaussianMixture& given) {
  mixture::Mixture result{to_vector(given.weights), to_matrix(given.means), {}, given.noise.weight, {}, {}};
  for (const Eigen::MatrixXd& covariance : given.covariances) result.covariances.push_back(to_matrix(covariance));
  result.noise_lower = to_vector(given.noise.lower);
  result.noise_upper = to_vector(given.noise.upper);
  return result;
}

GaussianMixture to_internal(const mixture::Mixture& given) {
  GaussianMixture result;
  check_filled(given.means, "means");
  result.weights = view(given.weights);
  result.means = view(given.means);
  for (const Matrix& covariance : given.covariances) {
    check_filled(covariance, "a covariance");
    result.covariances.emplace_back(view(covariance));
  }
  result.noise = {given.noise_weight, view(given.noise_lower), view(given.noise_upper)};
  check_sizes(result);
  return result;
}

namespace mixture {

namespace {

Eigen::MatrixXd filled(const Matrix& matrix, const char* name) {
  check_filled(matrix, name);
  return view(matrix);
}

}  // namespace

Clusters select(const Points& points, const SelectionOptions& options, std::uint64_t seed) {
  return api_call([&] {
    const Eigen::MatrixXd values = filled(points.values, "values"), errors = filled(points.errors, "errors");
    const Eigen::VectorXd weights = view(points.weights), typical_error = view(points.typical_error);
    const PointSet set(values, weights, errors, typical_error);
    const Selection found = modebank::select(set, points.effective_samples, options, seed);
    return Clusters{from_internal(found.mixture), found.candidates,
                    to_matrix(modebank::responsibilities(found.mixture, set))};
  });
}

Matrix responsibilities(const Mixture& mixture, const Matrix& points) {
  return api_call(
      [&] { return to_matrix(modebank::responsibilities(to_internal(mixture), filled(points, "points"))); });
}

std::vector<double> log_density(const Mixture& mixture, const Matrix& points) {
  return api_call([&] { return to_vector(modebank::log_density(to_internal(mixture), filled(points, "points"))); });
}

}  // namespace mixture

}  // namespace modebank
