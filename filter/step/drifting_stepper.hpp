#pragma once

#include <Eigen/Core>
#include <cmath>

#include "filter/step/drifting_recursion.hpp"
#include "filter/step/stepper.hpp"
#include "filter/step/student_noise.hpp"

namespace modebank {

/// One mode that drifts, with running noise. The state is z with the newest measured value (or the prediction if it is
/// missing). State covariances are zero; the innovation covariance is diagonal. pit uses Student's distribution. The
/// log density is the sum over outputs. For quantised outputs it is log (mass of the interval / q).
class DriftingStepper final : public Stepper {
 public:
  explicit DriftingStepper(const Bank& bank);

  void start(const Vector& y) override { recursion_.start(y); }
  void predict(const Vector& v) override { recursion_.predict(v); }
  void skip(const Vector& v) override;
  double update(const Vector& y) override;

  void combine(Eigen::Ref<Eigen::VectorXd> state, Eigen::Ref<Eigen::MatrixXd> innovation_covariance) override;
  void transform(const Vector& y, Eigen::Ref<Eigen::VectorXd> pit, Eigen::Ref<Eigen::VectorXd> width) override;
  void merge(Eigen::Ref<Eigen::VectorXd> mean, Eigen::Ref<Eigen::MatrixXd> covariance) override;
  Eigen::Map<const Eigen::VectorXd> predicted_probability() const override { return mode_probability(); }
  Eigen::Map<const Eigen::VectorXd> mode_probability() const override { return {one_.data(), one_.size()}; }

  void save(FilterMemory& memory) const override;
  void restore(const FilterMemory& memory) override;

 private:
  DriftingRecursion recursion_;
  StudentNoise noise_;
  Eigen::VectorXd quantum_;  ///< n, quanta; 0 for a continuous signal
  Eigen::VectorXd one_ = Eigen::VectorXd::Ones(1);

  /// Standard deviation of the prediction's error. The update does not change it.
  double deviation(Eigen::Index i) const { return std::sqrt(recursion_.variance()(i)); }
};

}  // namespace modebank
