#include "ident/fit/loss.hpp"

#include <ceres/loss_function.h>

#include <cmath>
#include <stdexcept>
#include <string>

#include "ident/base/distributions.hpp"
#include "ident/fit/constants.hpp"

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
      return huber_tuning;
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
  const auto integrand = [&](double r) {
    const double s = r * r;
    return loss(s).weight * s * chi_square_density(s, static_cast<double>(states)) * 2.0 * r;
  };
  // The integral is split at the kink of Huber's and Tukey's weights. Less than 1e-20 of the mass of the chi
  // distribution lies beyond `end`.
  const double kink = loss.scale(), end = std::sqrt(static_cast<double>(states)) + 10.0;
  const double tail = kink < end ? integrate(integrand, kink, end) : 0.0;
  return (integrate(integrand, 0.0, std::min(kink, end)) + tail) / static_cast<double>(states);
}

}  // namespace modebank
