#include "filter/step/drifting.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "filter/step/equations/bounds.hpp"
#include "filter/step/filter_shell.hpp"
#include "filter/step/student_noise.hpp"

namespace modebank {

using Eigen::Index;
using Vector = Eigen::Ref<const Eigen::VectorXd>;

double DriftingModel::factor_at(Index horizon) const {
  double factor = 1.0;
  for (const auto& [ahead, value] : horizon_factor)
    if (ahead <= horizon) factor = value;
  return factor;
}

Eigen::MatrixXd DriftingModel::direction() const {
  if (wandering == Wandering::all) return {};
  Eigen::MatrixXd d = Eigen::MatrixXd::Zero(structure.regressors(), structure.states);
  if (wandering == Wandering::constant) {
    d.bottomRows(1).setOnes();
    return d;
  }
  const auto inputs = Eigen::seqN(structure.dimension(), structure.acting_inputs());
  d(inputs, Eigen::all) = scaled_coefficients(structure, theta0, scale)(inputs, Eigen::all);
  d.colwise().normalize();  // of an output that no input moves nothing wanders
  return d;
}

void validate(const DriftingModel& m) {
  const auto need = [](bool holds, const char* what) {
    if (!holds) throw std::invalid_argument(std::string("drifting model: ") + what);
  };
  const auto positive = [](const Eigen::VectorXd& x) { return x.allFinite() && (x.array() > 0.0).all(); };
  const Index n = m.structure.states;
  need(n >= 1 && m.structure.state_lags >= 1 && m.structure.input_lags >= 1, "needs a state and a sample of each lag");
  need(m.theta0.size() == m.structure.parameters() && m.theta0.allFinite(), "theta0 is not one of its structure");
  need(m.scale.size() == m.structure.regressors() && positive(m.scale), "needs a positive scale per regressor");
  need(m.v0.size() == n && positive(m.v0), "needs a positive variance per state");
  need(m.variance_floor.size() == n && positive(m.variance_floor), "needs a positive least variance per state");
  need(m.quantum.size() == 0 || (m.quantum.size() == n && m.quantum.allFinite() && (m.quantum.array() >= 0.0).all()),
       "needs a quantum per state, or none");
  need(m.rates.q >= 0.0 && m.rates.p0 >= 0.0 && std::isfinite(m.rates.q + m.rates.p0), "q and p0 are variances");
  need(m.rates.leak > 0.0 && m.rates.leak <= 1.0, "leak lies in (0, 1]");
  need(m.wandering != Wandering::constant || m.structure.intercept, "has no constant that could wander");
  need(m.wandering != Wandering::gain || m.structure.inputs > 0, "has no inputs whose gain could wander");
  need(m.lam >= 0.0 && m.lam <= 1.0, "lam lies in [0, 1]");
  for (const auto& [ahead, factor] : m.horizon_factor)
    need(ahead > 1 && factor > 0.0 && std::isfinite(factor), "a horizon's factor is positive, and 1 at horizon 1");
  StudentNoise{m.nu};
}

Bank fixed_bank(const DriftingModel& m) {
  const Index n = m.structure.states, dimension = m.structure.dimension(), p = m.structure.parameters();
  Bank bank;
  bank.structure = m.structure;
  bank.state_names = m.state_names;
  bank.input_names = m.input_names;
  bank.dt_s = m.dt_s;
  bank.C = Eigen::MatrixXd::Identity(n, dimension);
  bank.R = Eigen::MatrixXd::Zero(n, n);
  bank.quantum = m.quantum;
  Eigen::MatrixXd Q = Eigen::MatrixXd::Zero(dimension, dimension);
  Q.diagonal().head(n) = m.v0;
  bank.modes.push_back({unpack(m.structure, m.theta0), Q, Eigen::MatrixXd::Zero(p, p), Eigen::VectorXd::Zero(p), 1.0});
  bank.initial_probability = Eigen::VectorXd::Ones(1);
  return bank;
}

void adapt_variance(const DriftingModel& model, const DriftingRecursion& recursion, Eigen::VectorXd& v) {
  for (Index i = 0; i < v.size(); ++i) {
    const double e = recursion.innovation()(i);
    if (std::isnan(e)) continue;
    v(i) = std::max(model.lam * v(i) + (1.0 - model.lam) * (e * e / recursion.growth(i)), model.variance_floor(i));
  }
}

namespace {

const DriftingModel& validated_drifting(const DriftingModel& model) {
  validate(model);
  return model;
}

bool same_sizes(const DriftingMemory& a, const DriftingMemory& b) {
  const auto shape = [](const Eigen::MatrixXd& x, const Eigen::MatrixXd& y) {
    return x.rows() == y.rows() && x.cols() == y.cols();
  };
  return shape(a.theta, b.theta) && a.z.size() == b.z.size() && a.P.size() == b.P.size() &&
         a.P_of.size() == b.P_of.size() && std::equal(a.P.begin(), a.P.end(), b.P.begin(), shape);
}

/// Throws std::invalid_argument unless the snapshot is one of a filter whose memory looks like `own`.
void check_snapshot(const DriftingSnapshot& snapshot, const DriftingMemory& own) {
  const DriftingMemory& memory = snapshot.coefficients;
  const Index most = std::ssize(own.P);
  if (!same_sizes(memory, own) || snapshot.v.size() != most)
    throw std::invalid_argument("the snapshot is not of this drifting model");
  const bool sound =
      memory.P_count >= 1 && memory.P_count <= most && memory.theta.allFinite() && memory.z.allFinite() &&
      snapshot.v.allFinite() && (snapshot.v.array() > 0.0).all() &&
      std::all_of(memory.P_of.begin(), memory.P_of.end(), [&](Index of) { return of >= 0 && of < memory.P_count; });
  if (!sound) throw std::invalid_argument("the snapshot holds numbers that no drifting model has");
}

}  // namespace

struct DriftingFilter::Parts : FilterShell {
  DriftingModel model;
  StudentNoise noise;
  DriftingRecursion recursion;
  Eigen::VectorXd v;

