#include "filter/vector_imm.hpp"

#include <algorithm>
#include <cstdlib>
#include <new>

#include "filter/filter_model.hpp"
#include "filter/imm.hpp"
#include "filter/measurement.hpp"
#include "filter/noise_scale.hpp"
#include "ident/not_a_number.hpp"

namespace modebank {

using Eigen::Index;
using vector_imm::row_multiple;

namespace {

constexpr std::size_t register_bytes = row_multiple * sizeof(double);
constexpr double half_log_two_pi = 0.91893853320467274178;

std::size_t count_of(Index n) { return static_cast<std::size_t>(n); }
Index packed_size(Index n) { return n * (n + 1) / 2; }

/// Calls visit(place, a, b) for the lower triangle in the kernels' order.
template <class Visit>
void for_each_packed(Index n, Visit visit) {
  for (Index a = 0, place = 0; a < n; ++a)
    for (Index b = 0; b <= a; ++b, ++place) visit(place, a, b);
}

void unpack_symmetric(const Eigen::VectorXd& packed, Eigen::Ref<Eigen::MatrixXd> matrix) {
  for_each_packed(matrix.rows(), [&](Index place, Index a, Index b) { matrix(a, b) = matrix(b, a) = packed(place); });
}

}  // namespace

void VectorImm::Free::operator()(double* memory) const { std::free(memory); }

bool VectorImm::can_step(const Bank& bank, const FilterOptions& options) {
  const auto has_spread = [](const Mode& mode) { return mode.spread.size() > 0; };
  return options.variant == FilterVariant::imm && bank.mode_count() > 1 &&
         !(options.parameter_noise && std::any_of(bank.modes.begin(), bank.modes.end(), has_spread)) &&
         vector_imm::kernels(count_of(bank.structure.dimension()), count_of(bank.C.rows())).predict != nullptr;
}

VectorImm::VectorImm(const Bank& bank, const FilterOptions& options)
    : n_(bank.structure.dimension()),
      n_y_(bank.C.rows()),
      K_(bank.mode_count()),
      adaptive_(options.noise == FilterNoise::adaptive),
      adaptation_(bank.noise_adaptation),
      kernels_(vector_imm::kernels(count_of(n_), count_of(n_y_))),
      C_(bank.C.transpose()),
      R_(bank.R.transpose()),
      partial_C_(C_),
      partial_R_(R_),
      y_(n_y_),
      packed_(std::max(packed_size(n_), packed_size(n_y_))),
      initial_probability_(bank.initial_probability),
      start_(n_) {
  floor_probabilities(initial_probability_);
  const StartMoments first = start_moments(bank);
  start_gain_ = first.gain;
  start_covariance_ = first.covariance;
  rows_.modes = count_of(K_);
  rows_.stride = (rows_.modes + row_multiple - 1) / row_multiple * row_multiple;
  rows_.inputs = count_of(bank.structure.acting_inputs());
  lay_out();
  fill(bank);
}

VectorImm::VectorImm(const VectorImm& other)
    : noise_scale(other.noise_scale),
      noise_samples(other.noise_samples),
      n_(other.n_),
      n_y_(other.n_y_),
      K_(other.K_),
      adaptive_(other.adaptive_),
      adaptation_(other.adaptation_),
      kernels_(other.kernels_),
      rows_(other.rows_),
      C_(other.C_),
      R_(other.R_),
      partial_C_(other.partial_C_),
      partial_R_(other.partial_R_),
      y_(other.y_),
      packed_(other.packed_),
      start_gain_(other.start_gain_),
      start_covariance_(other.start_covariance_),
      initial_probability_(other.initial_probability_),
      start_(other.start_) {
  lay_out();
  std::copy_n(other.memory_.get(), numbers_, memory_.get());
}

/// One block for all rows, so that a step after a pause finds its numbers in few cache lines.
void VectorImm::lay_out() {
  const std::size_t n = count_of(n_), n_y = count_of(n_y_), p = count_of(packed_size(n_)),
                    q = count_of(packed_size(n_y_));
  const std::size_t bank_rows = n * n + n * rows_.inputs + n + p + rows_.modes;
  const std::size_t step_rows = 3 * (n + p) + 2 + 5 * n_y + 2 * q + 2;
  numbers_ = (bank_rows + step_rows) * rows_.stride;
  auto* memory = static_cast<double*>(std::aligned_alloc(register_bytes, numbers_ * sizeof(double)));
  if (memory == nullptr) throw std::bad_alloc();
  std::fill_n(memory, numbers_, 0.0);
  memory_.reset(memory);
  const auto take = [&](std::size_t rows) {
    double* first = memory;
    memory += rows * rows_.stride;
    return first;
  };
  rows_.F = take(n * n);
  rows_.B = take(n * rows_.inputs);
  rows_.c = take(n);
  rows_.Q = take(p);
  rows_.transition = take(rows_.modes);
  rows_.mean = take(n);
  rows_.covariance = take(p);
  rows_.probability = take(1);
  rows_.parts = take(n + p);
  rows_.predicted_probability = take(1);
  rows_.predicted_mean = take(n);
  rows_.predicted_covariance = take(p);
  rows_.expected = take(n_y);
  rows_.innovation_covariance = take(q);
  rows_.L = take(q);
  rows_.D = take(n_y);
  rows_.D_inverse = take(n_y);
  rows_.decorrelated = take(n_y);
  rows_.distance = take(1);
  rows_.weight = take(1);
}

void VectorImm::fill(const Bank& bank) {
  const auto put = [&](const double* rows, Index i, Index j, double value) {
    const_cast<double*>(rows)[at(i, j)] = value;
  };
  const Index m = bank.structure.acting_inputs();
  for (Index j = 0; j < K_; ++j) {
    const Mode& mode = bank.modes[count_of(j)];
    const Eigen::MatrixXd F = mode.model.full_form();
    for (Index a = 0; a < n_; ++a) {
      for (Index b = 0; b < n_; ++b) put(rows_.F, a * n_ + b, j, F(a, b));
      for (Index i = 0; i < m; ++i) put(rows_.B, a * m + i, j, mode.model.B(a, i));
      put(rows_.c, a, j, mode.model.c(a));
    }
    for_each_packed(n_, [&](Index place, Index a, Index b) { put(rows_.Q, place, j, mode.Q(a, b)); });
    for (Index i = 0; i < K_; ++i) put(rows_.transition, i, j, bank.transition.matrix()(i, j));
    rows_.probability[j] = initial_probability_(j);  // until the start
  }
}

void VectorImm::start(const Vector& y) {
  start_.noalias() = start_gain_.lazyProduct(y);
  for (Index j = 0; j < K_; ++j) {
    for (Index a = 0; a < n_; ++a) rows_.mean[at(a, j)] = start_(a);
    for_each_packed(n_,
                    [&](Index place, Index a, Index b) { rows_.covariance[at(place, j)] = start_covariance_(a, b); });
    rows_.probability[j] = initial_probability_(j);
  }
  noise_scale = 1.0;
  noise_samples = adaptation_.prior_samples;
}

void VectorImm::skip(const Vector& v) {
  kernels_.predict(rows_, v.data(), noise_scale);
  kernels_.skip(rows_);
}

void VectorImm::predict(const Vector& v) {
  kernels_.predict(rows_, v.data(), noise_scale);
  kernels_.expect(rows_, {C_.data(), R_.data()});
}

/// As PartialSensor: a missing signal is one that is always zero, of variance one, unrelated to anything.
vector_imm::Sensor VectorImm::detach_missing(const Vector& y) {
  partial_C_ = C_;
  partial_R_ = R_;
  for (Index i = 0; i < n_y_; ++i) {
    if (!is_missing(y(i))) continue;
    partial_C_.col(i).setZero();
    partial_R_.row(i).setZero();
    partial_R_.col(i).setZero();
    partial_R_(i, i) = 1.0;
    y_(i) = 0.0;
  }
  return {partial_C_.data(), partial_R_.data()};
}

double VectorImm::update(const Vector& y) {
  const Index missing = missing_entries(y);
  if (missing == n_y_) {
    kernels_.skip(rows_);
    return not_a_number;
  }
  y_ = y;
  vector_imm::Sensor sensor{C_.data(), R_.data()};
  if (missing > 0) {
    sensor = detach_missing(y);
    kernels_.expect(rows_, sensor);
  }
  const vector_imm::UpdateResult result = kernels_.update(rows_, sensor, y_.data(), adaptive_ ? noise_scale : 0.0);
  if (adaptive_)
    move_noise_scale(adaptation_, result.share, result.square, static_cast<double>(n_y_ - missing), noise_scale,
                     noise_samples);
  return result.log_density + half_log_two_pi * static_cast<double>(missing);
}

void VectorImm::combine(Eigen::Ref<Eigen::VectorXd> state, Eigen::Ref<Eigen::MatrixXd> innovation_covariance,
                        double& spread_share) {
  vector_imm::CombinedExpectation to{state.data(), packed_.data()};
  kernels_.combine(rows_, {C_.data(), R_.data()}, to);
  unpack_symmetric(packed_, innovation_covariance);
  const double total = innovation_covariance.diagonal().sum();
  spread_share = total > 0.0 ? std::min(1.0, to.spread / total) : 0.0;
}

void VectorImm::transform(const Vector& y, Eigen::Ref<Eigen::VectorXd> pit) const {
  kernels_.transform(rows_, y.data(), pit.data());
}

void VectorImm::merge(Eigen::Ref<Eigen::VectorXd> mean, Eigen::Ref<Eigen::MatrixXd> covariance) {
  kernels_.merge(rows_, {mean.data(), packed_.data()});
  unpack_symmetric(packed_, covariance);
}

void VectorImm::get(Eigen::MatrixXd& means, Eigen::MatrixXd& covariances, Eigen::VectorXd& probability) const {
  means.resize(n_, K_);
  covariances.resize(n_ * n_, K_);
  for (Index j = 0; j < K_; ++j) {
    for (Index a = 0; a < n_; ++a) means(a, j) = rows_.mean[at(a, j)];
    for_each_packed(n_, [&](Index place, Index a, Index b) {
      covariances(b * n_ + a, j) = covariances(a * n_ + b, j) = rows_.covariance[at(place, j)];
    });
  }
  probability = mode_probability();
}

void VectorImm::set(const Eigen::MatrixXd& means, const Eigen::MatrixXd& covariances,
                    const Eigen::VectorXd& probability) {
  for (Index j = 0; j < K_; ++j) {
    for (Index a = 0; a < n_; ++a) rows_.mean[at(a, j)] = means(a, j);
    for_each_packed(
        n_, [&](Index place, Index a, Index b) { rows_.covariance[at(place, j)] = covariances(b * n_ + a, j); });
    rows_.probability[j] = probability(j);
  }
}

}  // namespace modebank
