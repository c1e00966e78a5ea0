#pragma once

#include <Eigen/Core>
#include <memory>

#include "filter/step/bank.hpp"
#include "modebank/filter/options.hpp"

namespace modebank {

struct FilterMemory;

/// A bank's filter, whatever its sizes and variant: by the equations (equations/filter_step.hpp) or, where there are
/// vector kernels for it, a mode per lane (detail/vector). The two agree to rounding. Call start, then for each sample
/// advance and update, or follow. Allocates nothing after construction.
class Stepper {
 public:
  using Vector = Eigen::Ref<const Eigen::VectorXd>;
  using Columns = Eigen::Ref<const Eigen::MatrixXd>;

  virtual ~Stepper() = default;
  /// From the first measurement `y`; with lags the first whole z of measurements.
  virtual void start(const Vector& y) = 0;
  /// One model step under the acting inputs `v`: with predict a measurement may follow, with skip none does.
  virtual void predict(const Vector& v) = 0;
  virtual void skip(const Vector& v) = 0;
  /// Takes `y` in and returns the log predictive density [nats] of its signals that are there; NaN without any.
  virtual double update(const Vector& y) = 0;
  /// predict and update for a stretch of samples, each a step after the one before: log predictive densities of
  /// `measurements` (n_y x samples) reached under `inputs` (acting inputs x samples).
  virtual void follow(const Columns& inputs, const Columns& measurements, Eigen::Ref<Eigen::VectorXd> log_density) {
    for (Eigen::Index k = 0; k < measurements.cols(); ++k) {
      predict(inputs.col(k));
      log_density(k) = update(measurements.col(k));
    }
  }
  /// From the sample before to the prediction of the next, `steps` model steps later.
  void advance(const Vector& v, Eigen::Index steps) {
    for (Eigen::Index i = 1; i < steps; ++i) skip(v);
    predict(v);
  }

  /// After predict: moments of the predicted mixture, n and n_y x n_y. Returns the modes' share in the trace of S.
  virtual double combine(Eigen::Ref<Eigen::VectorXd> state, Eigen::Ref<Eigen::MatrixXd> innovation_covariance) = 0;
  /// After update with the same y: its probability integral transform (predicted_mixture.hpp), n_y. `width`: of the
  /// interval whose middle pit is; left as it is where nothing is quantised.
  virtual void transform(const Vector& y, Eigen::Ref<Eigen::VectorXd> pit, Eigen::Ref<Eigen::VectorXd> width) = 0;
  /// Moments of the mixture as it stands, n and n x n.
  virtual void merge(Eigen::Ref<Eigen::VectorXd> mean, Eigen::Ref<Eigen::MatrixXd> covariance) = 0;
  virtual Eigen::Map<const Eigen::VectorXd> predicted_probability() const = 0;  ///< K
  virtual Eigen::Map<const Eigen::VectorXd> mode_probability() const = 0;       ///< K

  virtual void save(FilterMemory& memory) const = 0;
  /// `memory`: of a filter of the same sizes.
  virtual void restore(const FilterMemory& memory) = 0;

 protected:
  Stepper() = default;
  Stepper(const Stepper&) = default;
  Stepper& operator=(const Stepper&) = default;
};

/// Requires check_sizes(bank). Throws std::invalid_argument for options that this bank cannot be stepped by.
std::unique_ptr<Stepper> make_stepper(const Bank& bank, const FilterOptions& options);

}  // namespace modebank
