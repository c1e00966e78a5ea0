#include "filter/judge/run/horizon.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "filter/judge/run/drifting.hpp"
#include "filter/step/feed/run_samples.hpp"
#include "filter/step/forecast.hpp"
#include "ident/base/not_a_number.hpp"

namespace modebank {

namespace {

using Eigen::Index;

/// Predicts ahead from the filter's state at one moment.
template <int N, int NY>
class HorizonScores {
 public:
  HorizonScores(const FilterModel<N, NY>& model, const RunInstants& instants, const Trajectory& run,
                HorizonEvaluation& out)
      : instants_(instants), run_(run), out_(out), forecast_(model) {}

  void from(Index t, const FilterState<N>& state) {
    forecast_.start(state);
    look_ahead(forecast_, instants_, t, out_.horizons, [&](std::size_t horizon, Index k) { score(horizon, k); });
  }

 private:
  const RunInstants& instants_;
  const Trajectory& run_;
  HorizonEvaluation& out_;
  BankForecast<N, NY> forecast_;

  void score(std::size_t horizon, Index k) {
    const auto y = run_.state.col(k);
    if (missing_entries(y) > 0) return;
    out_.log_density(static_cast<Index>(horizon), k) = forecast_.observe(y, out_.error[horizon].col(k));
    for (Index i = 0; i < y.size(); ++i) out_.pit[horizon](i, k) = forecast_.signal(i).probability(y(i));
  }
};

template <int N, int NY>
void score_horizons(const Bank& bank, const Trajectory& run, const FilterOptions& options, HorizonEvaluation& out) {
  const FilterModel<N, NY> model(bank, options);
  const RunInstants instants(bank, run);
  FilterStep<N, NY> step(model);
  FilterState<N> state = initial_state(model);
  HorizonScores<N, NY> look(model, instants, run, out);
  for (Index t = 0; t < instants.count(); ++t) {
    step_to(model, instants, t, run, state, step);
    if (instants.instants[static_cast<std::size_t>(t)].sample >= 0) look.from(t, state);
  }
}

}  // namespace

HorizonEvaluation empty_horizons(std::vector<Index> horizons, Index n_y, Index samples) {
  std::sort(horizons.begin(), horizons.end());
  horizons.erase(std::unique(horizons.begin(), horizons.end()), horizons.end());
  if (!horizons.empty() && horizons.front() < 1) throw std::invalid_argument("horizons must be at least 1");
  HorizonEvaluation out;
  out.error.assign(horizons.size(), Eigen::MatrixXd::Constant(n_y, samples, not_a_number));
  out.pit = out.error;
  out.log_density.setConstant(std::ssize(horizons), samples, not_a_number);
  out.horizons = std::move(horizons);
  return out;
}

HorizonEvaluation evaluate_horizons(const Bank& bank, const Trajectory& run, const FilterOptions& options,
                                    std::vector<Index> horizons) {
  if (!bank.running_noise.empty()) return drifting_horizons(bank, run, std::move(horizons));
  check_run(bank, run);
  HorizonEvaluation out = empty_horizons(std::move(horizons), bank.C.rows(), run.samples());
  with_sizes(bank.structure.dimension(), bank.C.rows(),
             [&]<int N, int NY>() { score_horizons<N, NY>(bank, run, options, out); });
  return out;
}

HorizonSums& HorizonSums::operator+=(const HorizonSums& other) {
  samples += other.samples;
  log_density += other.log_density;
  squared_error += other.squared_error;
  inside += other.inside;
  return *this;
}

std::vector<HorizonSums> sum_horizons(const HorizonEvaluation& run) {
  std::vector<HorizonSums> sums;
  for (std::size_t h = 0; h < run.horizons.size(); ++h) {
    const Eigen::MatrixXd& error = run.error[h];
    HorizonSums& sum = sums.emplace_back(HorizonSums{run.horizons[h], 0, 0.0, Eigen::ArrayXd::Zero(error.rows())});
    for (Index k = 0; k < error.cols(); ++k) {
      const double value = run.log_density(static_cast<Index>(h), k);
      if (std::isnan(value)) continue;
      ++sum.samples;
      sum.log_density += value;
      sum.squared_error += error.col(k).array().square();
      sum.inside += static_cast<double>(((run.pit[h].col(k).array() - 0.5).abs() <= 0.475).count());
    }
  }
  return sums;
}

std::vector<HorizonRow> summarize_horizons(const std::string& filter, const std::vector<Trajectory>& runs,
                                           const std::vector<std::vector<HorizonSums>>& sums) {
  std::vector<HorizonRow> rows;
  const auto add_row = [&](Role role, const std::string& run, const HorizonSums& of) {
    const double N = of.samples > 0 ? static_cast<double>(of.samples) : not_a_number;
    const double inside = of.inside / (N * static_cast<double>(of.squared_error.size()));
    rows.push_back(
        {filter, role, run, of.horizon, of.samples, of.log_density / N, (of.squared_error / N).sqrt(), inside});
  };
  for (const Role role : {Role::train, Role::test}) {
    std::vector<HorizonSums> pooled;
    for (std::size_t i = 0; i < runs.size(); ++i) {
      if (runs[i].role != role) continue;
      const std::vector<HorizonSums>& single = sums.at(i);
      for (const HorizonSums& of : single) add_row(role, runs[i].run, of);
      if (pooled.empty())
        pooled = single;
      else
        for (std::size_t h = 0; h < pooled.size(); ++h) pooled[h] += single.at(h);
    }
    for (const HorizonSums& of : pooled) add_row(role, "*", of);
  }
  return rows;
}

}  // namespace modebank
