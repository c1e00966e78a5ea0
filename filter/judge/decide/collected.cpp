#include "filter/judge/decide/collected.hpp"

#include <cmath>
#include <iterator>

#include "filter/judge/score/squared_distances.hpp"
#include "filter/step/equations/bounds.hpp"
#include "ident/base/linalg.hpp"

namespace modebank {

namespace {

using Eigen::Index;

/// Collects counts over runs, for the whole filter (mode -1) or one mode.
class Collector {
 public:
  /// `nees_states`: the states of the NEES.
  Collector(const Bank& bank, Index mode, bool chi_square_nis, const std::vector<Index>& nees_states)
      : mode_(mode), nees_states_(nees_states) {
    sums.squared_state_error.setZero(bank.C.rows());
    sums.counts.nis_degrees = static_cast<double>(bank.C.rows());
    sums.counts.chi_square_nis = chi_square_nis;
  }

  Collected sums;

  void add(const Trajectory& run, const RunEvaluation& e, const RunScores& scores) {
    BandCounts& counts = sums.counts;
    for (HitsByRun* hits : {&counts.far, &counts.close}) hits->emplace_back();
    for (HitsByRun& hits : counts.outside) hits.emplace_back();
    counts.sizes.emplace_back();
    for (SquaredDistances* distances : {&counts.nis, &sums.nees}) distances->begin_run();
    OutputSeries z(static_cast<std::size_t>(e.pit.rows()));  // samples of one mode only
    if (mode_ < 0) make_room(e, z);
    for (Index k = 0; k < e.log_density.size(); ++k) {
      if (std::isnan(e.log_density(k))) continue;
      add_probabilities(e, k);
      if (mode_ >= 0 && scores.likeliest(k) != mode_) continue;
      add_scores(e, k, scores, z);
      if (run.truth.size() > 0) add_truth(run, e, k);
    }
    sums.whiteness.push_back(mode_ < 0 ? scores.whiteness_p : whiteness_p(z));
    if (mode_ < 0) sums.z.insert(sums.z.end(), std::make_move_iterator(z.begin()), std::make_move_iterator(z.end()));
    add_visits(e);
  }

  /// Finds the largest lag-1 autocorrelation. The samples of one mode only are no neighbours, so they have none.
  void correlate() {
    const std::size_t signals = static_cast<std::size_t>(sums.squared_state_error.size());
    for (std::size_t i = 0; i < signals; ++i) {
      SeriesByRun z;
      for (std::size_t run = i; run < sums.z.size(); run += signals) z.push_back(sums.z[run]);
      const double value = largest_autocorrelation(z, 1).value;
      if (std::abs(value) > std::abs(sums.counts.correlation)) sums.counts.correlation = value;
    }
  }

 private:
  /// Reserves memory for all samples of a run. Without this, growing series would take up to twice the memory.
  void make_room(const RunEvaluation& e, OutputSeries& z) {
    BandCounts& counts = sums.counts;
    const auto samples = static_cast<std::size_t>(e.log_density.size()), all = samples * z.size();
    for (HitsByRun* hits : {&counts.far, &counts.close}) hits->back().reserve(all);
    for (HitsByRun& hits : counts.outside) hits.back().reserve(all);
    counts.sizes.back().reserve(all);
    for (SeriesByRun* series : {&counts.nis.value, &counts.nis.degrees}) series->back().reserve(samples);
    for (std::vector<double>& output : z) output.reserve(samples);
  }

  Index mode_;
  const std::vector<Index>& nees_states_;
  ScoreBands bands_;

  void add_probabilities(const RunEvaluation& e, Index k) {
    const auto mu = e.mode_probability.col(k);
    ++sums.entropy_samples;
    sums.usage += mode_ < 0 ? mu.maxCoeff() : mu(mode_);
    if (mu.size() < 2) return;
    double entropy = 0.0;
    for (const double p : mu) entropy -= p > 0.0 ? p * std::log(p) : 0.0;
    sums.entropy += entropy / std::log(static_cast<double>(mu.size()));
  }

  void add_scores(const RunEvaluation& e, Index k, const RunScores& scores, OutputSeries& z) {
    ++sums.samples;
    sums.failed += e.log_density(k) <= lowest_log_density ? 1 : 0;
    for (Index i = 0; i < e.pit.rows(); ++i) {
      if (std::isnan(e.pit(i, k))) continue;
      const double score = scores.z(i, k);
      const ScoreBands::Hits hits = bands_.of(score);
      for (std::size_t b = 0; b < hits.outside.size(); ++b)
        sums.counts.outside[b].back().push_back(hits.outside[b] ? 1 : 0);
      sums.counts.far.back().push_back(hits.far ? 1 : 0);
      sums.counts.close.back().push_back(hits.close ? 1 : 0);
      sums.counts.sizes.back().push_back(std::abs(score));
      z[static_cast<std::size_t>(i)].push_back(score);
    }
    sums.counts.nis.add(e.nis(k), scored_signals(e, k));
  }

  void add_truth(const Trajectory& run, const RunEvaluation& e, Index k) {
    const Index n = run.truth.rows(), all = e.state.rows();
    const Eigen::VectorXd error = e.state.col(k).head(n) - run.truth.col(k);
    if (!error.allFinite()) return;
    if (!nees_states_.empty()) {
      const Eigen::MatrixXd P = e.covariance.col(k).reshaped(all, all)(nees_states_, nees_states_);
      const Eigen::VectorXd judged = error(nees_states_);
      sums.nees.add(judged.dot(solve_semidefinite(P, judged)), judged.size());
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

}  // namespace

Collected collect(const Bank& bank, Index mode, Role role, bool chi_square_nis, const std::vector<Index>& nees_states,
                  const std::vector<Trajectory>& runs, const std::vector<RunEvaluation>& evaluations,
                  const std::vector<RunScores>& scores) {
  Collector collector(bank, mode, chi_square_nis, nees_states);
  for (std::size_t i = 0; i < runs.size(); ++i)
    if (runs[i].role == role) collector.add(runs[i], evaluations.at(i), scores.at(i));
  collector.correlate();
  return std::move(collector.sums);
}

}  // namespace modebank
