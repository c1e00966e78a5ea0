#include "ident/robust_loss.hpp"

#include <ceres/loss_function.h>

#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/quadrature/gauss_kronrod.hpp>
#include <cmath>
#include <stdexcept>
#include <string>

#include "ident/fit_window.hpp"

namespace modebank {

namespace {

std::unique_ptr<ceres::LossFunction> make_function(Loss loss, double c) {
  switch (loss) {
    case Loss::trivial:
      return std::make_unique<ceres::TrivialLoss>();
    case Loss::huber:
      return std::make_unique<ceres::HuberLoss>(c);
    case Loss::cauchy:
      return std::make_unique<ceres::CauchyLoss>(c);
    case Loss::softlone:
      return std::make_unique<ceres::SoftLOneLoss>(c);
    case Loss::tukey:
      return std::make_unique<ceres::TukeyLoss>(c);
    case Loss::arctan:
      return std::make_unique<ceres::ArctanLoss>(c * c);
  }
  throw std::invalid_argument("unknown loss " + std::to_string(static_cast<int>(loss)));
}

}  // namespace

double default_loss_scale(Loss loss) {
  switch (loss) {
    case Loss::trivial:
      return 1.0;
    case Loss::huber:
      return 1.345;
    case Loss::cauchy:
      return 2.385;
    case Loss::softlone:
      return 1.287;
    case Loss::tukey:
      return 4.685;
    case Loss::arctan:
      return 2.571;
  }
  throw std::invalid_argument("unknown loss " + std::to_string(static_cast<int>(loss)));
}

RobustLoss::RobustLoss(Loss loss, double scale) : kind_(loss), scale_(scale == 0.0 ? default_loss_scale(loss) : scale) {
  if (!(scale_ > 0.0 && std::isfinite(scale_)))
    throw std::invalid_argument("loss scale " + std::to_string(scale) + " is not positive");
  function_ = make_function(kind_, scale_);
}

RobustLoss::~RobustLoss() = default;
RobustLoss::RobustLoss(RobustLoss&&) noexcept = default;
RobustLoss& RobustLoss::operator=(RobustLoss&&) noexcept = default;

LossValue RobustLoss::operator()(double s) const {
  double rho[3];
  function_->Evaluate(s, rho);
  return {rho[0], rho[1], rho[2]};
}

double gaussian_consistency(const RobustLoss& loss, Eigen::Index states) {
  if (loss.kind() == Loss::trivial) return 1.0;
  const boost::math::chi_squared density(static_cast<double>(states));
  const auto integrand = [&](double r) {
    const double s = r * r;
    return loss(s).weight * s * boost::math::pdf(density, s) * 2.0 * r;
  };
  using Quadrature = boost::math::quadrature::gauss_kronrod<double, 61>;
  // Split at the kink of Huber's and Tukey's weights; beyond the end chi has less than 1e-20 of its mass.
  const double kink = loss.scale(), end = std::sqrt(static_cast<double>(states)) + 10.0;
  const double tail = kink < end ? Quadrature::integrate(integrand, kink, end) : 0.0;
  return (Quadrature::integrate(integrand, 0.0, std::min(kink, end)) + tail) / static_cast<double>(states);
}

}  // namespace modebank
