#include "filter/step/bank_filter.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>
#include <variant>

#include "filter/step/drifting.hpp"
#include "filter/step/imm.hpp"
#include "ident/base/distributions.hpp"
#include "ident/base/not_a_number.hpp"
#include "ident/base/seed.hpp"
#include "modebank/base/eigen.hpp"

namespace modebank {

using Eigen::Index;
using Vector = Eigen::Ref<const Eigen::VectorXd>;

/// The equations of a bank, by its sizes (with_sizes) and kind.
struct BankFilter::Equations {
  std::variant<ImmFilter<1, 1>, ImmFilter<2, 1>, ImmFilter<2, 2>, ImmFilter<3, 1>, ImmFilter<3, 3>,
               ImmFilter<Eigen::Dynamic, Eigen::Dynamic>, DriftingFilter>
      filter;
};

namespace {

constexpr double snapshot_format = 6.0;

/// Calls f(filter) with the equations of the bank, which have not started.
template <class F>
auto with_equations(const Bank& bank, const FilterOptions& options, F f) {
  if (!bank.running_noise.empty()) return f(DriftingFilter(bank));
  return with_sizes(bank.structure.dimension(), bank.C.rows(),
                    [&]<int N, int NY>() { return f(ImmFilter<N, NY>(bank, options)); });
}

}  // namespace

void take_measured(const FilterEstimate& from, FilterEstimate& to) {
  each_part(from, to, [](const auto& all, auto& part) { part = all.topLeftCorner(part.rows(), part.cols()); });
  to.pit_width = from.pit_width;
  to.nis = from.nis;
  to.log_density = from.log_density;
  to.steps = from.steps;
}

void CombinedInnovation::observe(const Eigen::VectorXd& predicted, const Vector& y, FilterEstimate& estimate) {
  constexpr double largest_nis = 1e300;
  covariance_ = estimate.innovation_covariance;
  residual_ = estimate.innovation = y - predicted;
  for (Index i = 0; i < y.size(); ++i)
    if (is_missing(y(i))) {
      detach(covariance_, i);
      residual_(i) = 0.0;
      estimate.innovation(i) = not_a_number;
    }
  cholesky_.factorise(covariance_);
  cholesky_.decorrelate(residual_);
  estimate.nis = cholesky_.squared_distance(residual_);
  if (!(estimate.nis < largest_nis)) estimate.nis = largest_nis;
  if (missing_entries(y) == y.size()) estimate.nis = not_a_number;
}

BankFilter::BankFilter(const Bank& bank, const FilterOptions& options)
    : feed_(validate(bank)),
      earliest_input_(bank.structure.input_delay.earliest()),
      C_(bank.C),
      initial_probability_(bank.initial_probability),
      equations_(with_equations(bank, options,
                                [](auto filter) { return std::make_unique<Equations>(Equations{std::move(filter)}); })),
      predicted_(C_.rows()),
      innovation_(C_.rows()) {
  wait();
}

BankFilter::~BankFilter() = default;
BankFilter::BankFilter(BankFilter&&) noexcept = default;
BankFilter& BankFilter::operator=(BankFilter&&) noexcept = default;

const FilterEstimate& BankFilter::step(double time_s, const Vector& input, const Vector& measurement) {
  feed_.push(time_s, input.data(), measurement.data());
  if (feed_.steps() > longest_gap_steps) started_ = false;
  if (!started_ && !feed_.can_start()) {
    wait();
    return estimate_;
  }
  std::visit(
      [&](auto& filter) {
        if (started_) {
          take(filter, measurement);
        } else {
          clear_prediction();
          filter.start(feed_.start());
          estimate_.mode_probability_predicted = filter.mode_probability();
        }
        filter.merge(estimate_.state, estimate_.covariance);
        estimate_.mode_probability = filter.mode_probability();
      },
      equations_->filter);
  started_ = true;
  return estimate_;
}

void BankFilter::restart() {
  started_ = false;
  feed_.clear();
}

template <class Filter>
void BankFilter::take(Filter& filter, const Vector& measurement) {
  for (Index i = 1; i < feed_.steps(); ++i) filter.step(feed_.inputs());
  filter.predict(feed_.inputs());
  filter.combine(estimate_.prediction, estimate_.innovation_covariance);
  estimate_.mode_probability_predicted = filter.predicted_probability();
  estimate_.steps = feed_.steps();
  estimate_.log_density = filter.update(measurement);
  if (std::isnan(estimate_.log_density)) return clear_scores();
  small::multiply(predicted_, C_, estimate_.prediction);
  innovation_.observe(predicted_, measurement, estimate_);
  filter.transform(measurement, estimate_.pit, estimate_.pit_width, estimate_.log_density);
}

/// No prediction was made for this sample.
void BankFilter::clear_prediction() {
  estimate_.prediction.setConstant(C_.cols(), not_a_number);
  estimate_.innovation_covariance.setConstant(C_.rows(), C_.rows(), not_a_number);
  estimate_.steps = 0;
  clear_scores();
}

void BankFilter::clear_scores() {
  estimate_.innovation.setConstant(C_.rows(), not_a_number);
  estimate_.pit.setConstant(C_.rows(), not_a_number);
  estimate_.pit_width.setZero(C_.rows());
  estimate_.nis = estimate_.log_density = not_a_number;
}

/// Clears all values before a start.
void BankFilter::wait() {
  clear_prediction();
  estimate_.state.setConstant(C_.cols(), not_a_number);
  estimate_.covariance.setConstant(C_.cols(), C_.cols(), not_a_number);
  estimate_.mode_probability = estimate_.mode_probability_predicted = initial_probability_;
}

std::vector<filter::Forecast> BankFilter::forecast(const Eigen::Ref<const Eigen::MatrixXd>& inputs, Index steps) const {
  const Index n = C_.cols(), m = feed_.channels(), needed = std::max<Index>(steps - earliest_input_, 0);
  if (steps < 1) throw std::invalid_argument("steps: a forecast needs at least 1 step, not " + std::to_string(steps));
  if (m > 0 && (inputs.rows() != m || inputs.cols() < needed))
    throw std::invalid_argument("inputs: a forecast of " + std::to_string(steps) + " steps takes " + std::to_string(m) +
                                " inputs of " + std::to_string(needed) + " samples or more, not " +
                                std::to_string(inputs.rows()) + " of " + std::to_string(inputs.cols()));
  if (!inputs.allFinite()) throw std::invalid_argument("inputs: planned inputs must be finite");
  std::vector<filter::Forecast> result(
      steps, {std::vector<double>(n, not_a_number), Matrix(n, n, not_a_number), to_vector(initial_probability_)});
  if (!started_) return result;
  const std::vector<double> none(C_.rows(), not_a_number), held(m, not_a_number);
  SampleFeed feed = feed_;
  std::visit(
      [&](const auto& filter) {
        auto ahead = filter.forecast();
        Eigen::VectorXd state;
        Eigen::MatrixXd covariance;
        for (Index i = 0; i < steps; ++i) {
          const bool given = m > 0 && i < inputs.cols();
          feed.push(not_a_number, given ? inputs.col(i).data() : held.data(), none.data());
          ahead.step(feed.inputs());
          ahead.merge(state, covariance);
          result[i] = {to_vector(state), to_matrix(covariance), to_vector(ahead.predicted_probability())};
        }
      },
      equations_->filter);
  return result;
}

/// The numbers of the state follow the format and `started`, each part after its size.
std::vector<double> BankFilter::snapshot() const {
  std::vector<double> numbers{snapshot_format, started_ ? 1.0 : 0.0};
  const auto write = [&](const std::vector<SnapshotPart>& parts) {
    for (const SnapshotPart& part : parts) {
      numbers.push_back(static_cast<double>(part.size()));
      numbers.insert(numbers.end(), part.begin(), part.end());
    }
  };
  Equations equations = *equations_;  // parts can be written to, so these are those of copies
  SampleFeed feed = feed_;
  std::visit([&](auto& filter) { write(filter.parts()); }, equations.filter);
  write(feed.parts());
  return numbers;
}

void BankFilter::restore(std::span<const double> left) {
  const auto require = [](bool fits) {
    if (!fits) throw std::invalid_argument("the snapshot is damaged, or that of a filter with other sizes");
  };
  const auto read = [&](std::vector<SnapshotPart> parts) {
    for (SnapshotPart& part : parts) {
      require(std::ssize(left) > part.size() && left[0] == static_cast<double>(part.size()));
      part = Eigen::Map<const Eigen::VectorXd>(left.data() + 1, part.size());
      left = left.subspan(part.size() + 1);
    }
  };
  require(left.size() > 2 && (left[1] == 0.0 || left[1] == 1.0));
  if (left[0] != snapshot_format)
    throw std::invalid_argument("the snapshot comes from another version of the library, or not from a filter");
  const bool started = left[1] == 1.0;
  left = left.subspan(2);
  Equations equations = *equations_;
  SampleFeed feed = feed_;
  std::visit(
      [&](auto& filter) {
        read(filter.parts());
        filter.settle();
      },
      equations.filter);
  read(feed.parts());
  feed.settle();
  require(left.empty());
  *equations_ = std::move(equations);
  feed_ = feed;
  started_ = started;
}

Eigen::VectorXd log_densities(const Bank& bank, const Trajectory& run, const FilterOptions& options) {
  check_run(bank, run);
  Eigen::VectorXd result = Eigen::VectorXd::Constant(run.samples(), not_a_number);
  const RunInstants moments(bank, run);
  with_equations(bank, options, [&](auto filter) {
    for (Index t = 0; t < moments.count(); ++t) {
      const double log_density = follow(moments, t, run, filter);
      if (const Index k = moments.instants[t].sample; k >= 0) result(k) = log_density;
    }
  });
  return result;
}

std::uint64_t pit_seed(std::uint64_t seed, std::string_view run) {
  return derive_seed(seed, "pit of " + std::string(run));
}

void draw_pit(std::uint64_t of_run, Index sample, const Vector& width, Eigen::Ref<Eigen::VectorXd> pit) {
  std::mt19937_64 generator = make_generator(of_run, "pit", static_cast<std::uint64_t>(sample));
  for (Index i = 0; i < pit.size(); ++i) {
    const double draw = std::ldexp(static_cast<double>(generator() >> 11U), -53);
    if (width(i) > 0.0) pit(i) = std::clamp(pit(i) + (draw - 0.5) * width(i), 0.0, 1.0);
  }
}

void judge_live(const Eigen::MatrixXd& C, const FilterEstimate& estimate, LiveVerdict& verdict) {
  static const double interval_quantile = normal_quantile(0.975);  // normal quantile for 95 % intervals
  constexpr double alarm_tail = 0.0005;  // tail probability on each side; a correct model has one such sample in 1000
  verdict.predicted.noalias() = C.lazyProduct(estimate.prediction);
  verdict.upper = interval_quantile * estimate.innovation_covariance.diagonal().cwiseSqrt();
  verdict.lower = verdict.predicted - verdict.upper;
  verdict.upper += verdict.predicted;
  verdict.alarm = ((estimate.pit.array() - 0.5).abs() > 0.5 - alarm_tail).any();  // false for NaN (a missing signal)
}

}  // namespace modebank
