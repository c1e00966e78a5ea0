#include "ident/simulate/input_law.hpp"

#include <algorithm>
#include <boost/random/geometric_distribution.hpp>
#include <boost/random/uniform_01.hpp>
#include <boost/random/uniform_real_distribution.hpp>

namespace modebank {

namespace {

/// Share of driving commands that ramp to their target instead of jumping. Standstill and equal inputs do not count.
constexpr double ramp_share = 0.5;

Eigen::VectorXd draw_levels(const CommandOptions& options, std::mt19937_64& generator) {
  boost::random::uniform_real_distribution<double> level(-options.input_amplitude, options.input_amplitude);
  Eigen::VectorXd levels(options.inputs);
  for (double& value : levels) value = level(generator);
  return levels;
}

/// Draws new levels for all inputs every `hold` samples.
Eigen::MatrixXd held_inputs(const CommandOptions& options, Index hold, std::mt19937_64& generator) {
  Eigen::MatrixXd inputs(options.inputs, options.samples);
  for (Index k = 0; k < options.samples; k += hold)
    inputs.middleCols(k, std::min(hold, options.samples - k)).colwise() = draw_levels(options, generator);
  return inputs;
}

/// A length from a geometric distribution with the given mean, at least one sample.
Index draw_length(Index mean, std::mt19937_64& generator) {
  if (mean <= 1) return 1;
  boost::random::geometric_distribution<Index> further(1.0 / static_cast<double>(mean));
  return 1 + further(generator);
}

struct Command {
  Eigen::VectorXd target;
  bool ramp = false;
};

Command draw_command(const CommandOptions& options, std::mt19937_64& generator) {
  boost::random::uniform_01<double> uniform;
  const double kind = uniform(generator);
  if (kind < options.standstill_fraction) return {Eigen::VectorXd::Zero(options.inputs), false};
  Command command{draw_levels(options, generator), uniform(generator) < ramp_share};
  if (kind < options.standstill_fraction + options.equal_fraction) {
    command.target.setConstant(command.target.size() > 0 ? command.target(0) : 0.0);
    command.ramp = false;  // no ramp, because during a ramp from unequal wheels the wheels would stay unequal
  }
  return command;
}

Eigen::MatrixXd driven_inputs(const CommandOptions& options, std::mt19937_64& generator) {
  Eigen::MatrixXd inputs(options.inputs, options.samples);
  Eigen::VectorXd current = Eigen::VectorXd::Zero(options.inputs);
  for (Index k = 0; k < options.samples;) {
    const Index length = draw_length(options.hold_samples, generator);
    const Command command = draw_command(options, generator);
    for (Index i = 0; i < length && k < options.samples; ++i, ++k) {
      const double share = command.ramp ? static_cast<double>(i + 1) / static_cast<double>(length) : 1.0;
      inputs.col(k) = current + share * (command.target - current);
    }
    current = command.target;
  }
  return inputs;
}

Eigen::MatrixXd draw_exact(const CommandOptions& options, std::mt19937_64& generator) {
  switch (options.input_law) {
    case InputLaw::white:
      return held_inputs(options, 1, generator);
    case InputLaw::hold:
      return held_inputs(options, options.hold_samples, generator);
    case InputLaw::drive:
      break;
  }
  return driven_inputs(options, generator);
}

}  // namespace

Eigen::MatrixXd draw_inputs(const CommandOptions& options, std::mt19937_64& generator) {
  Eigen::MatrixXd inputs = draw_exact(options, generator);
  if (options.input_quantum > 0.0) inputs = (inputs / options.input_quantum).array().round() * options.input_quantum;
  return inputs;
}

}  // namespace modebank
