#pragma once

#include <Eigen/Core>

#include "filter/step/drifting_recursion.hpp"
#include "filter/step/stepper.hpp"

namespace modebank {

/// One mode that drifts, with running noise. The state is z with the newest measured value (or the prediction if it is
/// missing). State covariances are zero; the innovation covariance is diagonal. pit uses Student's distribution, output
/// by output (Rosenblatt 1952) where the noise has several levels. The running variance of rounded outputs contains
/// their rounding.
class DriftingStepper final : public Stepper {
 public:
  explicit DriftingStepper(const Bank& bank);

  void start(const Vector& y) override { recursion_.start(y); }
  void predict(const Vector& v) override { recursion_.predict(v); }
  void skip(const Vector& v) override;
  double update(const Vector& y) override { return recursion_.update(y); }

  void combine(Eigen::Ref<Eigen::VectorXd> state, Eigen::Ref<Eigen::MatrixXd> innovation_covariance) override;
  /// `update` has returned the masses of intervals, so the log density stays.
  void transform(const Vector& y, Eigen::Ref<Eigen::VectorXd> pit, Eigen::Ref<Eigen::VectorXd> width,
                 double& log_density) override;
  void merge(Eigen::Ref<Eigen::VectorXd> mean, Eigen::Ref<Eigen::MatrixXd> covariance) override;
  Eigen::Map<const Eigen::VectorXd> predicted_probability() const override { return mode_probability(); }
  Eigen::Map<const Eigen::VectorXd> mode_probability() const override { return {one_.data(), one_.size()}; }

  void save(FilterMemory& memory) const override;
  void restore(const FilterMemory& memory) override;

 private:
  DriftingRecursion recursion_;
  Eigen::VectorXd weight_;  ///< probabilities of the noise levels
  Eigen::VectorXd one_ = Eigen::VectorXd::Ones(1);
};

}  // namespace modebank
