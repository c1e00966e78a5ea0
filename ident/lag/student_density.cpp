#include "ident/lag/student_density.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "ident/fit/constants.hpp"
#include "ident/fit/scale.hpp"

namespace modebank {
namespace {

using Eigen::ArrayXd;
using Eigen::VectorXd;

constexpr std::array degrees_tried{2.0, 4.0, 8.0, 30.0, 1000.0};
constexpr int most_steps = 100;
constexpr double tolerance = 1e-9;  // relative tolerance of the squared scale

/// Maximum-likelihood squared scale, by expectation-maximisation with an expanded parameter (Liu, Rubin & Wu 1998).
double fitted_square(const ArrayXd& squares, double degrees, double start, double least) {
  double s = start;
  for (int step = 0; step < most_steps; ++step) {
    const ArrayXd precision = (degrees + squares / s).inverse();
    const double next = std::max((precision * squares).mean() / precision.mean(), least);
    const bool settled = std::abs(next - s) <= tolerance * s;
    s = next;
    if (settled) break;
  }
  return s;
}

ArrayXd log_density(const ArrayXd& squares, double degrees, double s) {
  const double constant =
      std::lgamma(0.5 * (degrees + 1.0)) - std::lgamma(0.5 * degrees) - 0.5 * std::log(degrees * std::numbers::pi * s);
  return constant - 0.5 * (degrees + 1.0) * (1.0 + squares / (degrees * s)).log();
}

}  // namespace

VectorXd fitted_student_log_density(const VectorXd& errors, double floor) {
  const ArrayXd squares = errors.array().square();
  const double least = floor * floor;
  const double robust = mad_to_sd * median(errors.cwiseAbs());
  double s = std::max(robust * robust, least);
  ArrayXd best;
  double most = 0.0;
  for (const double degrees : degrees_tried) {
    s = fitted_square(squares, degrees, s, least);
    ArrayXd density = log_density(squares, degrees, s);
    const double mean = density.mean();
    if (best.size() > 0 && !(mean > most)) continue;
    most = mean;
    best = std::move(density);
  }
  return best.matrix();
}

}  // namespace modebank
