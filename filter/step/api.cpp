// The public API of this library: converts between plain vectors and Eigen.
#include <stdexcept>
#include <string>
#include <utility>

#include "filter/step/bank_filter.hpp"
#include "modebank/base/eigen.hpp"
#include "modebank/filter/bank_filter.hpp"

namespace modebank::filter {

namespace {

using Eigen::Index;

// A step's estimate allocates only on the first call, when sizes differ.
template <class Derived>
void assign(const Eigen::PlainObjectBase<Derived>& from, std::vector<double>& to) {
  to.assign(from.data(), from.data() + from.size());
}
template <class Derived>
void assign(const Eigen::PlainObjectBase<Derived>& from, Matrix& to) {
  to.rows = from.rows();
  to.cols = from.cols();
  assign(from, to.values);
}
void assign(const Matrix& from, Eigen::MatrixXd& to) { to = view(from); }
void assign(const std::vector<double>& from, Eigen::VectorXd& to) { to = view(from); }
template <class Part>
void assign(const Part& from, Part& to) {
  to = from;
}

/// Calls visit(part, same part of the bank) for the parts that a description and a bank have.
template <class Description, class Numbers, class Visit>
void each_part_of_bank(Description& d, Numbers& bank, Visit visit) {
  visit(d.C, bank.C);
  visit(d.R, bank.R);
  visit(d.quantum, bank.quantum);
  visit(d.state_dependent_transition.weights, bank.transition_logit.weights);
  visit(d.state_dependent_transition.reference, bank.transition_logit.reference);
  visit(d.initial_probability, bank.initial_probability);
  visit(d.state_names, bank.state_names);
  visit(d.input_names, bank.input_names);
  visit(d.dt_s, bank.dt_s);
  visit(d.inputs, bank.structure.inputs);
  visit(d.state_lags, bank.structure.state_lags);
  visit(d.input_lags, bank.structure.input_lags);
  visit(d.input_delay, bank.structure.input_delay);
  visit(d.intercept, bank.structure.intercept);
  visit(d.centre, bank.structure.centre);
  visit(d.drift.scale, bank.drift.scale);
  visit(d.drift.rate, bank.drift.rates.q);
  visit(d.drift.start, bank.drift.rates.p0);
  visit(d.drift.leak, bank.drift.rates.leak);
  visit(d.running_noise.floor, bank.running_noise.floor);
  visit(d.running_noise.forgetting, bank.running_noise.lam);
  visit(d.running_noise.degrees_of_freedom, bank.running_noise.nu);
  visit(d.running_noise.level, bank.running_noise.level);
  visit(d.running_noise.transition, bank.running_noise.switching);
}

/// Omitted fields have their defaults: no constant, no input effect, C = I, equally probable modes.
std::shared_ptr<const modebank::Bank> to_internal(const BankDescription& d) {
  if (d.modes.empty()) throw std::invalid_argument("a bank needs at least one mode");
  const Index n = d.modes.front().A.rows, K = std::ssize(d.modes);
  if (d.state_lags < 1 || n % d.state_lags != 0)
    throw std::invalid_argument("A has " + std::to_string(n) + " rows, not a multiple of " +
                                std::to_string(d.state_lags) + " state lags");
  if (d.running_noise.horizon.size() != d.running_noise.factor.size())
    throw std::invalid_argument("running noise needs one factor per horizon");
  modebank::Bank bank;
  each_part_of_bank(d, bank, [](const auto& from, auto& to) { assign(from, to); });
  bank.structure.states = n / d.state_lags;
  for (const Mode& mode : d.modes) {
    modebank::Mode& to = bank.modes.emplace_back();
    to.model = {view(mode.A), view(mode.B), view(mode.c)};
    if (mode.B.values.empty()) to.model.B.setZero(n, bank.structure.acting_inputs());
    if (mode.c.empty()) to.model.c.setZero(n);
    to.Q = view(mode.Q);
    to.parameter_covariance = view(mode.parameter_covariance);
    to.weight = mode.weight;
  }
  if (d.C.values.empty()) bank.C.setIdentity(bank.structure.states, n);
  if (d.initial_probability.empty()) bank.initial_probability.setConstant(K, 1.0 / static_cast<double>(K));
  bank.transition = TransitionMatrix(view(d.transition));
  for (std::size_t i = 0; i < d.running_noise.horizon.size(); ++i)
    bank.running_noise.horizon_factor.emplace_back(static_cast<Index>(d.running_noise.horizon[i]),
                                                   d.running_noise.factor[i]);
  return std::make_shared<const modebank::Bank>(validate(bank));
}

}  // namespace

Bank::Bank(const BankDescription& description) : bank_(to_internal(description)) {}
Bank::Bank(std::shared_ptr<const modebank::Bank> bank) : bank_(std::move(bank)) {}

std::ptrdiff_t Bank::modes() const { return bank_->mode_count(); }
std::ptrdiff_t Bank::states() const { return bank_->structure.dimension(); }
std::ptrdiff_t Bank::measurements() const { return bank_->C.rows(); }
std::ptrdiff_t Bank::inputs() const { return bank_->structure.inputs; }
double Bank::dt_s() const { return bank_->dt_s; }

BankDescription Bank::description() const {
  BankDescription d;
  each_part_of_bank(d, *bank_, [](auto& to, const auto& from) { assign(from, to); });
  for (const modebank::Mode& mode : bank_->modes)
    d.modes.push_back({to_matrix(mode.model.A), to_matrix(mode.model.B), to_vector(mode.model.c), to_matrix(mode.Q),
                       to_matrix(mode.parameter_covariance), mode.weight});
  d.transition = to_matrix(bank_->transition.matrix());
  for (const auto& [horizon, factor] : bank_->running_noise.horizon_factor) {
    d.running_noise.horizon.push_back(static_cast<double>(horizon));
    d.running_noise.factor.push_back(factor);
  }
  return d;
}

struct BankFilter::Internal {
  modebank::BankFilter filter;
  Index inputs, measurements;
  Estimate estimate = {};
  std::uint64_t seed = pit_seed(1, "");
  Index samples = 0;  ///< number of samples processed so far

