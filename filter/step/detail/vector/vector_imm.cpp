#include "filter/step/detail/vector/vector_imm.hpp"

#include <algorithm>
#include <cstdlib>
#include <new>

#include "filter/step/bank_filter.hpp"
#include "filter/step/equations/imm.hpp"
#include "filter/step/equations/noise_scale.hpp"
#include "filter/step/equations/predicted_mixture.hpp"
#include "ident/base/log_two_pi.hpp"
#include "ident/base/not_a_number.hpp"

namespace modebank {

using Eigen::Index;
using vector_imm::count_of;
using vector_imm::row_multiple;

namespace {

constexpr std::size_t register_bytes = row_multiple * sizeof(double);

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
  return options.variant == FilterVariant::imm && bank.mode_count() > 1 && bank.transition_logit.empty() &&
         bank.drift.empty() && bank.terms.empty() &&
         vector_imm::kernels(count_of(bank.structure.dimension()), count_of(bank.C.rows())).predict != nullptr;
}

VectorImm::VectorImm(const Bank& bank, const FilterOptions& options)
    : n_(bank.structure.dimension()),
      n_y_(bank.C.rows()),
      K_(bank.mode_count()),
      adaptive_(options.noise == FilterNoise::adaptive),
      quantum_(bank.is_quantised() ? bank.quantum : Eigen::VectorXd()),
      partial_quantum_(quantum_),
      adaptation_(bank.noise_adaptation),
      factor_(bank.noise_factor),
      kernels_(vector_imm::kernels(count_of(n_), count_of(n_y_))),
      C_(bank.C.transpose()),
      R_(bank.R.transpose()),
      partial_C_(C_),
      partial_R_(R_),
      sensor_{C_.data(), R_.data(), static_cast<double>(n_y_), quantum_.size() > 0 ? quantum_.data() : nullptr},
      y_(n_y_),
      packed_(std::max(packed_size(n_), packed_size(n_y_))),
      weights_(quantum_.size() > 0 ? K_ : 0),
      log_likelihood_(weights_.size()),
      first_(start_moments(bank)),
      initial_probability_(bank.initial_probability),
      start_(n_) {
  floor_probabilities(initial_probability_);
  rows_.modes = count_of(K_);
  rows_.stride = (rows_.modes + row_multiple - 1) / row_multiple * row_multiple;
  rows_.inputs = count_of(bank.structure.acting_inputs());
  rows_.share = 1.0 / static_cast<double>(K_);
  lay_out();
  fill(bank);
}

/// One block of memory for all rows, so that a step after a pause loads few cache lines. Rows of the state are
/// contiguous, because VectorGradient copies them together.
void VectorImm::lay_out() {
  const Index m = static_cast<Index>(rows_.inputs), p = packed_size(n_), q = packed_size(n_y_);
  const Index bank_rows = n_ * n_ + n_ * m + n_ + p + K_, step_rows = 3 * (n_ + p) + 3 + 5 * n_y_ + 2 * q + 2;
  const Index signal_rows = static_cast<Index>(vector_imm::signal_numbers) * quantum_.size();
  const std::size_t numbers = count_of(bank_rows + step_rows + signal_rows) * rows_.stride;
  auto* memory = static_cast<double*>(std::aligned_alloc(register_bytes, numbers * sizeof(double)));
  if (memory == nullptr) throw std::bad_alloc();
  std::fill_n(memory, numbers, 0.0);
  memory_.reset(memory);
  const auto take = [&](Index rows) {
    double* first = memory;
    memory += count_of(rows) * rows_.stride;
    return first;
  };
  rows_.F = take(n_ * n_);
  rows_.B = take(n_ * m);
  rows_.c = take(n_);
  rows_.Q = take(p);
  rows_.transition = take(K_);
  rows_.mean = take(n_);
  rows_.covariance = take(p);
  rows_.probability = take(1);
  rows_.center = take(1);  // one row, which has room for n numbers
  rows_.parts = take(n_ + p);
  rows_.predicted_probability = take(1);
  rows_.predicted_mean = take(n_);
  rows_.predicted_covariance = take(p);
  rows_.expected = take(n_y_);
  rows_.innovation_covariance = take(q);
  rows_.L = take(q);
  rows_.D = take(n_y_);
  rows_.D_inverse = take(n_y_);
  rows_.decorrelated = take(n_y_);
  rows_.exponent = take(1);
  rows_.weight = take(1);
  if (signal_rows > 0) rows_.signal = take(signal_rows);
}

void VectorImm::fill(const Bank& bank) {
  const auto put = [&](const double* rows, Index i, Index j, double value) {  // rows of memory_ that steps do not write
    memory_[count_of(rows - memory_.get()) + at(i, j)] = value;
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
    rows_.probability[j] = initial_probability_(j);  // initial probabilities, used until the start
  }
}

void VectorImm::start(const Vector& y) {
  start_.noalias() = first_.gain.lazyProduct(y);
  for (Index j = 0; j < K_; ++j) {
    for (Index a = 0; a < n_; ++a) rows_.mean[at(a, j)] = start_(a);
    for_each_packed(n_,
                    [&](Index place, Index a, Index b) { rows_.covariance[at(place, j)] = first_.covariance(a, b); });
    rows_.probability[j] = initial_probability_(j);
  }
  kernels_.prepare(rows_);
  noise_scale_ = 1.0;
  noise_samples_ = adaptation_.prior_samples;
}

/// Like noise_of_step of imm.hpp. `start_` is not needed between starts, so it serves as workspace here.
double VectorImm::scale_of_step(const Vector& v) {
  if (factor_.empty()) return noise_scale_;
  for (Index a = 0; a < n_; ++a) {
    double sum = 0.0;
    for (Index j = 0; j < K_; ++j) sum += rows_.probability[j] * rows_.mean[at(a, j)];
    start_(a) = sum;
  }
  return noise_scale_ * factor_.at(start_, v);
}

void VectorImm::skip(const Vector& v) {
  predict(v);
  kernels_.skip(rows_);
}

void VectorImm::predict(const Vector& v) {
  applied_scale_ = scale_of_step(v);
  kernels_.predict(rows_, sensor_, v.data(), applied_scale_);
}

/// As in PartialSensor, a missing signal is replaced by one that is always zero, with variance one and no correlation.
vector_imm::Sensor VectorImm::detach_missing(const Vector& y, Index missing) {
  partial_C_ = C_;
  partial_R_ = R_;
  partial_quantum_ = quantum_;
  y_ = y;
  for (Index i = 0; i < n_y_; ++i) {
    if (!is_missing(y(i))) continue;
    partial_C_.col(i).setZero();
    partial_R_.row(i).setZero();
    partial_R_.col(i).setZero();
    partial_R_(i, i) = 1.0;
    if (quantum_.size() > 0) partial_quantum_(i) = 0.0;
    y_(i) = 0.0;
  }
  return {partial_C_.data(), partial_R_.data(), static_cast<double>(n_y_ - missing),
          quantum_.size() > 0 ? partial_quantum_.data() : nullptr};
}

double VectorImm::update(const Vector& y) {
  const Index missing = missing_entries(y);
  if (missing == n_y_) {
    kernels_.skip(rows_);
    return not_a_number;
  }
  vector_imm::Sensor sensor = sensor_;
  if (missing > 0) {
    sensor = detach_missing(y, missing);
    kernels_.expect(rows_, sensor);
  }
  last_ = kernels_.update(rows_, sensor, missing > 0 ? y_.data() : y.data(), adaptive_ ? applied_scale_ : 0.0);
  if (adaptive_) move_noise_scale(adaptation_, last_.share, last_.square, sensor.signals, noise_scale_, noise_samples_);
  return last_.log_density + 0.5 * log_two_pi * static_cast<double>(missing);
}

void VectorImm::follow(const Columns& inputs, const Columns& measurements, Eigen::Ref<Eigen::VectorXd> log_density) {
  const Index samples = measurements.cols();
  for (Index k = 0; k < samples;) {
    Index end = k;  // first sample from k on that is not complete
    while (!adaptive_ && factor_.empty() && !sensor_.quantum && end < samples &&
           missing_entries(measurements.col(end)) == 0)
      ++end;
    if (end > k) {
      kernels_.follow(rows_, sensor_,
                      {inputs.col(k).data(), measurements.col(k).data(), count_of(end - k), log_density.data() + k});
      k = end;
    } else {
      predict(inputs.col(k));
      log_density(k) = update(measurements.col(k));
      ++k;
    }
  }
}

void VectorImm::combine(Eigen::Ref<Eigen::VectorXd> state, Eigen::Ref<Eigen::MatrixXd> innovation_covariance) {
  kernels_.combine(rows_, sensor_, {state.data(), packed_.data()});
  unpack_symmetric(packed_, innovation_covariance);
  if (sensor_.quantum) innovation_covariance.diagonal().array() += quantum_.array().square() / 12.0;
}

void VectorImm::transform(const Vector& y, Eigen::Ref<Eigen::VectorXd> pit, Eigen::Ref<Eigen::VectorXd> width) {
  if (sensor_.quantum) {
    weights_ = predicted_probability();
    return interval_transform(
        quantum_, y,
        [this](Index i, Index j) {
          return ModeSignal{decorrelated(i, j), variance(i, j), rows_.signal[at(i, j)]};
        },
        weights_, log_likelihood_, pit, width);
  }
  kernels_.transform(rows_, y.data(), pit.data());
}

void VectorImm::merge(Eigen::Ref<Eigen::VectorXd> mean, Eigen::Ref<Eigen::MatrixXd> covariance) {
  kernels_.merge(rows_, {mean.data(), packed_.data()});
  unpack_symmetric(packed_, covariance);
}

void VectorImm::save(FilterMemory& memory) const {
  memory.means.resize(n_, K_);
  memory.covariances.resize(n_ * n_, K_);
  for (Index j = 0; j < K_; ++j) {
    for (Index a = 0; a < n_; ++a) memory.means(a, j) = rows_.mean[at(a, j)];
    for_each_packed(n_, [&](Index place, Index a, Index b) {
      memory.covariances(b * n_ + a, j) = memory.covariances(a * n_ + b, j) = rows_.covariance[at(place, j)];
    });
  }
  memory.mode_probability = mode_probability();
  memory.noise_scale = noise_scale_;
  memory.noise_samples = noise_samples_;
}

void VectorImm::restore(const FilterMemory& memory) {
  for (Index j = 0; j < K_; ++j) {
    for (Index a = 0; a < n_; ++a) rows_.mean[at(a, j)] = memory.means(a, j);
    for_each_packed(
        n_, [&](Index place, Index a, Index b) { rows_.covariance[at(place, j)] = memory.covariances(b * n_ + a, j); });
    rows_.probability[j] = memory.mode_probability(j);
  }
  kernels_.prepare(rows_);
  noise_scale_ = memory.noise_scale;
  noise_samples_ = memory.noise_samples;
}

}  // namespace modebank
