#include <cmath>
#include <utility>

#include "filter/judge/run/free_run_forecasts.hpp"
#include "ident/base/covariance.hpp"
#include "ident/base/not_a_number.hpp"

namespace modebank {

using Eigen::Index;

PathForecast::PathForecast(const Bank& bank, Index paths, std::uint64_t seed, TransitionRow row)
    : C_(bank.C),
      R_(bank.recording_noise()),
      R_root_(covariance_root(R_)),
      quantum_(bank.is_quantised() ? bank.quantum : Eigen::VectorXd()),
      paths_(bank, paths, seed, std::move(row)),
      share_(bank.mode_count()) {}

void PathForecast::arrive(Index) {
  Eigen::MatrixXd measured = C_ * paths_.states();
  for (Index i = 0; i < measured.cols(); ++i) paths_.add_draw(R_root_, measured.col(i));
  sorted_ = measured.transpose();
  for (Index s = 0; s < sorted_.cols(); ++s) std::sort(sorted_.col(s).begin(), sorted_.col(s).end());
  share_.setZero();
  for (const Index mode : paths_.modes()) share_(mode) += 1.0;
  if (paths_.count() > 0) share_ /= static_cast<double>(paths_.count());
}

Eigen::VectorXd PathForecast::mean() const {
  if (paths_.count() == 0) return Eigen::VectorXd::Constant(C_.rows(), not_a_number);
  return C_ * paths_.predicted().rowwise().mean();
}

Eigen::VectorXd PathForecast::standard_deviation() const {
  if (paths_.count() < 2) return Eigen::VectorXd::Constant(C_.rows(), not_a_number);
  const Eigen::MatrixXd y = C_ * paths_.states();
  const Eigen::MatrixXd centred = y.colwise() - y.rowwise().mean();
  const Eigen::ArrayXd variance = centred.array().square().rowwise().sum() / static_cast<double>(y.cols() - 1);
  return (variance + R_.diagonal().array()).sqrt();
}

// The i-th of M sorted values is the quantile at i / (M + 1), with linear interpolation. A further path lies below this
// value with probability i / (M + 1).

double PathForecast::probability(Index i, double y) const {
  const auto values = sorted_.col(i);
  const double M = static_cast<double>(values.size());
  const Index below = std::lower_bound(values.begin(), values.end(), y) - values.begin();
  double rank = static_cast<double>(below);
  if (below == 0)
    rank = 0.5;
  else if (below == values.size())
    rank = M + 0.5;
  else if (const double gap = values(below) - values(below - 1); gap > 0.0)
    rank += (y - values(below - 1)) / gap;
  return rank / (M + 1.0);
}

double PathForecast::quantile(Index i, double p) const {
  const auto values = sorted_.col(i);
  if (values.size() == 0) return not_a_number;
  const double place =
      std::clamp(p * static_cast<double>(values.size() + 1) - 1.0, 0.0, static_cast<double>(values.size() - 1));
  const auto below = static_cast<Index>(place);
  const Index above = std::min(below + 1, values.size() - 1);
  return values(below) + (place - static_cast<double>(below)) * (values(above) - values(below));
}

/// Log density of an error with covariance S; for rounded signals with the masses of their intervals.
double PathForecast::log_density_of_mode(Eigen::VectorXd error, const Eigen::MatrixXd& S) const {
  if (quantum_.size() == 0) return modebank::log_density(StudentNoise(0.0), error, S);
  small::Ldl<Eigen::Dynamic> factor(S.rows());
  factor.factorise(S);
  factor.decorrelate(error);
  double sum = 0.0;
  for (Index i = 0; i < error.size(); ++i) sum += ModeSignal{error(i), factor.D(i)}.log_density(quantum_(i));
  return sum;
}

double PathForecast::log_density(const Vector& y) {
  const Eigen::MatrixXd predicted = C_ * paths_.predicted();
  Eigen::VectorXd log_likelihood = Eigen::VectorXd::Constant(share_.size(), lowest_log_density), posterior = share_;
  for (Index j = 0; j < share_.size(); ++j) {
    std::vector<Index> in_mode;
    for (Index i = 0; i < paths_.count(); ++i)
      if (paths_.modes()[static_cast<std::size_t>(i)] == j) in_mode.push_back(i);
    if (in_mode.empty()) continue;
    Eigen::MatrixXd centred = predicted(Eigen::all, in_mode);
    const Eigen::VectorXd mean = centred.rowwise().mean();
    centred.colwise() -= mean;
    const Eigen::MatrixXd S = centred * centred.transpose() / static_cast<double>(in_mode.size()) +
                              C_ * paths_.step_noise(j, in_mode) * C_.transpose() + R_;
    log_likelihood(j) = log_density_of_mode(y - mean, S);
  }
  return paths_.count() > 0 ? bayes(share_, log_likelihood, posterior) : not_a_number;
}

}  // namespace modebank
