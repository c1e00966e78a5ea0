#pragma once

#include <Eigen/Core>
#include <memory>

#include "filter/step/bank.hpp"
#include "modebank/filter/options.hpp"

namespace modebank {

struct FilterMemory;

/// A bank's filter for any size and variant (equations/filter_step.hpp). Call `start` first. Then call `advance` and
/// `update` for each sample. Allocates only at construction.
class Stepper {
 public:
  using Vector = Eigen::Ref<const Eigen::VectorXd>;

  virtual ~Stepper() = default;
  /// Starts from the first measurement `y`; with lags, from the first complete z.
  virtual void start(const Vector& y) = 0;
  /// One model step under the acting inputs `v`. After `predict` a measurement may follow; after `skip` none follows.
  virtual void predict(const Vector& v) = 0;
  virtual void skip(const Vector& v) = 0;
  /// Updates with `y`. Returns the log predictive density [nats] of the available signals; NaN if there are none.
  virtual double update(const Vector& y) = 0;
  /// Advances from the previous sample to the prediction of the next sample, which is `steps` model steps later.
  void advance(const Vector& v, Eigen::Index steps) {
    for (Eigen::Index i = 1; i < steps; ++i) skip(v);
    predict(v);
  }

  /// Moments of the predicted mixture, n and n_y x n_y. Call after `predict`.
  virtual void combine(Eigen::Ref<Eigen::VectorXd> state, Eigen::Ref<Eigen::MatrixXd> innovation_covariance) = 0;
  /// Probability integral transform of y (predicted_mixture.hpp), n_y. Call after `update` with the same y. `width`:
  /// width of the interval whose middle is `pit`; unchanged if no signal is rounded. `log_density`: that of `update`;
  /// if signals are rounded it becomes that of their intervals.
  virtual void transform(const Vector& y, Eigen::Ref<Eigen::VectorXd> pit, Eigen::Ref<Eigen::VectorXd> width,
                         double& log_density) = 0;
  /// Moments of the present mixture, n and n x n.
  virtual void merge(Eigen::Ref<Eigen::VectorXd> mean, Eigen::Ref<Eigen::MatrixXd> covariance) = 0;
  virtual Eigen::Map<const Eigen::VectorXd> predicted_probability() const = 0;  ///< K
  virtual Eigen::Map<const Eigen::VectorXd> mode_probability() const = 0;       ///< K

  virtual void save(FilterMemory& memory) const = 0;
  /// `memory`: memory of a filter with the same sizes.
  virtual void restore(const FilterMemory& memory) = 0;

 protected:
  Stepper() = default;
  Stepper(const Stepper&) = default;
  Stepper& operator=(const Stepper&) = default;
};

/// Requires check_sizes(bank). Throws std::invalid_argument for options that do not suit this bank.
std::unique_ptr<Stepper> make_stepper(const Bank& bank, const FilterOptions& options);

}  // namespace modebank
