#include "filter/scalar_imm.hpp"

#include <hwy/aligned_allocator.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "filter/imm.hpp"
#include "filter/measurement.hpp"
#include "filter/scalar_imm_kernels.hpp"
#include "filter/start_moments.hpp"

namespace modebank::scalar_imm {

using Eigen::Index;

namespace {

/// Zeros, aligned for any register.
class Lanes {
 public:
  explicit Lanes(std::size_t count) : memory_(hwy::AllocateAligned<double>(std::max<std::size_t>(count, 1))) {
    std::fill_n(memory_.get(), count, 0.0);
  }
  double& operator[](std::size_t i) { return memory_[i]; }
  double* data() { return memory_.get(); }

 private:
  hwy::AlignedFreeUniquePtr<double[]> memory_;
};

std::size_t size(Index n) { return static_cast<std::size_t>(n); }

double general_log_likelihood(const Parameters& bank, const Samples& samples) {
  return log_likelihoods({{&bank, samples}}).front();
}

/// Up to a register of jobs.
void run_group(const Job* jobs, std::size_t count, std::size_t L, double* out) {
  const std::size_t K = size(jobs->bank->modes), m = size(jobs->bank->inputs);
  std::size_t longest = 0;
  for (std::size_t l = 0; l < count; ++l) longest = std::max(longest, size(jobs[l].samples.count));
  Lanes C(L), R(L), F(K * L), c(K * L), Q(K * L), B(m * K * L), T(K * K * L), y(longest * L), v(longest * m * L);
  Lanes moments(2 * K * L), next(2 * K * L), probability(K * L), workspace(5 * K * L), result(L);
  double *mean = moments.data(), *variance = mean + K * L;
  std::fill_n(y.data(), longest * L, std::numeric_limits<double>::quiet_NaN());
  for (std::size_t l = 0; l < L; ++l) {
    const Job& job = jobs[std::min(l, count - 1)];  // spare lanes repeat the last
    const Parameters& p = *job.bank;
    C[l] = p.C;
    R[l] = p.R;
    for (std::size_t j = 0; j < K; ++j) {
      const auto mode = static_cast<Index>(j);
      F[j * L + l] = p.F(mode);
      c[j * L + l] = p.c(mode);
      Q[j * L + l] = p.Q(mode);
      for (std::size_t i = 0; i < m; ++i) B[(i * K + j) * L + l] = p.B(mode, static_cast<Index>(i));
      for (std::size_t i = 0; i < K; ++i) T[(i * K + j) * L + l] = p.transition(static_cast<Index>(i), mode);
      mean[j * L + l] = p.start_gain * job.samples.measurement[0];
      variance[j * L + l] = p.start_variance;
      probability[j * L + l] = p.probability(mode);
    }
    const std::size_t samples = size(job.samples.count);
    for (std::size_t k = 0; k < samples; ++k) y[k * L + l] = job.samples.measurement[k];
    for (std::size_t k = 0; k + 1 < samples; ++k)
      for (std::size_t i = 0; i < m; ++i) v[(k * m + i) * L + l] = job.samples.inputs[k * m + i];
  }
  run_lanes({K, m, longest, C.data(), R.data(), F.data(), c.data(), Q.data(), B.data(), T.data(), y.data(), v.data(),
             mean, variance, probability.data(), next.data(), workspace.data(), result.data()});
  std::copy_n(result.data(), count, out);
}

}  // namespace

Parameters::Parameters(const Bank& bank)
    : modes(bank.mode_count()),
      inputs(bank.structure.acting_inputs()),
      C(bank.C(0, 0)),
      R(bank.R(0, 0)),
      F(modes),
      c(modes),
      Q(modes),
      B(modes, inputs),
      transition(bank.transition.matrix()),
      probability(bank.initial_probability) {
  for (Index j = 0; j < modes; ++j) {
    const Mode& mode = bank.modes[size(j)];
    F(j) = 1.0 + mode.model.A(0, 0);
    c(j) = mode.model.c(0);
    Q(j) = mode.Q(0, 0);
    B.row(j) = mode.model.B.row(0);
  }
  floor_probabilities(probability);
  const StartMoments start = start_moments(bank);
  start_gain = start.gain(0, 0);
  start_variance = start.covariance(0, 0);
}

bool can_step(const Bank& bank, const FilterOptions& options) {
  const auto has_spread = [](const Mode& mode) { return mode.spread.size() > 0; };
  FilterOptions known;  // whatever else an option may ask for is the general filter's
  known.parameter_noise = options.parameter_noise;
  known.time_steps = options.time_steps;
  return options == known && bank.structure.dimension() == 1 && bank.C.rows() == 1 && bank.mode_count() > 1 &&
         !(options.parameter_noise && std::any_of(bank.modes.begin(), bank.modes.end(), has_spread));
}

bool can_take(const Bank& bank, const Trajectory& run, const FilterOptions& options) {
  if (bank.structure.lagged() || run.samples() < 2 || is_missing(run.state(0, 0))) return false;
  for (Index k = 1; run.time_s.size() > 0 && k < run.samples(); ++k)
    if (SampleFeed::steps_between(run.time_s(k - 1), run.time_s(k), bank.dt_s, options.time_steps) != 1) return false;
  return true;
}

double log_likelihood(const Parameters& bank, const Samples& samples) {
  const ModeKernel kernel = mode_kernel(size(bank.modes));
  if (kernel == nullptr) return general_log_likelihood(bank, samples);
  const std::size_t L = lane_count(), K = size(bank.modes), m = size(bank.inputs), stride = (K + L - 1) / L * L;
  Lanes F(stride), c(stride), Q(stride), B(m * stride), T(K * stride);
  Lanes mean(stride), variance(stride), probability(stride);
  std::fill_n(variance.data(), stride, 1.0);
  for (std::size_t j = 0; j < K; ++j) {
    const auto mode = static_cast<Index>(j);
    F[j] = bank.F(mode);
    c[j] = bank.c(mode);
    Q[j] = bank.Q(mode);
    for (std::size_t i = 0; i < m; ++i) B[i * stride + j] = bank.B(mode, static_cast<Index>(i));
    for (std::size_t i = 0; i < K; ++i) T[i * stride + j] = bank.transition(static_cast<Index>(i), mode);
    mean[j] = bank.start_gain * samples.measurement[0];
    variance[j] = bank.start_variance;
    probability[j] = bank.probability(mode);
  }
  return kernel({K, stride, m, size(samples.count), bank.C, bank.R, F.data(), c.data(), Q.data(), B.data(), T.data(),
                 samples.measurement, samples.inputs, mean.data(), variance.data(), probability.data()});
}

std::vector<double> log_likelihoods(const std::vector<Job>& jobs) {
  std::vector<double> result(jobs.size());
  const std::size_t L = lane_count();
  for (std::size_t first = 0; first < jobs.size(); first += L)
    run_group(jobs.data() + first, std::min(L, jobs.size() - first), L, result.data() + first);
  return result;
}

}  // namespace modebank::scalar_imm
