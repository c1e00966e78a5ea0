#include "filter/scalar_imm.hpp"

#include <hwy/aligned_allocator.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <utility>

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

/// Samples go to the kernel in pieces that stay in the nearest cache.
constexpr std::size_t piece = 64;

/// The runs of one register and their banks, laid out for the kernel. Spare lanes repeat the last run.
class RunRegister {
 public:
  RunRegister(std::vector<const Job*> jobs, std::size_t L)
      : jobs_(std::move(jobs)),
        L_(L),
        K_(size(jobs_.front()->bank->modes)),
        m_(size(jobs_.front()->bank->inputs)),
        shared_(
            std::all_of(jobs_.begin(), jobs_.end(), [&](const Job* job) { return job->bank == jobs_.front()->bank; })),
        width_(shared_ ? 1 : L),
        C_(width_),
        R_(width_),
        F_(K_ * width_),
        c_(K_ * width_),
        Q_(K_ * width_),
        B_(m_ * K_ * width_),
        T_(K_ * K_ * width_),
        y_(piece * L),
        v_(piece * m_ * L),
        moments_(2 * K_ * L),
        next_(2 * K_ * L),
        probability_(K_ * L),
        workspace_(5 * K_ * L),
        result_(L) {
    jobs_.resize(L, jobs_.back());
    for (std::size_t l = 0; l < width_; ++l) put_bank(*jobs_[l]->bank, l);
    for (std::size_t l = 0; l < L; ++l) start(*jobs_[l], l);
  }

  void run() {
    std::size_t longest = 0;
    for (const Job* job : jobs_) longest = std::max(longest, size(job->samples.count) - 1);
    double* mean = moments_.data();
    RunLanes lanes{shared_,
                   K_,
                   m_,
                   0,
                   C_.data(),
                   R_.data(),
                   F_.data(),
                   c_.data(),
                   Q_.data(),
                   B_.data(),
                   T_.data(),
                   y_.data(),
                   v_.data(),
                   mean,
                   mean + K_ * L_,
                   probability_.data(),
                   next_.data(),
                   workspace_.data(),
                   result_.data()};
    for (std::size_t first = 0; first < longest; first += piece) {
      lanes.count = std::min(piece, longest - first);
      for (std::size_t l = 0; l < L_; ++l) put_samples(jobs_[l]->samples, first, lanes.count, l);
      run_lanes(lanes);
    }
  }

  /// Job i of the list that begins at `first` has its log likelihood at `to` + i.
  void tell(const Job* first, double* to) {
    for (std::size_t l = 0; l < L_; ++l) to[jobs_[l] - first] = result_[l];
  }

 private:
  std::vector<const Job*> jobs_;
  std::size_t L_, K_, m_;
  bool shared_;
  std::size_t width_;
  Lanes C_, R_, F_, c_, Q_, B_, T_, y_, v_, moments_, next_, probability_, workspace_, result_;

  void put_bank(const Parameters& p, std::size_t l) {
    C_[l] = p.C;
    R_[l] = p.R;
    for (std::size_t j = 0; j < K_; ++j) {
      const auto mode = static_cast<Index>(j);
      F_[j * width_ + l] = p.F(mode);
      c_[j * width_ + l] = p.c(mode);
      Q_[j * width_ + l] = p.Q(mode);
      for (std::size_t i = 0; i < m_; ++i) B_[(i * K_ + j) * width_ + l] = p.B(mode, static_cast<Index>(i));
      for (std::size_t i = 0; i < K_; ++i) T_[(i * K_ + j) * width_ + l] = p.transition(static_cast<Index>(i), mode);
    }
  }

  void start(const Job& job, std::size_t l) {
    for (std::size_t j = 0; j < K_; ++j) {
      moments_[j * L_ + l] = job.bank->start_gain * job.samples.measurement[0];
      moments_[(K_ + j) * L_ + l] = job.bank->start_variance;
      probability_[j * L_ + l] = job.bank->probability(static_cast<Index>(j));
    }
  }

  void put_samples(const Samples& samples, std::size_t first, std::size_t count, std::size_t l) {
    const std::size_t all = size(samples.count) - 1, begin = std::min(all, first), there = std::min(count, all - begin);
    const double* measurement = samples.measurement + begin + 1;
    const double* inputs = samples.inputs + begin * m_;
    double *y = y_.data() + l, *v = v_.data() + l;
    for (std::size_t k = 0; k < there; ++k) y[k * L_] = measurement[k];
    for (std::size_t k = there; k < count; ++k) y[k * L_] = std::numeric_limits<double>::quiet_NaN();
    for (std::size_t i = 0; i < there * m_; ++i) v[i * L_] = inputs[i];
  }
};

/// One job per lane: first registers of one bank, then what is left of each. Long runs come first, so that few lanes
/// wait for others to end.
std::vector<std::vector<const Job*>> by_registers(const std::vector<Job>& jobs, std::size_t L) {
  std::vector<const Job*> order;
  for (const Job& job : jobs) order.push_back(&job);
  std::stable_sort(order.begin(), order.end(), [](const Job* a, const Job* b) {
    return a->bank != b->bank ? std::less<>()(a->bank, b->bank) : a->samples.count > b->samples.count;
  });
  std::vector<std::vector<const Job*>> registers;
  std::vector<const Job*> rest;
  const auto width = static_cast<std::ptrdiff_t>(L);
  for (auto first = order.begin(); first != order.end();) {
    const auto last = std::find_if(first, order.end(), [&](const Job* job) { return job->bank != (*first)->bank; });
    for (; last - first >= width; first += width) registers.emplace_back(first, first + width);
    rest.insert(rest.end(), first, last);
    first = last;
  }
  for (auto first = rest.begin(); first != rest.end();) {
    const auto last = first + std::min(width, rest.end() - first);
    registers.emplace_back(first, last);
    first = last;
  }
  return registers;
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
  for (std::vector<const Job*>& group : by_registers(jobs, lane_count())) {
    RunRegister runs(std::move(group), lane_count());
    runs.run();
    runs.tell(jobs.data(), result.data());
  }
  return result;
}

}  // namespace modebank::scalar_imm
