#include "filter/step/detail/vector/vector_gradient.hpp"

#include <algorithm>
#include <cstdint>
#include <utility>

#include "filter/step/equations/bounds.hpp"
#include "filter/step/equations/noise_scale.hpp"

namespace modebank {

using Eigen::Index;
using vector_imm::count_of;
using vector_imm::row_multiple;

bool VectorGradient::can_step(const Bank& bank, const FilterOptions& options) {
  return VectorImm::can_step(bank, options) && bank.noise_factor.empty() &&
         vector_imm::reverse(count_of(bank.structure.dimension()), count_of(bank.C.rows())) != nullptr;
}

VectorGradient::VectorGradient(const Bank& bank, const FilterOptions& options)
    : filter_(bank, options),
      reverse_(vector_imm::reverse(count_of(bank.structure.dimension()), count_of(bank.C.rows()))),
      n_(bank.structure.dimension()),
      n_y_(bank.C.rows()),
      m_(bank.structure.acting_inputs()),
      K_(bank.mode_count()),
      packed_(n_ * (n_ + 1) / 2),
      stride_(static_cast<Index>(filter_.rows_.stride)),
      state_numbers_((n_ + packed_ + 1) * stride_),
      by_R_(Eigen::VectorXd::Zero(n_y_ * (n_y_ + 1) / 2)),
      by_start_covariance_(Eigen::MatrixXd::Zero(n_, n_)) {
  lay_out();
}

/// Rows begin at multiples of a register, like those of the filter.
void VectorGradient::lay_out() {
  const Index rows = state_numbers_ / stride_ + n_ * n_ + n_ * m_ + n_ + packed_ + 2 * K_ + 2 * n_ + packed_ + 3;
  memory_ = Eigen::VectorXd::Zero(rows * stride_ + static_cast<Index>(row_multiple));
  auto* next = memory_.data();
  while (reinterpret_cast<std::uintptr_t>(next) % (row_multiple * sizeof(double)) != 0) ++next;
  const auto take = [&](Index count) {
    double* first = next;
    next += count * stride_;
    return first;
  };
  rows_.mean = take(n_);
  rows_.covariance = take(packed_);
  rows_.probability = take(1);
  rows_.F = take(n_ * n_);
  rows_.B = take(n_ * m_);
  rows_.c = take(n_);
  rows_.Q = take(packed_);
  rows_.by_transition_to = take(K_);
  rows_.mixed_mean = take(n_);
  rows_.by_mixed_mean = take(n_);
  rows_.by_mixed_covariance = take(packed_);
  rows_.by_prior = take(1);
  rows_.pair = take(1);
  probability_after_ = take(1);
  double* transition_to = take(K_);
  for (Index i = 0; i < K_; ++i)
    for (Index j = 0; j < K_; ++j) transition_to[j * stride_ + i] = filter_.rows_.transition[i * stride_ + j];
  rows_.transition_to = transition_to;
  rows_.R = by_R_.data();
}

void VectorGradient::reserve(Index samples) {
  moments_.reserve(count_of(samples));
  states_.reserve(count_of(samples * state_numbers_));
  inputs_.reserve(count_of(samples * m_));
  measured_.reserve(count_of(samples * n_y_));
}

/// The rows of the filter's state are contiguous (VectorImm::lay_out).
void VectorGradient::remember(const Moment& moment, const double* v, const double* y) {
  moments_.push_back(moment);
  moments_.back().noise_scale = filter_.noise_scale_;
  moments_.back().noise_samples = filter_.noise_samples_;
  states_.insert(states_.end(), filter_.rows_.mean, filter_.rows_.mean + state_numbers_);
  inputs_.insert(inputs_.end(), v, v + m_);
  measured_.insert(measured_.end(), y, y + n_y_);
}

void VectorGradient::start(const Vector& y) {
  filter_.start(y);
  const Eigen::VectorXd none = Eigen::VectorXd::Zero(std::max(m_, n_y_));
  remember({Kind::start}, none.data(), none.data());
}

void VectorGradient::skip(const Vector& v) {
  filter_.skip(v);
  const Eigen::VectorXd none = Eigen::VectorXd::Zero(n_y_);
  remember({Kind::skip}, v.data(), none.data());
}

void VectorGradient::step(const Vector& v, const Vector& y) {
  if (missing_entries(y) == n_y_) return skip(v);
  filter_.predict(v);
  filter_.update(y);
  remember({Kind::step, 1.0, 1.0, 0.0, filter_.last_.share, filter_.last_.square}, v.data(), y.data());
}

BankGradient VectorGradient::go_back() {
  for (std::size_t t = moments_.size(); t-- > 0;) {
    if (moments_[t].kind == Kind::start)
      back_to_start();
    else
      back_over(t);
  }
  return result();
}

/// At the start all modes have the same moments. The mean of the modes' means then does not depend on the bank.
void VectorGradient::back_to_start() {
  for (Index a = 0, row = 0; a < n_; ++a)
    for (Index b = 0; b <= a; ++b, ++row) {
      double sum = 0.0;
      for (Index j = 0; j < K_; ++j) sum += rows_.covariance[row * stride_ + j];
      by_start_covariance_(a, b) += sum;
      if (a != b) by_start_covariance_(b, a) += sum;
    }
  std::fill_n(by_state(), state_numbers_, 0.0);
  by_noise_scale_ = by_noise_samples_ = 0.0;
}

void VectorGradient::back_over(std::size_t t) {
  const Moment &before = moments_[t - 1], &after = moments_[t];
  const vector_imm::ModeRows& filter = filter_.rows_;
  const auto state = [&](std::size_t at) { return states_.data() + at * count_of(state_numbers_); };
  std::copy_n(state(t - 1), state_numbers_, filter.mean);
  filter_.kernels_.prepare(filter);
  const Eigen::Map<const Eigen::VectorXd> v(inputs_.data() + t * count_of(m_), m_),
      y(measured_.data() + t * count_of(n_y_), n_y_);
  filter_.noise_scale_ = before.noise_scale;
  filter_.predict(v);

  vector_imm::ReverseStep step;
  step.sensor = filter_.sensor_;
  step.inputs = v.data();
  step.weight = after.weight;
  step.noise_scale = before.noise_scale;
  std::copy_n(state(t) + (n_ + packed_) * stride_, stride_, probability_after_);
  step.probability_after = probability_after_;
  const Eigen::VectorXd by_R = by_R_;
  const Index missing = after.kind == Kind::step ? missing_entries(y) : 0;
  if (after.kind == Kind::step) {
    step.measured = y.data();
    if (missing > 0) {
      step.sensor = filter_.detach_missing(y, missing);
      step.measured = filter_.y_.data();
      filter_.kernels_.expect(filter, step.sensor);
    }
    if (filter_.adaptive_) back_over_noise_scale(before, after, step.sensor.signals, step);
  }
  by_noise_scale_ += reverse_(filter, step, rows_);
  if (missing == 0) return;
  for (Index i = 0, k = 0; i < n_y_; ++i)  // R of a missing signal is not a parameter of the bank
    for (Index j = 0; j <= i; ++j, ++k)
      if (is_missing(y(i)) || is_missing(y(j))) by_R_(k) = by_R(k);
}

/// Adjoint of move_noise_scale.
void VectorGradient::back_over_noise_scale(const Moment& before, const Moment& after, double signals,
                                           vector_imm::ReverseStep& step) {
  const double f = filter_.adaptation_.forgetting;
  const bool bound = after.noise_scale <= 1.0 / largest_noise_scale || after.noise_scale >= largest_noise_scale;
  const double by_squares = bound ? 0.0 : by_noise_scale_ / after.noise_samples;
  const double by_samples = by_noise_samples_ - by_squares * after.noise_scale;
  const double s = before.noise_scale;
  step.adaptive = true;
  step.by_share = by_samples / signals;
  step.by_square = by_squares * s / signals;
  by_noise_scale_ = by_squares * (f * before.noise_samples + after.square / signals) +
                    (step.by_share * after.share + step.by_square * after.square) / s;
  by_noise_samples_ = f * (by_squares * s + by_samples);
}

BankGradient VectorGradient::result() const {
  BankGradient gradient;
  const auto number = [&](const double* rows, Index i, Index j) { return rows[i * stride_ + j]; };
  for (Index j = 0; j < K_; ++j) {
    BankGradient::Mode mode{{Eigen::MatrixXd(n_, n_), Eigen::MatrixXd(n_, m_), Eigen::VectorXd(n_)},
                            Eigen::MatrixXd(n_, n_)};
    for (Index a = 0, row = 0; a < n_; ++a) {
      for (Index b = 0; b < n_; ++b) mode.model.A(a, b) = number(rows_.F, a * n_ + b, j);
      for (Index i = 0; i < m_; ++i) mode.model.B(a, i) = number(rows_.B, a * m_ + i, j);
      mode.model.c(a) = number(rows_.c, a, j);
      for (Index b = 0; b <= a; ++b, ++row) mode.Q(a, b) = mode.Q(b, a) = number(rows_.Q, row, j);
    }
    gradient.modes.push_back(std::move(mode));
  }
  gradient.transition.resize(K_, K_);
  for (Index i = 0; i < K_; ++i)
    for (Index j = 0; j < K_; ++j) gradient.transition(i, j) = number(rows_.by_transition_to, j, i);
  gradient.R.resize(n_y_, n_y_);
  for (Index i = 0, k = 0; i < n_y_; ++i)
    for (Index j = 0; j <= i; ++j, ++k) gradient.R(i, j) = gradient.R(j, i) = by_R_(k);
  gradient.start_covariance = by_start_covariance_;
  return gradient;
}

}  // namespace modebank