  void take_estimate() {
    const FilterEstimate& from = filter.estimate();
    each_part(from, estimate, [](const auto& part, auto& to) { assign(part, to); });
    estimate.nis = from.nis;
    estimate.log_density = from.log_density;
    estimate.steps = from.steps;
  }
};

BankFilter::BankFilter(const Bank& bank, const FilterOptions& options)
    : internal_(new Internal{{bank.internal(), options}, bank.inputs(), bank.measurements()}) {
  internal_->take_estimate();
}
BankFilter::~BankFilter() = default;
BankFilter::BankFilter(BankFilter&&) noexcept = default;
BankFilter& BankFilter::operator=(BankFilter&&) noexcept = default;

void BankFilter::check_sizes(std::ptrdiff_t inputs, std::ptrdiff_t measurements) const {
  if (inputs != internal_->inputs || measurements != internal_->measurements)
    throw std::invalid_argument("a step takes " + std::to_string(internal_->inputs) + " inputs and " +
                                std::to_string(internal_->measurements) + " measurements, not " +
                                std::to_string(inputs) + " and " + std::to_string(measurements));
}

const Estimate& BankFilter::step(double time_s, const double* input, const double* measurement) {
  using Numbers = Eigen::Map<const Eigen::VectorXd>;
  const auto& [filter, inputs, measurements, estimate, seed, samples] = *internal_;
  const FilterEstimate& said =
      internal_->filter.step(time_s, Numbers(input, inputs), Numbers(measurement, measurements));
  internal_->take_estimate();
  if ((said.pit_width.array() > 0.0).any())
    draw_pit(seed, samples, said.pit_width, Eigen::Map<Eigen::VectorXd>(internal_->estimate.pit.data(), measurements));
  ++internal_->samples;
  return estimate;
}

const Estimate& BankFilter::estimate() const { return internal_->estimate; }

std::vector<Forecast> BankFilter::forecast(const Matrix& inputs, std::ptrdiff_t steps) const {
  return internal_->filter.forecast(view(inputs), steps);
}

std::vector<double> BankFilter::snapshot() const {
  std::vector<double> numbers = internal_->filter.snapshot();
  numbers.push_back(static_cast<double>(internal_->samples));  // the draws for the transforms depend on this number
  return numbers;
}

void BankFilter::restore(const std::vector<double>& snapshot) {
  constexpr double most_samples = 9007199254740992.0;  // 2^53
  if (snapshot.empty() || !(snapshot.back() >= 0.0 && snapshot.back() <= most_samples))
    throw std::invalid_argument("the snapshot is damaged: its last value is not a number of samples");
  internal_->filter.restore({snapshot.data(), snapshot.size() - 1});
  internal_->samples = static_cast<Index>(snapshot.back());
}

void BankFilter::restart() { internal_->filter.restart(); }
bool BankFilter::started() const { return internal_->filter.started(); }

}  // namespace modebank::filter
