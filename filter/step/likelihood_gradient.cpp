#include "filter/step/likelihood_gradient.hpp"

#include "filter/step/dense_gradient.hpp"
#include "filter/step/detail/vector/vector_gradient.hpp"
#include "filter/step/feed/run_samples.hpp"

namespace modebank {

using Eigen::Index;

BankGradient& BankGradient::operator+=(const BankGradient& other) {
  for (std::size_t j = 0; j < modes.size(); ++j) {
    modes[j].model.A += other.modes[j].model.A;
    modes[j].model.B += other.modes[j].model.B;
    modes[j].model.c += other.modes[j].model.c;
    modes[j].Q += other.modes[j].Q;
  }
  R += other.R;
  transition += other.transition;
  start_covariance += other.start_covariance;
  return *this;
}

double BankGradient::along(const Bank& from, const Bank& to) const {
  const auto change = [](const Eigen::MatrixXd& by, const auto& a, const auto& b) {
    return by.cwiseProduct(b - a).sum();
  };
  double sum = change(R, from.R, to.R) + change(transition, from.transition.matrix(), to.transition.matrix()) +
               change(start_covariance, start_moments(from).covariance, start_moments(to).covariance);
  for (std::size_t j = 0; j < modes.size(); ++j) {
    const modebank::Mode &a = from.modes[j], &b = to.modes[j];
    sum += change(modes[j].model.A, a.model.A, b.model.A) + change(modes[j].model.B, a.model.B, b.model.B) +
           change(modes[j].model.c, a.model.c, b.model.c) + change(modes[j].Q, a.Q, b.Q);
  }
  return sum;
}

bool has_likelihood_gradient(const Bank& bank, const FilterOptions& options) {
  return VectorGradient::can_step(bank, options) || has_dense_gradient(bank, options);
}

BankGradient log_likelihood_gradient(const Bank& bank, const Trajectory& run, const FilterOptions& options) {
  check_run(bank, run);
  if (!VectorGradient::can_step(bank, options)) return dense_gradient(bank, run, options);
  VectorGradient gradient(bank, options);
  gradient.reserve(run.samples());
  RunSamples(bank, run).for_each([&](const SampleFeed& feed, Index k, bool starts) {
    if (starts) return gradient.start(feed.start());
    for (Index i = 1; i < feed.steps(); ++i) gradient.skip(feed.inputs());
    gradient.step(feed.inputs(), run.state.col(k));
  });
  return gradient.go_back();
}

}  // namespace modebank
