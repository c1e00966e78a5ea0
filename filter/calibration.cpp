#include "filter/calibration.hpp"

#include <algorithm>
#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/normal.hpp>
#include <cmath>
#include <limits>

#include "ident/not_a_number.hpp"

namespace modebank {

namespace {

using boost::math::chi_squared;

std::size_t lag_count(std::size_t samples) { return std::min<std::size_t>(20, samples / 5); }

double chi_square_upper(double value, double degrees_of_freedom) {
  return boost::math::cdf(boost::math::complement(chi_squared(degrees_of_freedom), value));
}

}  // namespace

double chi_square_quantile(double probability, double degrees_of_freedom) {
  return boost::math::quantile(chi_squared(degrees_of_freedom), probability);
}

double normal_score(double pit) {
  constexpr double clip = 1e-15;
  return boost::math::quantile(boost::math::normal(), std::clamp(pit, clip, 1.0 - clip));
}

double kolmogorov_distance(std::vector<double> values) {
  if (values.empty()) return not_a_number;
  std::sort(values.begin(), values.end());
  const double count = static_cast<double>(values.size());
  double distance = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double below = static_cast<double>(i) / count, above = static_cast<double>(i + 1) / count;
    distance = std::max({distance, above - values[i], values[i] - below});
  }
  return distance;
}

double ljung_box_p(const std::vector<double>& series) {
  const std::size_t lags = lag_count(series.size());
  if (lags < 1) return not_a_number;
  const Eigen::Index N = static_cast<Eigen::Index>(series.size());
  const Eigen::Map<const Eigen::ArrayXd> z(series.data(), N);
  const Eigen::ArrayXd centred = z - z.mean();
  const double variance = centred.square().sum();
  if (!(variance > 0.0)) return not_a_number;
  double Q = 0.0;
  for (Eigen::Index k = 1; k <= static_cast<Eigen::Index>(lags); ++k) {
    const double r_k = (centred.head(N - k) * centred.tail(N - k)).sum() / variance;
    Q += r_k * r_k / static_cast<double>(N - k);
  }
  return chi_square_upper(static_cast<double>(N) * static_cast<double>(N + 2) * Q, static_cast<double>(lags));
}

double fisher_p(const std::vector<double>& p_values) {
  double statistic = 0.0, degrees_of_freedom = 0.0;
  for (const double p : p_values) {
    if (std::isnan(p)) continue;
    statistic -= 2.0 * std::log(std::max(p, std::numeric_limits<double>::min()));
    degrees_of_freedom += 2.0;
  }
  return degrees_of_freedom > 0.0 ? chi_square_upper(statistic, degrees_of_freedom) : not_a_number;
}

}  // namespace modebank
