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

modebank::Mode to_internal(const Mode& mode, Index n, Index m) {
  modebank::Mode result;
  result.model = {view(mode.A), view(mode.B), view(mode.c)};
  result.Q = view(mode.Q);
  result.parameter_covariance = view(mode.parameter_covariance);
  result.weight = mode.weight;
  // Omitted fields mean zero: no constant, no input effect.
  if (result.model.c.size() == 0) result.model.c.setZero(n);
  if (result.model.B.size() == 0) result.model.B.setZero(n, m);
  return result;
}

LinearStructure structure_of(const BankDescription& d) {
  if (d.modes.empty()) throw std::invalid_argument("a bank needs at least one mode");
  if (d.state_lags < 1 || d.modes.front().A.rows % d.state_lags != 0)
    throw std::invalid_argument("A has " + std::to_string(d.modes.front().A.rows) + " rows, not a multiple of " +
                                std::to_string(d.state_lags) + " state lags");
  return {d.modes.front().A.rows / d.state_lags,
          d.inputs,
          d.intercept,
          d.state_lags,
          d.input_lags,
          d.input_delay,
          d.centre};
}

modebank::RunningNoise to_internal(const RunningNoise& noise) {
  modebank::RunningNoise result{noise.forgetting, noise.degrees_of_freedom, view(noise.floor)};
  if (noise.horizon.size() != noise.factor.size())
    throw std::invalid_argument("running noise needs one factor per horizon");
  for (std::size_t i = 0; i < noise.horizon.size(); ++i)
    result.horizon_factor.emplace_back(static_cast<Index>(noise.horizon[i]), noise.factor[i]);
  result.level = view(noise.level);
  result.switching = view(noise.transition);
  return result;
}
RunningNoise from_internal(const modebank::RunningNoise& noise) {
  RunningNoise result;
  result.floor = to_vector(noise.floor);
  result.forgetting = noise.lam;
  result.degrees_of_freedom = noise.nu;
  for (const auto& [horizon, factor] : noise.horizon_factor) {
    result.horizon.push_back(static_cast<double>(horizon));
    result.factor.push_back(factor);
  }
  result.level = to_matrix(noise.level);
  result.transition = to_matrix(noise.switching);
  return result;
}

std::shared_ptr<const modebank::Bank> to_internal(const BankDescription& d) {
  modebank::Bank bank;
  bank.structure = structure_of(d);
  const Index n = bank.structure.dimension(), K = static_cast<Index>(d.modes.size());
  for (const Mode& mode : d.modes) bank.modes.push_back(to_internal(mode, n, bank.structure.acting_inputs()));
  bank.C = d.C.values.empty() ? Eigen::MatrixXd::Identity(bank.structure.states, n) : Eigen::MatrixXd(view(d.C));
  bank.R = view(d.R);
  bank.quantum = view(d.quantum);
  bank.transition = TransitionMatrix(view(d.transition));
  if (const StateDependentTransition& t = d.state_dependent_transition; !t.weights.values.empty())
    bank.transition_logit = {view(t.weights), view(t.reference)};
  bank.initial_probability = d.initial_probability.empty() ? Eigen::VectorXd::Constant(K, 1.0 / static_cast<double>(K))
                                                           : Eigen::VectorXd(view(d.initial_probability));
  bank.state_names = d.state_names;
  bank.input_names = d.input_names;
  bank.dt_s = d.dt_s;
  if (const NoiseByState& noise = d.noise_by_state; !noise.weights.empty())
    bank.noise_factor = {view(noise.directions), view(noise.weights), noise.offset};
  bank.drift = {{d.drift.rate, d.drift.start, d.drift.leak}, view(d.drift.scale), d.drift.wandering};
  bank.running_noise = to_internal(d.running_noise);
  validate(bank);
  return std::make_shared<const modebank::Bank>(std::move(bank));
}

/// Copies; allocates only on the first call, when sizes differ.
template <class Source>
void assign(const Source& source, std::vector<double>& target) {
  target.assign(source.data(), source.data() + source.size());
}
template <class Source>
void assign(const Source& source, Matrix& target) {
  target.rows = source.rows();
  target.cols = source.cols();
  assign(source, target.values);
}

void assign(const FilterEstimate& source, Estimate& target) {
  each_part(source, target, [](const auto& from, auto& to) { assign(from, to); });
  target.nis = source.nis;
  target.log_density = source.log_density;
  target.steps = source.steps;
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
  for (const modebank::Mode& mode : bank_->modes)
    d.modes.push_back({to_matrix(mode.model.A), to_matrix(mode.model.B), to_vector(mode.model.c), to_matrix(mode.Q),
                       to_matrix(mode.parameter_covariance), mode.weight});
  d.C = to_matrix(bank_->C);
  d.R = to_matrix(bank_->R);
  d.quantum = to_vector(bank_->quantum);
  d.transition = to_matrix(bank_->transition.matrix());
  d.state_dependent_transition = {to_matrix(bank_->transition_logit.weights),
                                  to_vector(bank_->transition_logit.reference)};
  d.initial_probability = to_vector(bank_->initial_probability);
  d.state_names = bank_->state_names;
  d.input_names = bank_->input_names;
  d.dt_s = bank_->dt_s;
  d.inputs = bank_->structure.inputs;
  d.state_lags = bank_->structure.state_lags;
  d.input_lags = bank_->structure.input_lags;
  d.input_delay = bank_->structure.input_delay;
  d.intercept = bank_->structure.intercept;
  d.centre = bank_->structure.centre;
  d.noise_by_state = {to_matrix(bank_->noise_factor.directions), to_vector(bank_->noise_factor.weights),
                      bank_->noise_factor.offset};
  d.drift = {to_vector(bank_->drift.scale), bank_->drift.rates.q, bank_->drift.rates.p0, bank_->drift.rates.leak,
             bank_->drift.wandering};
  d.running_noise = from_internal(bank_->running_noise);
  return d;
}

struct BankFilter::Internal {
  modebank::BankFilter filter;
  Index inputs, measurements;
  Estimate estimate = {};
  std::uint64_t seed = pit_seed(1, "");
  Index samples = 0;  ///< number of samples processed so far

  Internal(const Bank& bank, const FilterOptions& options)
      : filter(bank.internal(), options), inputs(bank.inputs()), measurements(bank.measurements()) {
    assign(filter.estimate(), estimate);
  }
};

BankFilter::BankFilter(const Bank& bank, const FilterOptions& options)
    : internal_(std::make_unique<Internal>(bank, options)) {}
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
  const FilterEstimate& said =
      internal_->filter.step(time_s, Numbers(input, internal_->inputs), Numbers(measurement, internal_->measurements));
  assign(said, internal_->estimate);
  if ((said.pit_width.array() > 0.0).any())
    draw_pit(internal_->seed, internal_->samples, said.pit_width,
             Eigen::Map<Eigen::VectorXd>(internal_->estimate.pit.data(), internal_->measurements));
  ++internal_->samples;
  return internal_->estimate;
}

const Estimate& BankFilter::estimate() const { return internal_->estimate; }

std::vector<Forecast> BankFilter::forecast(const Matrix& inputs, std::ptrdiff_t steps) const {
  std::vector<Forecast> result;
  for (const StateForecast& ahead : internal_->filter.forecast(view(inputs), steps))
    result.push_back({to_vector(ahead.state), to_matrix(ahead.covariance), to_vector(ahead.mode_probability)});
  return result;
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
