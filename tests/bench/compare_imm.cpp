// compare_imm [ROUNDS]: compares the filter's step with a plain program that uses dynamic Eigen matrices. This is the
// project's peer imm_eigen.cpp: filters in a vector, S.inverse(), Joseph's form, likelihoods in the linear domain.
// Rounds alternate on one thread. Prints medians. Every number is compared with the peer's number.
#include <fmt/format.h>

#include <Eigen/Dense>
#include <cmath>
#include <cstdlib>
#include <ctime>
#include <functional>
#include <numbers>

#include "filter/judge/evaluate.hpp"
#include "filter/step/bank_filter.hpp"
#include "filter/step/imm.hpp"
#include "tests/bench/bench_data.hpp"

namespace {

using namespace modebank;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr Index steps = 4000;

/// The peer's models. The first state switches between modes and is measured; the other states follow it.
Bank make_bank(Index n, Index K) {
  Bank bank;
  bank.structure = {n, 2, false};
  for (Index j = 0; j < K; ++j) {
    const double s = (static_cast<double>(j) + 0.5) / static_cast<double>(K);
    Mode mode;
    mode.model = {MatrixXd::Zero(n, n), MatrixXd::Zero(n, 2), VectorXd::Zero(n)};
    mode.model.A(0, 0) = -0.1 - 0.75 * s;
    for (Index i = 1; i < n; ++i) {
      mode.model.A(i, i) = -0.1;
      mode.model.A(i - 1, i) += 0.1;
    }
    mode.model.B(0, 0) = -0.2 - s + 0.1 * std::sin(9 * s);
    mode.model.B(0, 1) = 0.2 + 0.9 * s;
    mode.Q = MatrixXd::Identity(n, n) * (0.0009 * (1 + s));
    bank.modes.push_back(mode);
  }
  bank.C = MatrixXd::Zero(1, n);
  bank.C(0, 0) = 1.0;
  bank.R = MatrixXd::Constant(1, 1, 0.25);
  bank.transition = TransitionMatrix::sticky(K, 0.95);
  bank.initial_probability = VectorXd::Constant(K, 1.0 / static_cast<double>(K));
  return bank;
}

Trajectory make_run(Index samples) {
  Trajectory run = bench::make_recording(1, samples).runs[0];
  run.state *= 10.0;
  run.state += 0.5 * Eigen::MatrixXd::NullaryExpr(
                         1, samples, [](Index, Index k) { return std::sin(0.7 * static_cast<double>(k * k)); });
  return run;
}

struct PlainFilter {
  VectorXd x;
  MatrixXd P, F, B, H, Q, R;
  double likelihood = 0.0;

