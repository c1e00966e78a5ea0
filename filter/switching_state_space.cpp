#include "filter/switching_state_space.hpp"

#include <tbb/parallel_for.h>

#include "filter/backward_pass.hpp"
#include "filter/refine_start.hpp"
#include "filter/refined_modes.hpp"

namespace modebank {
namespace {

constexpr double negligible_pair = 1e-9;  // probability of two modes in a row

SwitchingSums no_sums(const LinearStructure& s, Index K) {
  const Index q = s.regressors(), n = s.states;
  const ModeSums none{Eigen::MatrixXd::Zero(q, q), Eigen::MatrixXd::Zero(q, n), Eigen::MatrixXd::Zero(n, n)};
  return {std::vector<ModeSums>(static_cast<std::size_t>(K), none), Eigen::MatrixXd::Zero(K, K),
          Eigen::VectorXd::Zero(K)};
}

void add(const StateSpaceSums& run, StateSpaceSums& all) {
  for (std::size_t j = 0; j < all.switching.modes.size(); ++j) {
    ModeSums& to = all.switching.modes[j];
    const ModeSums& from = run.switching.modes[j];
    to.G += from.G;
    to.H += from.H;
    to.S += from.S;
    to.transitions += from.transitions;
  }
  all.switching.switches += run.switching.switches;
  all.switching.first += run.switching.first;
  all.residuals += run.residuals;
  all.measurements += run.measurements;
}

/// Expected sums over the transitions of one step into one mode, of the state z before it and r, by which the newest
/// states after it differ from what the prior's mean makes of z alone.
template <int N, int NY>
struct StepSums {
  double weight = 0.0;
  Eigen::Matrix<double, N, 1> z;
  Eigen::Matrix<double, N, N> zz;
  Eigen::Matrix<double, NY, 1> r;
  Eigen::Matrix<double, N, NY> zr;
  Eigen::Matrix<double, NY, NY> rr;

  StepSums(Index n, Index n_y) : z(n), zz(n, n), r(n_y), zr(n, n_y), rr(n_y, n_y) { clear(); }
  void clear() {
    weight = 0.0;
    z.setZero();
    zz.setZero();
    r.setZero();
    zr.setZero();
    rr.setZero();
  }
};

/// The sums of one run.
template <int N, int NY>
class RunExpectation {
 public:
  RunExpectation(const Bank& bank, const Trajectory& run, const SwitchingPrior& prior, TimeSteps time_steps,
                 double weight_unit)
      : structure_(bank.structure),
        run_(run),
        weight_unit_(weight_unit),
        instants_(bank, run, time_steps),
        model_(bank, {}),
        n_(structure_.dimension()),
        n_y_(structure_.states),
        coefficients_(coefficients(structure_, prior.mean).transpose()),
        F_(coefficients_.leftCols(n_)),
        steps_(model_.modes.size(), StepSums<N, NY>(n_, n_y_)),
        sums{no_sums(structure_, model_.mode_count()), Eigen::VectorXd::Zero(n_y_), Eigen::VectorXd::Zero(n_y_)} {
    F_.leftCols(n_y_) += Eigen::MatrixXd::Identity(n_y_, n_y_);
    const FilteredHistory<N, NY> history(model_, instants_, run_);
    BackwardPass<N, NY> pass(model_, history, negligible_pair);
    for (Index t = instants_.count() - 1; t >= 0; --t) {
      if (instants_.continues(t)) {
        pass.step(t, instants_.inputs.col(t + 1), [this](const SmoothedPair<N>& pair) { add_pair(pair); });
        finish_step(t);
      } else {
        pass.begin(t);
      }
      add_measurement(instants_.instants[static_cast<std::size_t>(t)], pass);
    }
  }

 private:
  LinearStructure structure_;
  const Trajectory& run_;
  double weight_unit_;
  RunInstants instants_;
  FilterModel<N, NY> model_;
  Index n_, n_y_;
  Eigen::MatrixXd coefficients_;        // n_y x q, of the prior's mean
  Eigen::Matrix<double, NY, N> F_;      // what it makes of z: [I 0] + A
  std::vector<StepSums<N, NY>> steps_;  // K

 public:
  StateSpaceSums sums;

 private:
  void add_pair(const SmoothedPair<N>& pair) {
    StepSums<N, NY>& to = steps_[pair.to];
    const Eigen::Matrix<double, N, NY> cross = pair.gain * pair.next.covariance.leftCols(n_y_);
    const Eigen::Matrix<double, N, NY> zF = pair.now.covariance * F_.transpose();
    const Eigen::Matrix<double, NY, 1> r = pair.next.mean.head(n_y_) - F_ * pair.now.mean;
    const Eigen::Matrix<double, NY, NY> Fc = F_ * cross;
    to.weight += pair.weight;
    to.z += pair.weight * pair.now.mean;
    to.zz += pair.weight * (pair.now.mean * pair.now.mean.transpose() + pair.now.covariance);
    to.r += pair.weight * r;
    to.zr += pair.weight * (pair.now.mean * r.transpose() + cross - zF);
    to.rr += pair.weight *
             (r * r.transpose() + pair.next.covariance.topLeftCorner(n_y_, n_y_) - Fc - Fc.transpose() + F_ * zF);
    sums.switching.switches(static_cast<Index>(pair.from), static_cast<Index>(pair.to)) += pair.weight;
  }

