#pragma once

#include <Eigen/Core>
#include <memory>

#include "filter/bank.hpp"
#include "filter/evaluate.hpp"
#include "filter/vector_imm_kernels.hpp"

namespace modebank {

/// The interacting multiple model filter with a mode per lane of the processor's vector registers (Highway, chosen for
/// the machine at run time), for the sizes most robots have. It computes what FilterStep computes, to rounding: the
/// same mixing, floors, adaptive noise and treatment of impossible modes, in another order of summation. Call start,
/// then for each step `skip` (nothing measured in between) or predict and update. Allocates nothing after construction.
class VectorImm {
 public:
  using Vector = Eigen::Ref<const Eigen::VectorXd>;

  /// Whether there are kernels for this bank run in this way.
  static bool can_step(const Bank& bank, const FilterOptions& options);
  /// Requires can_step(bank, options) and check_sizes(bank).
  VectorImm(const Bank& bank, const FilterOptions& options);
  VectorImm(const VectorImm& other);
  VectorImm(VectorImm&&) noexcept = default;
  VectorImm& operator=(const VectorImm& other) { return *this = VectorImm(other); }
  VectorImm& operator=(VectorImm&&) noexcept = default;
  ~VectorImm() = default;

  Eigen::Index modes() const { return K_; }
  Eigen::Index states() const { return n_; }

  /// x[0] = start_gain y[0] and so on, as start of filter_step.hpp does.
  void start(const Vector& y);
  /// A step without a measurement. `v`: acting inputs.
  void skip(const Vector& v);
  void predict(const Vector& v);
  /// Log predictive density of the signals of y that are there (NaN: missing); NaN without any.
  double update(const Vector& y);

  /// After predict: moments of the predicted mixture, and the modes' share in the trace of S. Symmetric matrices.
  void combine(Eigen::Ref<Eigen::VectorXd> state, Eigen::Ref<Eigen::MatrixXd> innovation_covariance,
               double& spread_share);
  auto predicted_probability() const { return row(rows_.predicted_probability); }
  auto mode_probability() const { return row(rows_.probability); }
  /// After update: signal i of mode j's innovation without what earlier signals explain, and its variance.
  double decorrelated(Eigen::Index i, Eigen::Index j) const { return rows_.decorrelated[at(i, j)]; }
  double variance(Eigen::Index i, Eigen::Index j) const { return rows_.D[at(i, j)]; }
  /// After update with the same y: its probability integral transform (combined.hpp), n_y.
  void transform(const Vector& y, Eigen::Ref<Eigen::VectorXd> pit) const;
  /// Moments of the mixture as it stands.
  void merge(Eigen::Ref<Eigen::VectorXd> mean, Eigen::Ref<Eigen::MatrixXd> covariance);

  /// The state, mode by mode; n x K and n*n x K.
  void get(Eigen::MatrixXd& means, Eigen::MatrixXd& covariances, Eigen::VectorXd& probability) const;
  void set(const Eigen::MatrixXd& means, const Eigen::MatrixXd& covariances, const Eigen::VectorXd& probability);
  double noise_scale = 1.0, noise_samples = 0.0;

 private:
  struct Free {
    void operator()(double* memory) const;
  };

  Eigen::Index n_, n_y_, K_;
  bool adaptive_;
  NoiseAdaptation adaptation_;
  vector_imm::Kernels kernels_;
  std::unique_ptr<double[], Free> memory_;
  vector_imm::ModeRows rows_;  // within memory_, numbers_ of them
  std::size_t numbers_ = 0;
  Eigen::MatrixXd C_, R_;                  // transposed: row-major
  Eigen::MatrixXd partial_C_, partial_R_;  // of the signals that are there
  Eigen::VectorXd y_, packed_;
  Eigen::MatrixXd start_gain_, start_covariance_;
  Eigen::VectorXd initial_probability_, start_;

  std::size_t at(Eigen::Index i, Eigen::Index j) const {
    return static_cast<std::size_t>(i) * rows_.stride + static_cast<std::size_t>(j);
  }
  Eigen::Map<const Eigen::VectorXd> row(const double* first) const { return {first, K_}; }
  void lay_out();
  void fill(const Bank& bank);
  vector_imm::Sensor detach_missing(const Vector& y);
};

}  // namespace modebank
