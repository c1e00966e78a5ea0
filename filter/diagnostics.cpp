#include "filter/diagnostics.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "filter/calibration.hpp"
#include "filter/diagnostics_flags.hpp"
#include "ident/not_a_number.hpp"

namespace modebank {

namespace {

using Eigen::Index;

constexpr double negligible_R = 1e-6;  // of the innovations' variance
constexpr double outer_probability = 0.025;

/// What is known of the samples that belong to one row.
struct Collected {
  Index samples = 0, entropy_samples = 0;
  double usage = 0.0, entropy = 0.0, spread = 0.0, visits = 0.0, visited = 0.0;
  Evidence evidence;
  SeriesByRun nees;
  std::vector<double> whiteness;
  Eigen::VectorXd squared_state_error;
  Index state_errors = 0;
};

/// Collects over runs for the whole filter (mode -1) or one mode.
class Collector {
 public:
  /// `nees_states`: the states that the NEES is about.
  Collector(const Bank& bank, Index mode, bool chi_square_nis, const std::vector<Index>& nees_states)
      : mode_(mode),
        nees_states_(nees_states),
        lower_(chi_square_quantile(outer_probability, 1.0)),
        upper_(chi_square_quantile(1.0 - outer_probability, 1.0)) {
    sums.squared_state_error.setZero(bank.C.rows());
    sums.evidence.nis_degrees = static_cast<double>(bank.C.rows());
    sums.evidence.chi_square_nis = chi_square_nis;
  }

  Collected sums;

  void add(const Trajectory& run, const RunEvaluation& e) {
    Evidence& evidence = sums.evidence;
    for (SeriesByRun* series : {&evidence.above, &evidence.below, &evidence.sizes, &evidence.nis, &sums.nees})
      series->emplace_back();
    std::vector<std::vector<double>> z(static_cast<std::size_t>(e.pit.rows()));
    for (Index k = 0; k < e.log_density.size(); ++k) {
      if (std::isnan(e.log_density(k))) continue;
      add_probabilities(e, k);
      if (!belongs(e, k)) continue;
      add_scores(e, k, z);
      if (run.truth.size() > 0) add_truth(run, e, k);
    }
    std::vector<double> p_values;
    for (const auto& component : z) p_values.push_back(ljung_box_p(component));
    sums.whiteness.push_back(fisher_p(p_values));
    add_visits(e);
  }

 private:
  Index mode_;
  const std::vector<Index>& nees_states_;
  double lower_, upper_;

  bool belongs(const RunEvaluation& e, Index k) const {
    Index likeliest = 0;
    if (mode_ >= 0) e.mode_probability_predicted.col(k).maxCoeff(&likeliest);
    return mode_ < 0 || likeliest == mode_;
  }

  void add_probabilities(const RunEvaluation& e, Index k) {
    const auto mu = e.mode_probability.col(k);
    ++sums.entropy_samples;
    sums.usage += mode_ < 0 ? mu.maxCoeff() : mu(mode_);
    if (mu.size() < 2) return;
    double entropy = 0.0;
    for (const double p : mu) entropy -= p > 0.0 ? p * std::log(p) : 0.0;
    sums.entropy += entropy / std::log(static_cast<double>(mu.size()));
  }

  void add_scores(const RunEvaluation& e, Index k, std::vector<std::vector<double>>& z) {
    ++sums.samples;
    if (e.spread_share.size() > 0) sums.spread += e.spread_share(k);
    Index signals = 0;
    for (Index i = 0; i < e.pit.rows(); ++i) {
      if (std::isnan(e.pit(i, k))) continue;
      const double score = normal_score(e.pit(i, k));
      ++signals;
      sums.evidence.above.back().push_back(score * score > upper_ ? 1.0 : 0.0);
      sums.evidence.below.back().push_back(score * score < lower_ ? 1.0 : 0.0);
      sums.evidence.sizes.back().push_back(std::abs(score));
      z[static_cast<std::size_t>(i)].push_back(score);
    }
    // Of fewer signals it has fewer degrees of freedom: scaled to the same mean.
    sums.evidence.nis.back().push_back(e.nis(k) * static_cast<double>(e.pit.rows()) / static_cast<double>(signals));
  }

  void add_truth(const Trajectory& run, const RunEvaluation& e, Index k) {
    const Index n = run.truth.rows(), all = e.state.rows();
    const Eigen::VectorXd error = e.state.col(k).head(n) - run.truth.col(k);
    if (!error.allFinite()) return;
    if (!nees_states_.empty()) {
      const Eigen::MatrixXd P = e.covariance.col(k).reshaped(all, all)(nees_states_, nees_states_);
      const Eigen::VectorXd judged = error(nees_states_);
      sums.nees.back().push_back(judged.dot(P.ldlt().solve(judged)));
    }
    sums.squared_state_error += error.cwiseAbs2();
    ++sums.state_errors;
  }

  int mode_at(const RunEvaluation& e, Index k) const {
    if (e.viterbi_mode.size() > 0) return e.viterbi_mode(k);
    int likeliest = 0;
    e.mode_probability.col(k).maxCoeff(&likeliest);
    return std::isnan(e.state(0, k)) ? -1 : likeliest;
  }