  void predict(const VectorXd& u) {
    x = F * x + B * u;
    P = F * P * F.transpose() + Q;
  }
  void update(const VectorXd& z) {
    const VectorXd y = z - H * x;
    const MatrixXd S = H * P * H.transpose() + R, S_inverse = S.inverse(), gain = P * H.transpose() * S_inverse;
    x = x + gain * y;
    const MatrixXd I_KH = MatrixXd::Identity(x.size(), x.size()) - gain * H;
    P = I_KH * P * I_KH.transpose() + gain * R * gain.transpose();
    likelihood = std::exp(-0.5 * y.dot(S_inverse * y)) /
                 std::sqrt(std::pow(2 * std::numbers::pi, static_cast<double>(z.size())) * S.determinant());
  }
};

/// Log likelihood by the plain program, which starts from the same state as modebank.
double plain(const Bank& bank, const Trajectory& run) {
  const Index K = bank.mode_count(), n = bank.structure.states;
  const StartMoments first = start_moments(bank);
  std::vector<PlainFilter> f(static_cast<std::size_t>(K));
  for (std::size_t j = 0; j < f.size(); ++j)
    f[j] = {first.gain * run.state.col(0),
            first.covariance,
            bank.modes[j].model.full_form(),
            bank.modes[j].model.B,
            bank.C,
            bank.modes[j].Q,
            bank.R};
  VectorXd mu = bank.initial_probability;
  const MatrixXd T = bank.transition.matrix();
  std::vector<VectorXd> xs(f.size());
  std::vector<MatrixXd> Ps(f.size());
  double result = 0.0;
  for (Index k = 1; k < run.samples(); ++k) {
    const VectorXd c = T.transpose() * mu;
    for (Index j = 0; j < K; ++j) {
      VectorXd x = VectorXd::Zero(n);
      for (Index i = 0; i < K; ++i) x += f[i].x * (T(i, j) * mu(i) / c(j));
      MatrixXd P = MatrixXd::Zero(n, n);
      for (Index i = 0; i < K; ++i) {
        const VectorXd y = f[i].x - x;
        P += (T(i, j) * mu(i) / c(j)) * (f[i].P + y * y.transpose());
      }
      xs[j] = x;
      Ps[j] = P;
    }
    const VectorXd u = run.input.col(k - 1), z = run.state.col(k);
    double sum = 0.0;
    for (Index j = 0; j < K; ++j) {
      PlainFilter& filter = f[j];
      filter.x = xs[j];
      filter.P = Ps[j];
      filter.predict(u);
      filter.update(z);
      mu(j) = c(j) * filter.likelihood;
      sum += mu(j);
    }
    mu /= sum;
    result += std::log(sum);
  }
  return result;
}

/// The outputs that a robot needs, sample by sample: estimate, innovation, NIS and probability transform.
double live(const Bank& bank, const Trajectory& run) {
  BankFilter filter(bank, {});
  filter.step(std::nan(""), run.input.col(0), run.state.col(0));
  double sum = 0.0;
  for (Index k = 1; k < run.samples(); ++k)
    sum += filter.step(std::nan(""), run.input.col(k), run.state.col(k)).log_density;
  return sum;
}

/// The filter computed from its equations, for every variant and size.
template <int N, int NY>
double equations(const Bank& bank, const Trajectory& run) {
  ImmFilter<N, NY> filter(bank, {});
  filter.start(run.state.col(0));
  double sum = 0.0;
  for (Index k = 1; k < run.samples(); ++k) {
    filter.predict(run.input.col(k - 1));
    sum += filter.update(run.state.col(k));
  }
  return sum;
}

struct Contestant {
  std::string name;
  std::function<double()> run;  ///< returns the log likelihood of one run
  std::vector<double> ns = {};
};

/// CPU time of this thread, which does not depend on other programs.
double processor_ns() {
  timespec now;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return 1e9 * static_cast<double>(now.tv_sec) + static_cast<double>(now.tv_nsec);
}

void compare(const std::string& title, int rounds, std::vector<Contestant> contestants) {
  double expected = 0.0;
  for (int round = 0; round < rounds; ++round)
    for (Contestant& c : contestants) {
      const double begin = processor_ns();
      const double value = c.run();
      const double spent = processor_ns() - begin;
      if (&c == &contestants.front()) expected = value;
      bench::check(std::abs(value - expected) <= 1e-9 * std::abs(expected), title + ", " + c.name);
      c.ns.push_back(spent / static_cast<double>(steps - 1));
    }
  fmt::print("{}\n", title);
  const auto median = [](std::vector<double> v) {
    std::nth_element(v.begin(), v.begin() + std::ssize(v) / 2, v.end());
    return v[v.size() / 2];
  };
  for (const Contestant& c : contestants)
    fmt::print("  {:<34} {:>9.1f} ns/step {:>8.1f} x\n", c.name, median(c.ns),
               median(contestants.front().ns) / median(c.ns));
}

}  // namespace

int main(int argc, char** argv) {
  const int rounds = argc > 1 ? std::atoi(argv[1]) : 7;
  const Trajectory run = make_run(steps);
  for (const auto& [n, K] : {std::pair<Index, Index>{1, 3}, {1, 9}, {1, 25}, {2, 9}, {3, 9}}) {
    const Bank bank = make_bank(n, K);
    compare(fmt::format("K = {}, n = {}", K, n), rounds,
            {{"plain dynamic Eigen", [&] { return plain(bank, run); }},
             {"equations", [&] { return n == 1 ? equations<1, 1>(bank, run) : equations<-1, -1>(bank, run); }},
             {"log_likelihood", [&] { return log_likelihood(bank, run, {}); }},
             {"BankFilter", [&] { return live(bank, run); }}});
  }
  return 0;
}
