#include "filter/step/bank_filter.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>
#include <variant>

#include "filter/step/drifting.hpp"
#include "filter/step/imm_filter.hpp"
#include "ident/base/distributions.hpp"
#include "ident/base/seed.hpp"

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

const Bank& validated(const Bank& bank) {
  validate(bank);
  return bank;
}

/// Calls f(filter) with the equations of the bank, which have not started.
template <class F>
auto with_equations(const Bank& bank, const FilterOptions& options, F f) {
  if (!bank.running_noise.empty()) return f(DriftingFilter(bank));
  return with_sizes(bank.structure.dimension(), bank.C.rows(),
                    [&]<int N, int NY>() { return f(ImmFilter<N, NY>(bank, options)); });
}

/// Advances from the previous sample to the prediction of the next one, which is `steps` model steps later.
template <class Filter>
void advance(Filter& filter, const Vector& inputs, Index steps) {
  for (Index i = 1; i < steps; ++i) filter.step(inputs);
  filter.predict(inputs);
}

}  // namespace

void take_measured(const FilterEstimate& from, FilterEstimate& to) {
  each_part(from, to, [](const auto& all, auto& part) { part = all.topLeftCorner(part.rows(), part.cols()); });
  to.pit_width = from.pit_width;
  to.nis = from.nis;
  to.log_density = from.log_density;
  to.steps = from.steps;
}

BankFilter::BankFilter(const Bank& bank, const FilterOptions& options)
    : feed_(validated(bank)),
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
  feed_.push(time_s, input, measurement);
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
  advance(filter, feed_.inputs(), feed_.steps());
  filter.combine(estimate_.prediction, estimate_.innovation_covariance);
  estimate_.mode_probability_predicted = filter.predicted_probability();
  estimate_.steps = feed_.steps();
  estimate_.log_density = filter.update(measurement);
  if (std::isnan(estimate_.log_density)) {
    clear_scores();
  } else {
    small::multiply(predicted_, C_, estimate_.prediction);
    innovation_.observe(predicted_, measurement, estimate_);
    filter.transform(measurement, estimate_.pit, estimate_.pit_width, estimate_.log_density);
  }
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

std::vector<StateForecast> BankFilter::forecast(const Eigen::Ref<const Eigen::MatrixXd>& inputs, Index steps) const {
  const Index n = estimate_.state.size(), m = feed_.channels();
  if (steps < 1) throw std::invalid_argument("steps: a forecast needs at least 1 step, not " + std::to_string(steps));
  if (m > 0 && (inputs.rows() != m || inputs.cols() < steps - earliest_input_))
    throw std::invalid_argument("inputs: a forecast of " + std::to_string(steps) + " steps takes " + std::to_string(m) +
                                " inputs of " + std::to_string(std::max<Index>(steps - earliest_input_, 0)) +
                                " samples or more, not " + std::to_string(inputs.rows()) + " of " +
                                std::to_string(inputs.cols()));
  if (!inputs.allFinite()) throw std::invalid_argument("inputs: planned inputs must be finite");
  std::vector<StateForecast> result(static_cast<std::size_t>(steps),
                                    {Eigen::VectorXd::Constant(n, not_a_number),
                                     Eigen::MatrixXd::Constant(n, n, not_a_number), initial_probability_});
  if (!started_) return result;
  const Eigen::VectorXd none = Eigen::VectorXd::Constant(C_.rows(), not_a_number),
                        held = Eigen::VectorXd::Constant(m, not_a_number);
  SampleFeed feed = feed_;
  std::visit(
      [&](const auto& filter) {
        auto ahead = filter.forecast();
        for (Index i = 0; i < steps; ++i) {
          feed.push(not_a_number, m > 0 && i < inputs.cols() ? Eigen::VectorXd(inputs.col(i)) : held, none);
          ahead.step(feed.inputs());
          StateForecast& one = result[static_cast<std::size_t>(i)];
          ahead.merge(one.state, one.covariance);
          one.mode_probability = ahead.predicted_probability();
        }
      },
      equations_->filter);
  return result;
}

namespace {

constexpr double snapshot_format = 5.0;

/// Writes the parts of a state to a list of numbers, or reads them back. The sizes of a matrix precede its entries.
struct Numbers {
  std::vector<double>* written = nullptr;  ///< null: reads
  std::span<const double> left = {};