  Parts(const DriftingModel& m)
      : FilterShell(fixed_bank(m)),
        model(m),
        noise(m.nu),
        recursion(m.structure, m.theta0, m.scale, m.rates, m.direction()),
        v(m.v0) {}

  void start() {
    recursion.start(feed.start());
    v = model.v0;
    record_posterior();
  }

  void step(const Vector& measurement) {
    for (Index i = 1; i < feed.steps(); ++i) {
      recursion.predict(feed.inputs());
      recursion.skip();
    }
    recursion.predict(feed.inputs());
    record_prediction();
    recursion.update(measurement);
    record_scores();
    adapt_variance(model, recursion, v);
    record_posterior();
  }

 private:
  void record_prediction() {
    const Index n = model.structure.states, lagged = estimate.prediction.size() - n;
    estimate.prediction.head(n) = recursion.prediction();
    estimate.prediction.tail(lagged) = recursion.memory().z.head(lagged);
    estimate.innovation_covariance.setZero();
    for (Index i = 0; i < n; ++i) estimate.innovation_covariance(i, i) = v(i) * recursion.growth(i);
    estimate.spread_share = 0.0;
    estimate.steps = feed.steps();
  }

  void record_scores() {
    clear_scores();
    estimate.innovation = recursion.innovation();
    for (Index i = 0; i < v.size(); ++i) {
      const double e = estimate.innovation(i), variance = estimate.innovation_covariance(i, i);
      if (std::isnan(e)) continue;
      if (std::isnan(estimate.nis)) estimate.nis = estimate.log_density = 0.0;
      const double square = e * e / variance;
      estimate.nis += square;
      if (model.quantum.size() > 0 && model.quantum(i) > 0.0) {
        record_interval(i, e, std::sqrt(variance));
        continue;
      }
      estimate.log_density += noise.log_density(square) - 0.5 * std::log(variance);
      estimate.pit(i) = noise.probability(e / std::sqrt(variance));
    }
  }

  /// The interval's probability in the predictive distribution, which is of recorded values already.
  void record_interval(Index i, double e, double deviation) {
    const double half = 0.5 * model.quantum(i);
    const double low = noise.probability((e - half) / deviation), high = noise.probability((e + half) / deviation);
    estimate.pit(i) = 0.5 * (low + high);
    estimate.pit_width(i) = high - low;
    estimate.log_density += noise.log_mass((e - half) / deviation, (e + half) / deviation) - std::log(model.quantum(i));
  }

  void record_posterior() {
    estimate.state = recursion.memory().z;
    estimate.covariance.setZero();
  }
};

DriftingFilter::DriftingFilter(const DriftingModel& model)
    : parts_(std::make_unique<Parts>(validated_drifting(model))) {}

DriftingFilter::~DriftingFilter() = default;
DriftingFilter::DriftingFilter(DriftingFilter&&) noexcept = default;
DriftingFilter& DriftingFilter::operator=(DriftingFilter&&) noexcept = default;

const FilterEstimate& DriftingFilter::step(double time_s, const Vector& input, const Vector& measurement) {
  return take_sample(*parts_, time_s, input, measurement);
}

const FilterEstimate& DriftingFilter::estimate() const { return parts_->estimate; }
bool DriftingFilter::started() const { return parts_->started; }

void DriftingFilter::restart() { parts_->restart(); }

DriftingSnapshot DriftingFilter::snapshot() const {
  return {parts_->recursion.memory(), parts_->v, parts_->started, parts_->feed.memory()};
}

void DriftingFilter::restore(const DriftingSnapshot& snapshot) {
  check_snapshot(snapshot, parts_->recursion.memory());
  parts_->feed.restore(snapshot.samples);  // refuses before it changes anything, as the line above does
  parts_->recursion.restore(snapshot.coefficients);
  parts_->v = snapshot.v;
  parts_->started = snapshot.started;
}

}  // namespace modebank