  /// Of the step from t to t + 1: the inputs join the regressors, and what the prior's mean makes of them leaves r.
  void finish_step(Index t) {
    const Index rest = structure_.regressors() - n_;
    Eigen::VectorXd e = Eigen::VectorXd::Ones(rest);
    e.head(instants_.inputs.rows()) = instants_.inputs.col(t + 1);
    const Eigen::VectorXd b = coefficients_.rightCols(rest) * e;
    const double g = sample_weight(t + 1);
    for (std::size_t k = 0; k < steps_.size(); ++k) {
      StepSums<N, NY>& s = steps_[k];
      if (s.weight > 0.0 && g > 0.0) add_step(s, e, b, g, sums.switching.modes[k]);
      s.clear();
    }
  }

  void add_step(const StepSums<N, NY>& s, const Eigen::VectorXd& e, const Eigen::VectorXd& b, double g,
                ModeSums& to) const {
    const Index rest = e.size();
    const Eigen::VectorXd r = s.r - s.weight * b;
    const Eigen::MatrixXd rb = s.r * b.transpose();
    to.G.topLeftCorner(n_, n_) += g * s.zz;
    to.G.topRightCorner(n_, rest) += g * s.z * e.transpose();
    to.G.bottomLeftCorner(rest, n_) += g * e * s.z.transpose();
    to.G.bottomRightCorner(rest, rest) += g * s.weight * e * e.transpose();
    to.H.topRows(n_) += g * (s.zr - s.z * b.transpose());
    to.H.bottomRows(rest) += g * e * r.transpose();
    to.S += g * (s.rr - rb - rb.transpose() + s.weight * b * b.transpose());
    to.transitions += g * s.weight;
  }

  double sample_weight(Index t) const {
    const Index sample = instants_.instants[static_cast<std::size_t>(t)].sample;
    return run_.weight.size() > 0 && sample >= 0 ? run_.weight(sample) / weight_unit_ : 1.0;
  }

  void add_measurement(const Instant& instant, const BackwardPass<N, NY>& pass) {
    if (instant.starts) {
      sums.switching.first += pass.probability;
      for (Index lag = 0; lag < structure_.state_lags; ++lag)
        add_residuals(instant.start.segment(lag * n_y_, n_y_), lag * n_y_, pass);
    } else if (instant.sample >= 0) {
      add_residuals(run_.state.col(instant.sample), 0, pass);
    }
  }

  /// `y` measured what the state holds from position `first` on.
  template <class Y>
  void add_residuals(const Y& y, Index first, const BackwardPass<N, NY>& pass) {
    for (Index i = 0; i < n_y_; ++i) {
      if (is_missing(y(i))) continue;
      sums.measurements(i) += 1.0;
      for (std::size_t j = 0; j < pass.modes.size(); ++j) {
        const Gaussian<N>& mode = pass.modes[j];
        const double e = y(i) - mode.mean(first + i);
        sums.residuals(i) += pass.probability(static_cast<Index>(j)) * (e * e + mode.covariance(first + i, first + i));
      }
    }
  }
};

}  // namespace

double mean_training_weight(const Recording& recording) {
  double sum = 0.0, count = 0.0;
  for (const Trajectory& run : recording.runs)
    if (run.role == Role::train && run.weight.size() > 0) {
      sum += run.weight.tail(run.transitions()).sum();
      count += static_cast<double>((run.weight.tail(run.transitions()).array() > 0.0).count());
    }
  return sum > 0.0 ? sum / count : 1.0;
}

StateSpaceSums smooth_states(const Bank& bank, const Recording& recording, const SwitchingPrior& prior,
                             TimeSteps time_steps) {
  const Index n_y = bank.C.rows();
  StateSpaceSums all{no_sums(bank.structure, bank.mode_count()), Eigen::VectorXd::Zero(n_y),
                     Eigen::VectorXd::Zero(n_y)};
  const double unit = mean_training_weight(recording);
  std::vector<StateSpaceSums> of_run(recording.runs.size(), all);
  tbb::parallel_for(std::size_t{0}, of_run.size(), [&](std::size_t i) {
    const Trajectory& run = recording.runs[i];
    if (run.role != Role::train) return;
    of_run[i] = with_sizes(bank.structure.dimension(), n_y, [&]<int N, int NY>() {
      return RunExpectation<N, NY>(bank, run, prior, time_steps, unit).sums;
    });
  });
  for (const StateSpaceSums& run : of_run) add(run, all);
  return all;
}

void step_state_space(const Recording& recording, const SwitchingPrior& prior, SharedParts shared, TimeSteps time_steps,
                      const Eigen::VectorXd& least_R, bool estimate_R, Bank& bank) {
  const StateSpaceSums sums = smooth_states(bank, recording, prior, time_steps);
  SwitchingRegression model = switching_model(bank);
  maximise(bank.structure, sums.switching, prior, shared, model);
  bank = with_modes(bank, model);
  for (Index i = 0; estimate_R && i < bank.R.rows(); ++i)
    if (sums.measurements(i) > 0.0) bank.R(i, i) = std::max(sums.residuals(i) / sums.measurements(i), least_R(i));
}

}  // namespace modebank
