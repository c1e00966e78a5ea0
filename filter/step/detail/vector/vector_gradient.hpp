#pragma once

#include <Eigen/Core>
#include <vector>

#include "filter/step/detail/vector/reverse.hpp"
#include "filter/step/detail/vector/vector_imm.hpp"
#include "filter/step/likelihood_gradient.hpp"

namespace modebank {

/// VectorImm that stores every step and then computes the gradient of their log densities by reverse-mode
/// differentiation.
class VectorGradient {
 public:
  using Vector = Stepper::Vector;

  static bool can_step(const Bank& bank, const FilterOptions& options);
  /// Requires can_step(bank, options) and check_sizes(bank).
  VectorGradient(const Bank& bank, const FilterOptions& options);

  void reserve(Eigen::Index samples);
  void start(const Vector& y);
  void skip(const Vector& v);
  void step(const Vector& v, const Vector& y);
  /// Gradient of the sum of all steps' log densities. Call once.
  BankGradient go_back();

 private:
  enum class Kind { start, skip, step };
  /// The step to one moment, and the noise scale after the step.
  struct Moment {
    Kind kind;
    double weight = 0.0;  ///< 1 for a measurement
    double noise_scale = 1.0, noise_samples = 0.0;
    double share = 0.0, square = 0.0;  ///< from UpdateResult
  };

  VectorImm filter_;
  vector_imm::Reverse reverse_;
  Eigen::Index n_, n_y_, m_, K_, packed_, stride_, state_numbers_;
  std::vector<Moment> moments_;
  std::vector<double> states_, inputs_, measured_;  ///< state_numbers_, m_ and n_y_ numbers per moment
  Eigen::VectorXd memory_;                          ///< memory for rows_ and probability_after_
  vector_imm::ReverseRows rows_;
  double* probability_after_ = nullptr;  ///< points to a row in memory_
  Eigen::VectorXd by_R_;
  Eigen::MatrixXd by_start_covariance_;
  double by_noise_scale_ = 0.0, by_noise_samples_ = 0.0;

  void remember(const Moment& moment, const double* v, const double* y);
  void lay_out();
  double* by_state() { return rows_.mean; }
  void back_to_start();
  void back_over(std::size_t t);
  void back_over_noise_scale(const Moment& before, const Moment& after, double signals, vector_imm::ReverseStep& step);
  BankGradient result() const;
};

}  // namespace modebank
