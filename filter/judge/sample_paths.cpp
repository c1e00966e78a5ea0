#include "filter/judge/sample_paths.hpp"

#include <algorithm>
#include <boost/random/normal_distribution.hpp>
#include <boost/random/uniform_01.hpp>
#include <cmath>
#include <stdexcept>

#include "filter/step/noise_density.hpp"
#include "ident/base/covariance.hpp"
#include "ident/base/not_a_number.hpp"

namespace modebank {

using Eigen::Index;

SamplePaths::SamplePaths(const Bank& bank, Index paths, std::uint64_t seed)
    : bank_(bank),
      R_(bank.recording_noise()),
      R_root_(covariance_root(R_)),
      paths_(paths),
      generator_(seed),
      share_(bank.mode_count()),
      regressor_(bank.structure.regressors()),
      next_(bank.structure.dimension()),
      transition_(bank.mode_count(), bank.transition_logit) {
  if (paths < 2) throw std::invalid_argument("at least two sample paths, not " + std::to_string(paths));
  for (const Mode& mode : bank_.modes) noise_root_.push_back(covariance_root(mode.Q));
}

/// Adds a draw from N(0, scale^2 root root').
void SamplePaths::add_draw(const Eigen::MatrixXd& root, Eigen::Ref<Eigen::VectorXd> to, double scale) {
  boost::random::normal_distribution<double> standard;
  normal_.resize(root.cols());
  for (double& value : normal_) value = standard(generator_);
  to.noalias() += scale * (root * normal_);
}

template <class Probability>
Index SamplePaths::draw_mode(const Probability& probability) {
  double u = boost::random::uniform_01<double>()(generator_) * probability.sum();
  Index mode = 0;
  while (mode + 1 < probability.size() && (u -= probability(mode)) >= 0.0) ++mode;
  while (mode > 0 && !(probability(mode) > 0.0)) --mode;  // reached only by rounding
  return mode;
}

/// If mode probabilities depend on the state, they are those at the state of the path.
Index SamplePaths::draw_next_mode(Index mode, const Vector& state, const Vector& inputs) {
  const Eigen::MatrixXd& T =
      transition_at(bank_.transition.matrix(), bank_.transition_logit, state, inputs, transition_);
  return draw_mode(T.row(mode).transpose());
}

void SamplePaths::start(const FilterState<Eigen::Dynamic>& origin) {
  const Index n = next_.size();
  std::vector<Eigen::MatrixXd> start_root;
  for (const Gaussian<Eigen::Dynamic>& mode : origin.modes) start_root.push_back(covariance_root(mode.covariance));
  states_.resize(n, paths_);
  predicted_.resize(n, paths_);
  modes_.resize(static_cast<std::size_t>(paths_));
  lost_ = 0;
  for (Index i = 0; i < paths_; ++i) {
    const Index mode = draw_mode(origin.mode_probability);
    modes_[static_cast<std::size_t>(i)] = mode;
    states_.col(i) = origin.modes[static_cast<std::size_t>(mode)].mean;
    add_draw(start_root[static_cast<std::size_t>(mode)], states_.col(i));
  }
  predicted_ = states_;
}

void SamplePaths::add_terms(Index mode, const Vector& state, const Vector& inputs) {
  fill_regressor(bank_.structure, state, inputs, regressor_);
  terms_.evaluate(bank_.terms, regressor_);
  next_.head(bank_.structure.states) += bank_.modes[static_cast<std::size_t>(mode)].bend * terms_.value();
}

Eigen::MatrixXd SamplePaths::step_noise(Index mode, const std::vector<Index>& in_mode) const {
  return noise_factor_(in_mode).mean() * bank_.modes[static_cast<std::size_t>(mode)].Q;
}

void SamplePaths::step(const Vector& inputs) {
  std::vector<Index> finite;
  noise_factor_.resize(count());
  for (Index i = 0; i < count(); ++i) {
    Index& mode = modes_[static_cast<std::size_t>(i)];
    mode = draw_next_mode(mode, states_.col(i), inputs);
    const LinearModel& model = bank_.modes[static_cast<std::size_t>(mode)].model;
    propagate(model.A, model.B, model.c, states_.col(i), inputs, next_);
    if (!bank_.terms.empty()) add_terms(mode, states_.col(i), inputs);
    predicted_.col(i) = next_;
    noise_factor_(i) = bank_.noise_factor.empty() ? 1.0 : bank_.noise_factor.at(states_.col(i), inputs);
    add_draw(noise_root_[static_cast<std::size_t>(mode)], next_, std::sqrt(noise_factor_(i)));
    states_.col(i) = next_;
    if ((states_.col(i).array().abs() < largest_mean).all()) finite.push_back(i);
  }
  if (std::ssize(finite) == count()) return;
  lost_ += count() - std::ssize(finite);
  for (std::size_t i = 0; i < finite.size(); ++i) modes_[i] = modes_[static_cast<std::size_t>(finite[i])];
  modes_.resize(finite.size());
  states_ = states_(Eigen::all, finite).eval();
  predicted_ = predicted_(Eigen::all, finite).eval();
  noise_factor_ = noise_factor_(finite).eval();
}

void SamplePaths::arrive(Index) {
  Eigen::MatrixXd measured = bank_.C * states_;
  for (Index i = 0; i < measured.cols(); ++i) add_draw(R_root_, measured.col(i));
  sorted_ = measured.transpose();
  for (Index s = 0; s < sorted_.cols(); ++s) std::sort(sorted_.col(s).begin(), sorted_.col(s).end());
  share_.setZero();
  for (const Index mode : modes_) share_(mode) += 1.0;
  if (count() > 0) share_ /= static_cast<double>(count());
}

double SamplePaths::mean(Index i) const {
  return count() > 0 ? bank_.C.row(i).dot(predicted_.rowwise().mean()) : not_a_number;
}

double SamplePaths::standard_deviation(Index i) const {
  if (count() < 2) return not_a_number;
  const Eigen::ArrayXd y = (bank_.C.row(i) * states_).transpose();
  return std::sqrt((y - y.mean()).square().sum() / static_cast<double>(count() - 1) + R_(i, i));
}

// The i-th of M sorted values is the quantile at i / (M + 1), with linear interpolation. A further path lies below this
// value with probability i / (M + 1).

double SamplePaths::probability(Index i, double y) const {
  const auto values = sorted_.col(i);
  const Index M = values.size(), below = std::lower_bound(values.begin(), values.end(), y) - values.begin();
  double rank = static_cast<double>(below);
  if (below == 0 || below == M)
    rank += 0.5;
  else if (const double gap = values(below) - values(below - 1); gap > 0.0)
    rank += (y - values(below - 1)) / gap;
  return rank / static_cast<double>(M + 1);
}

double SamplePaths::quantile(Index i, double p) const {
  const auto values = sorted_.col(i);
  if (values.size() == 0) return not_a_number;
  const double place =
      std::clamp(p * static_cast<double>(values.size() + 1) - 1.0, 0.0, static_cast<double>(values.size() - 1));
  const auto below = static_cast<Index>(place);
  const Index above = std::min(below + 1, values.size() - 1);
  return values(below) + (place - static_cast<double>(below)) * (values(above) - values(below));
}

/// Log density of an error with covariance S; for rounded signals with the masses of their intervals.
double SamplePaths::log_density_of_mode(Eigen::VectorXd error, const Eigen::MatrixXd& S) const {
  small::Ldl<Eigen::Dynamic> factor(S.rows());
  factor.factorise(S);
  factor.decorrelate(error);
  double sum = 0.0;
  for (Index i = 0; i < error.size(); ++i)
    sum += ModeSignal{error(i), factor.D(i)}.log_density(bank_.is_quantised() ? bank_.quantum(i) : 0.0);
  return sum;
}

double SamplePaths::observe(const Vector& y, Eigen::Ref<Eigen::VectorXd> error) {
  for (Index i = 0; i < y.size(); ++i) error(i) = y(i) - mean(i);
  const Eigen::MatrixXd predicted = bank_.C * predicted_;
  Eigen::VectorXd log_likelihood = Eigen::VectorXd::Constant(share_.size(), lowest_log_density), posterior = share_;
  for (Index j = 0; j < share_.size(); ++j) {
    std::vector<Index> in_mode;
    for (Index i = 0; i < count(); ++i)
      if (modes_[static_cast<std::size_t>(i)] == j) in_mode.push_back(i);
    if (in_mode.empty()) continue;
    Eigen::MatrixXd centred = predicted(Eigen::all, in_mode);
    const Eigen::VectorXd mean = centred.rowwise().mean();
    centred.colwise() -= mean;
    const Eigen::MatrixXd S = centred * centred.transpose() / static_cast<double>(in_mode.size()) +
                              bank_.C * step_noise(j, in_mode) * bank_.C.transpose() + R_;
    log_likelihood(j) = log_density_of_mode(y - mean, S);
  }
  return count() > 0 ? bayes(share_, log_likelihood, posterior) : not_a_number;
}

}  // namespace modebank
