#include "filter/step/forecast.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>

#include "filter/step/equations/filter_memory.hpp"
#include "ident/base/not_a_number.hpp"

namespace modebank {

using Eigen::Index;

/// Interface of BankForecast that hides its sizes.
struct Forecaster::Sized {
  Sized() = default;
  Sized(const Sized&) = delete;
  Sized& operator=(const Sized&) = delete;
  virtual ~Sized() = default;
  virtual void start(const FilterMemory& origin) = 0;
  virtual void step(const Eigen::Ref<const Eigen::VectorXd>& inputs) = 0;
  virtual StateForecast predicted() const = 0;
};

template <int N, int NY>
struct Forecaster::OfSize final : Forecaster::Sized {
  FilterModel<N, NY> model;
  BankForecast<N, NY> forecast{model};
  FilterState<N> state{initial_state(model)};

  OfSize(const Bank& bank, const FilterOptions& options) : model(bank, options) {}

  void start(const FilterMemory& origin) override {
    restore(origin, model.exact, state);
    forecast.start(state);
  }
  void step(const Eigen::Ref<const Eigen::VectorXd>& inputs) override { forecast.step(inputs); }
  StateForecast predicted() const override {
    const Index n = model.structure.dimension();
    StateForecast result{Eigen::VectorXd(n), Eigen::MatrixXd(n, n), forecast.predicted().predicted_probability};
    forecast.moments(result.state, result.covariance);
    return result;
  }
};

/// DriftingForecast of a bank with running noise.
struct Forecaster::OfRunningNoise final : Forecaster::Sized {
  RunningNoise noise;
  DriftingForecast forecast;
  Index ahead = 0;

  explicit OfRunningNoise(const Bank& bank) : noise(bank.running_noise), forecast(bank) {}

  void start(const FilterMemory& origin) override {
    forecast.start(origin.means.col(0), origin.drift);
    ahead = 0;
  }
  void step(const Eigen::Ref<const Eigen::VectorXd>& inputs) override {
    forecast.step(inputs);
    ++ahead;
  }
  StateForecast predicted() const override {
    return {forecast.state(), noise.factor_at(ahead) * forecast.state_covariance(), Eigen::VectorXd::Ones(1)};
  }
};

std::unique_ptr<Forecaster::Sized> Forecaster::sized(const Bank& bank, const FilterOptions& options) {
  if (!bank.running_noise.empty()) return std::make_unique<OfRunningNoise>(bank);
  return with_sizes(bank.structure.dimension(), bank.C.rows(), [&]<int N, int NY>() -> std::unique_ptr<Sized> {
    return std::make_unique<OfSize<N, NY>>(bank, options);
  });
}

Forecaster::Forecaster(const Bank& bank, const FilterOptions& options)
    : sized_(sized(bank, options)),
      inputs_(bank.structure.inputs),
      earliest_input_(bank.structure.input_delay.earliest()),
      measurements_(bank.C.rows()),
      feed_(bank) {}

Forecaster::~Forecaster() = default;

std::vector<StateForecast> Forecaster::ahead(const FilterSnapshot& from,
                                             const Eigen::Ref<const Eigen::MatrixXd>& inputs, Index steps) {
  if (steps < 1) throw std::invalid_argument("steps: a forecast needs at least 1 step, not " + std::to_string(steps));
  if (inputs_ > 0 && (inputs.rows() != inputs_ || inputs.cols() < steps - earliest_input_))
    throw std::invalid_argument("inputs: a forecast of " + std::to_string(steps) + " steps takes " +
                                std::to_string(inputs_) + " inputs of " +
                                std::to_string(std::max<Index>(steps - earliest_input_, 0)) + " samples or more, not " +
                                std::to_string(inputs.rows()) + " of " + std::to_string(inputs.cols()));
  if (!inputs.allFinite()) throw std::invalid_argument("inputs: planned inputs must be finite");
  const Index n = from.means.rows();
  const Eigen::VectorXd nothing = Eigen::VectorXd::Constant(measurements_, not_a_number);
  const Eigen::VectorXd held = Eigen::VectorXd::Constant(inputs_, not_a_number);
  feed_.restore(from.samples);
  if (from.started) sized_->start(from);
  std::vector<StateForecast> result;
  for (Index i = 0; i < steps; ++i) {
    if (!from.started) {
      result.push_back({Eigen::VectorXd::Constant(n, not_a_number), Eigen::MatrixXd::Constant(n, n, not_a_number),
                        from.mode_probability});
      continue;
    }
    feed_.push(not_a_number, inputs_ > 0 && i < inputs.cols() ? Eigen::VectorXd(inputs.col(i)) : held, nothing);
    sized_->step(feed_.inputs());
    result.push_back(sized_->predicted());
  }
  return result;
}

}  // namespace modebank
