#pragma once

#include <Eigen/Core>
#include <memory>

#include "filter/step/detail/vector/kernels.hpp"
#include "filter/step/stepper.hpp"

namespace modebank {

namespace vector_imm {
inline std::size_t count_of(Eigen::Index n) { return static_cast<std::size_t>(n); }
}  // namespace vector_imm

/// The interacting multiple model filter for the sizes of most robots, with one mode per lane of the vector registers
/// (Highway, chosen at run time). Mixing, floors, adaptive noise and treatment of impossible modes are those of
/// equations/filter_step.hpp. Results differ only by rounding, because sums have another order.
class VectorImm final : public Stepper {
 public:
  /// Whether kernels exist for this bank with these options.
  static bool can_step(const Bank& bank, const FilterOptions& options);
  /// Requires can_step(bank, options) and check_sizes(bank).
  VectorImm(const Bank& bank, const FilterOptions& options);

  void start(const Vector& y) override;
  void predict(const Vector& v) override;
  void skip(const Vector& v) override;
  double update(const Vector& y) override;
  void follow(const Columns& inputs, const Columns& measurements, Eigen::Ref<Eigen::VectorXd> log_density) override;

  void combine(Eigen::Ref<Eigen::VectorXd> state, Eigen::Ref<Eigen::MatrixXd> innovation_covariance) override;
  void transform(const Vector& y, Eigen::Ref<Eigen::VectorXd> pit, Eigen::Ref<Eigen::VectorXd> width) override;
  void merge(Eigen::Ref<Eigen::VectorXd> mean, Eigen::Ref<Eigen::MatrixXd> covariance) override;
  Eigen::Map<const Eigen::VectorXd> predicted_probability() const override { return row(rows_.predicted_probability); }
  Eigen::Map<const Eigen::VectorXd> mode_probability() const override { return row(rows_.probability); }
  /// Call after `update`. Innovation of signal i of mode j, minus its prediction from earlier signals; and the variance
  /// of this difference.
  double decorrelated(Eigen::Index i, Eigen::Index j) const { return rows_.decorrelated[at(i, j)]; }
  double variance(Eigen::Index i, Eigen::Index j) const { return rows_.D[at(i, j)]; }
  double noise_scale() const { return noise_scale_; }

  void save(FilterMemory& memory) const override;
  void restore(const FilterMemory& memory) override;

 private:
  friend class VectorGradient;  // computes the adjoint of these steps
  struct Free {
    void operator()(double* memory) const;
  };

  Eigen::Index n_, n_y_, K_;
  bool adaptive_;
  Eigen::VectorXd quantum_, partial_quantum_;  // empty if no signal is quantised
  NoiseAdaptation adaptation_;
  NoiseFactor factor_;                              // empty without a noise factor
  double applied_scale_ = 1.0;                      // scale of the last prediction: noise_scale_ times the factor
  double noise_scale_ = 1.0, noise_samples_ = 0.0;  // noise scale, and discounted number of samples that determine it,
                                                    // as in FilterMemory
  vector_imm::UpdateResult last_;                   // results of the last update
  vector_imm::Kernels kernels_;
  std::unique_ptr<double[], Free> memory_;
  vector_imm::ModeRows rows_;              // pointers into memory_
  Eigen::MatrixXd C_, R_;                  // transposed: row-major
  Eigen::MatrixXd partial_C_, partial_R_;  // C and R of the available signals
  vector_imm::Sensor sensor_;              // views of C_ and R_
  Eigen::VectorXd y_, packed_;
  Eigen::VectorXd weights_, log_likelihood_;  // workspace of the transform for quantised signals
  StartMoments first_;
  Eigen::VectorXd initial_probability_, start_;

  std::size_t at(Eigen::Index i, Eigen::Index j) const {
    return static_cast<std::size_t>(i) * rows_.stride + static_cast<std::size_t>(j);
  }
  Eigen::Map<const Eigen::VectorXd> row(const double* first) const { return {first, K_}; }
  double scale_of_step(const Vector& v);
  void lay_out();
  void fill(const Bank& bank);
  vector_imm::Sensor detach_missing(const Vector& y, Eigen::Index missing);
};

}  // namespace modebank
