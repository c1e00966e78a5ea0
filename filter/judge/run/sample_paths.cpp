#include "filter/judge/run/sample_paths.hpp"

#include <boost/random/normal_distribution.hpp>
#include <boost/random/uniform_01.hpp>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "filter/step/equations/bounds.hpp"
#include "ident/base/covariance.hpp"

namespace modebank {

using Eigen::Index;

namespace {

/// Mode probabilities by the bank's transition matrix. If they depend on the state, they are evaluated at the state of
/// each path.
TransitionRow bank_row(const Bank& bank) {
  if (bank.mode_count() == 1)
    return [](Index mode, const auto&, const auto&, Eigen::VectorXd& row) { row.setZero()(mode) = 1.0; };
  return [T = bank.transition.matrix(), logit = bank.transition_logit,
          at = TransitionWorkspace(bank.mode_count(), bank.transition_logit)](
             Index mode, const auto& state, const auto& inputs, Eigen::VectorXd& row) mutable {
    row = transition_at(T, logit, state, inputs, at).row(mode).transpose();
  };
}

}  // namespace

SamplePaths::SamplePaths(const Bank& bank, Index paths, std::uint64_t seed, TransitionRow row)
    : bank_(bank),
      paths_(paths),
      row_(row ? std::move(row) : bank_row(bank_)),
      generator_(seed),
      probability_(bank.mode_count()),
      regressor_(bank.structure.regressors()),
      next_(bank.structure.dimension()) {
  if (paths < 2) throw std::invalid_argument("at least two sample paths, not " + std::to_string(paths));
}

void SamplePaths::add_draw(const Eigen::MatrixXd& root, Eigen::Ref<Eigen::VectorXd> to, double scale) {
  boost::random::normal_distribution<double> standard;
  normal_.resize(root.cols());
  for (double& value : normal_) value = standard(generator_);
  to.noalias() += scale * (root * normal_);
}

Index SamplePaths::draw_mode(const Eigen::VectorXd& probability) {
  double u = boost::random::uniform_01<double>()(generator_) * probability.sum();
  Index mode = 0;
  while (mode + 1 < probability.size() && (u -= probability(mode)) >= 0.0) ++mode;
  while (mode > 0 && !(probability(mode) > 0.0)) --mode;  // reached only by rounding
  return mode;
}

void SamplePaths::start(const FilterMemory& origin) {
  const Index n = next_.size();
  std::vector<Eigen::MatrixXd> start_root;
  noise_.clear();
  noise_root_.clear();
  for (Index j = 0; j < bank_.mode_count(); ++j) {
    start_root.push_back(covariance_root(origin.covariances.col(j).reshaped(n, n)));
    noise_.emplace_back(bank_.modes[static_cast<std::size_t>(j)].Q);
    noise_root_.push_back(covariance_root(noise_.back()));
  }
  states_.resize(n, paths_);
  predicted_.resize(n, paths_);
  modes_.resize(static_cast<std::size_t>(paths_));
  lost_ = 0;
  for (Index i = 0; i < paths_; ++i) {
    const Index mode = draw_mode(origin.mode_probability);
    modes_[static_cast<std::size_t>(i)] = mode;
    states_.col(i) = origin.means.col(mode);
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
  return noise_factor_(in_mode).mean() * noise_[static_cast<std::size_t>(mode)];
}

void SamplePaths::step(const Vector& inputs) {
  std::vector<Index> finite;
  noise_factor_.resize(count());
  for (Index i = 0; i < count(); ++i) {
    Index& mode = modes_[static_cast<std::size_t>(i)];
    row_(mode, states_.col(i), inputs, probability_);
    mode = draw_mode(probability_);
    const LinearModel& model = bank_.modes[static_cast<std::size_t>(mode)].model;
    propagate(model.A, model.B, model.c, states_.col(i), inputs, next_);
    if (!bank_.terms.empty()) add_terms(mode, states_.col(i), inputs);
    predicted_.col(i) = next_;
    noise_factor_(i) = bank_.noise_factor.empty() ? 1.0 : bank_.noise_factor.at(states_.col(i), inputs);
    add_draw(noise_root_[static_cast<std::size_t>(mode)], next_, std::sqrt(noise_factor_(i)));
    states_.col(i) = next_;
    if ((states_.col(i).array().abs() < largest_mean).all()) finite.push_back(i);
  }
  if (std::ssize(finite) < count()) keep(finite);
}

void SamplePaths::keep(const std::vector<Index>& which) {
  lost_ += count() - std::ssize(which);
  std::vector<Index> modes;
  for (const Index i : which) modes.push_back(modes_[static_cast<std::size_t>(i)]);
  modes_ = std::move(modes);
  states_ = states_(Eigen::all, which).eval();
  predicted_ = predicted_(Eigen::all, which).eval();
  noise_factor_ = noise_factor_(which).eval();
}

}  // namespace modebank