  void add_visits(const RunEvaluation& e) {
    int before = -1;
    for (Index k = 0; k < e.log_density.size(); ++k) {
      const int mode = mode_at(e, k);
      if (mode >= 0 && (mode_ < 0 || mode == mode_)) {
        sums.visited += 1.0;
        sums.visits += mode != before ? 1.0 : 0.0;
      }
      before = mode;
    }
  }
};

double total_of(const SeriesByRun& series) {
  return std::accumulate(series.begin(), series.end(), 0.0, [](double sum, const std::vector<double>& run) {
    return std::accumulate(run.begin(), run.end(), sum);
  });
}

/// Fractions of the signals in the tails, and their binomial intervals.
void set_tails(const Evidence& evidence, DiagnosticsRow& row) {
  double scores = 0.0;
  for (const std::vector<double>& run : evidence.above) scores += static_cast<double>(run.size());
  row.tail_above = mean_of(evidence.above);
  row.tail_below = mean_of(evidence.below);
  const Interval above = binomial_interval(total_of(evidence.above), scores),
                 below = binomial_interval(total_of(evidence.below), scores);
  row.tail_above_lower = above.lower;
  row.tail_above_upper = above.upper;
  row.tail_below_lower = below.lower;
  row.tail_below_upper = below.upper;
}

/// The states whose measurement noise is more than next to nothing, so that their stated covariance after the
/// measurement is more than R.
std::vector<Index> states_with_noise(const Bank& bank, Role role, const std::vector<Trajectory>& runs,
                                     const std::vector<RunEvaluation>& evaluations) {
  const Index n_y = bank.C.rows();
  Eigen::ArrayXd variance = Eigen::ArrayXd::Zero(n_y);
  double samples = 0.0;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    if (runs[i].role != role) continue;
    const RunEvaluation& e = evaluations.at(i);
    for (Index k = 0; k < e.log_density.size(); ++k) {
      if (std::isnan(e.log_density(k))) continue;
      variance += e.innovation_covariance.col(k).reshaped(n_y, n_y).diagonal().array();
      samples += 1.0;
    }
  }
  std::vector<Index> states;
  for (Index i = 0; i < n_y; ++i)
    if (samples > 0.0 && bank.R(i, i) * samples >= negligible_R * variance(i)) states.push_back(i);
  return states;
}

/// Of a mean of squared distances whose terms have that many degrees of freedom; `chi_square`: that is their law.
Interval distance_interval(const SeriesByRun& series, bool chi_square, double degrees) {
  const double excess = chi_square ? 1.0 : dispersion(series, degrees);
  return chi_square_mean_interval(series, excess * autocorrelation_time(series), degrees);
}

void set_distances(const Collected& c, double n_y, double nees_states, DiagnosticsRow& row) {
  row.nis_mean = mean_of(c.evidence.nis);
  const Interval nis = distance_interval(c.evidence.nis, c.evidence.chi_square_nis, n_y);
  row.nis_lower = nis.lower;
  row.nis_upper = nis.upper;
  const Interval nees = distance_interval(c.nees, c.evidence.chi_square_nis, nees_states);
  row.nees_mean = mean_of(c.nees);
  row.nees_lower = nees.lower;
  row.nees_upper = nees.upper;
}

DiagnosticsRow make_row(const Collected& c, Index n_y, Index nees_states) {
  DiagnosticsRow row;
  const double N = c.samples > 0 ? static_cast<double>(c.samples) : not_a_number;
  const double all = c.entropy_samples > 0 ? static_cast<double>(c.entropy_samples) : not_a_number;
  row.samples = c.samples;
  row.usage = c.usage / all;
  row.entropy = c.entropy / all;
  row.dwell = c.visits > 0.0 ? c.visited / c.visits : not_a_number;
  row.dwell_model = not_a_number;
  set_tails(c.evidence, row);
  set_distances(c, static_cast<double>(n_y), static_cast<double>(nees_states), row);
  row.state_rmse =
      (c.squared_state_error / (c.state_errors > 0 ? static_cast<double>(c.state_errors) : not_a_number)).cwiseSqrt();
  row.whiteness_p = fisher_p(c.whiteness);
  row.spread_share = c.spread / N;
  row.verdict = judge(c.evidence);
  return row;
}

}  // namespace

std::vector<DiagnosticsRow> diagnose(const std::string& filter, const Bank& bank, const FilterOptions& options,
                                     const std::vector<Trajectory>& runs,
                                     const std::vector<RunEvaluation>& evaluations) {
  // One Gaussian of known variance per prediction.
  const bool chi_square_nis =
      (bank.mode_count() == 1 || options.variant == FilterVariant::kf) && options.noise == FilterNoise::gaussian;
  std::vector<DiagnosticsRow> rows;
  for (const Role role : {Role::train, Role::test}) {
    if (std::none_of(runs.begin(), runs.end(), [role](const Trajectory& run) { return run.role == role; })) continue;
    const std::vector<Index> nees_states = states_with_noise(bank, role, runs, evaluations);
    const auto row_of = [&](Index mode) {
      Collector collector(bank, mode, chi_square_nis, nees_states);
      for (std::size_t i = 0; i < runs.size(); ++i)
        if (runs[i].role == role) collector.add(runs[i], evaluations.at(i));
      DiagnosticsRow row = make_row(collector.sums, bank.C.rows(), std::ssize(nees_states));
      row.filter = filter;
      row.role = role;
      row.mode = mode;
      if (mode >= 0) row.dwell_model = 1.0 / (1.0 - bank.transition.matrix()(mode, mode));
      return row;
    };
    DiagnosticsRow all = row_of(-1);
    std::vector<DiagnosticsRow> modes;
    for (Index mode = 0; bank.mode_count() > 1 && mode < bank.mode_count(); ++mode) modes.push_back(row_of(mode));
    all.flags = flags_of(all, modes, std::ssize(nees_states));
    rows.push_back(std::move(all));
    rows.insert(rows.end(), modes.begin(), modes.end());
  }
  return rows;
}

}  // namespace modebank