  template <class... Part>
  void exchange(std::tuple<Part&...> parts) {
    std::apply([&](auto&... part) { ((*this)(part), ...); }, parts);
  }
  void operator()(double& value) {
    if (written)
      written->push_back(value);
    else
      value = next();
  }
  void operator()(Index& value) {
    constexpr double most = 9007199254740992.0;  // 2^53
    auto number = static_cast<double>(value);
    (*this)(number);
    if (!(number >= 0.0 && number <= most && number == std::floor(number))) refuse();
    value = static_cast<Index>(number);
  }
  template <class Derived>
  void operator()(Eigen::PlainObjectBase<Derived>& matrix) {
    Index rows = matrix.rows(), cols = matrix.cols();
    (*this)(rows);
    (*this)(cols);
    if (rows != matrix.rows() || cols != matrix.cols()) refuse();
    for (double& value : matrix.reshaped()) (*this)(value);
  }
  template <class Part>
  void operator()(std::vector<Part>& parts) {
    for (Part& part : parts) (*this)(part);
  }
  template <int N>
  void operator()(Gaussian<N>& gaussian) {
    (*this)(gaussian.mean);
    (*this)(gaussian.covariance);
  }
  double next() {
    if (left.empty()) refuse();
    const double value = left.front();
    left = left.subspan(1);
    return value;
  }
  [[noreturn]] static void refuse() {
    throw std::invalid_argument("the snapshot is damaged, or that of a filter with other sizes");
  }
};

}  // namespace

std::vector<double> BankFilter::snapshot() const {
  std::vector<double> numbers{snapshot_format, started_ ? 1.0 : 0.0};
  Numbers write{&numbers};
  Equations equations = *equations_;
  SampleFeed feed = feed_;
  std::visit([&](auto& filter) { write.exchange(filter.parts()); }, equations.filter);
  write.exchange(feed.parts());
  return numbers;
}

void BankFilter::restore(std::span<const double> snapshot) {
  Numbers read{nullptr, snapshot};
  if (read.next() != snapshot_format)
    throw std::invalid_argument("the snapshot comes from another version of the library, or not from a filter");
  const double started = read.next();
  if (started != 0.0 && started != 1.0) Numbers::refuse();
  Equations equations = *equations_;
  SampleFeed feed = feed_;
  std::visit(
      [&](auto& filter) {
        read.exchange(filter.parts());
        filter.settle();
      },
      equations.filter);
  read.exchange(feed.parts());
  feed.settle();
  if (!read.left.empty()) Numbers::refuse();
  *equations_ = std::move(equations);
  feed_ = feed;
  started_ = started == 1.0;
}

Eigen::VectorXd log_densities(const Bank& bank, const Trajectory& run, const FilterOptions& options) {
  check_run(bank, run);
  Eigen::VectorXd result = Eigen::VectorXd::Constant(run.samples(), not_a_number);
  with_equations(bank, options, [&](auto filter) {
    for_each_sample(bank, run, [&](const SampleFeed& feed, Index k, bool starts) {
      if (starts) return filter.start(feed.start());
      advance(filter, feed.inputs(), feed.steps());
      result(k) = filter.update(run.state.col(k));
    });
  });
  return result;
}

std::uint64_t pit_seed(std::uint64_t seed, std::string_view run) {
  return derive_seed(seed, "pit of " + std::string(run));
}

void draw_pit(std::uint64_t of_run, Index sample, const Eigen::Ref<const Eigen::VectorXd>& width,
              Eigen::Ref<Eigen::VectorXd> pit) {
  std::mt19937_64 generator = make_generator(of_run, "pit", static_cast<std::uint64_t>(sample));
  for (Index i = 0; i < pit.size(); ++i) {
    const double draw = std::ldexp(static_cast<double>(generator() >> 11U), -53);
    if (width(i) > 0.0) pit(i) = std::clamp(pit(i) + (draw - 0.5) * width(i), 0.0, 1.0);
  }
}

void judge_live(const Eigen::MatrixXd& C, const FilterEstimate& estimate, LiveVerdict& verdict) {
  static const double interval_quantile = normal_quantile(0.975);  // normal quantile for 95 % intervals
  verdict.predicted.noalias() = C.lazyProduct(estimate.prediction);
  verdict.lower = verdict.upper = verdict.predicted;
  verdict.alarm = false;
  constexpr double alarm_tail = 0.0005;  // tail probability on each side; a correct model has one such sample in 1000
  for (Index i = 0; i < C.rows(); ++i) {
    const double half = interval_quantile * std::sqrt(estimate.innovation_covariance(i, i)), pit = estimate.pit(i);
    verdict.lower(i) -= half;
    verdict.upper(i) += half;
    if (pit < alarm_tail || pit > 1.0 - alarm_tail) verdict.alarm = true;  // false for NaN (a missing signal)
  }
}

}  // namespace modebank
