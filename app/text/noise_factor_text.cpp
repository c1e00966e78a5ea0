#include "app/text/noise_factor_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "app/text/terminal.hpp"
#include "ident/base/sample_quantile.hpp"
#include "ident/model/parameter_labels.hpp"
#include "ident/model/transitions.hpp"

namespace modebank::app {
namespace {

/// A signal on which the noise factor depends, in words: "u", "change of u", or "the inputs' share in a forecast".
std::string noise_feature(const Bank& bank, Index direction) {
  const std::vector<std::string> labels = regressor_labels(bank.structure, bank.state_names, bank.input_names);
  const auto row = bank.noise_factor.directions.row(direction);
  std::vector<std::size_t> used;
  for (Index i = 0; i < row.size(); ++i)
    if (row(i) != 0.0) used.push_back(static_cast<std::size_t>(i));
  if (used.size() == 1) return labels[used.front()];
  const bool change = used.size() == 2 && row(static_cast<Index>(used[0])) == -row(static_cast<Index>(used[1]));
  return change ? "change of " + labels[used.front()] : "the inputs' share in a forecast";
}

}  // namespace

std::string noise_factor_text(const Archive& archive, int width) {
  const Bank& bank = *archive.bank;
  const NoiseFactor& factor = bank.noise_factor;
  if (factor.empty()) return "";
  Index most = 0;
  factor.weights.cwiseAbs().maxCoeff(&most);
  double least = 1.0 / NoiseFactor::largest, largest = NoiseFactor::largest;
  std::vector<double> factors;
  if (archive.recording) {
    const Eigen::MatrixXd phi = stack_training(*archive.recording, bank.structure).regressors;
    const Index n = bank.structure.dimension(), m = bank.structure.acting_inputs();
    for (Index k = 0; k < phi.rows(); ++k) factors.push_back(factor.at(phi.row(k).head(n), phi.row(k).segment(n, m)));
    std::sort(factors.begin(), factors.end());
  }
  if (!factors.empty()) {
    least = sample_quantile(factors, 0.05);
    largest = sample_quantile(factors, 0.95);
  }
  return wrapped(fmt::format("noise: every Q is multiplied by {:.2g} to {:.2g}; this factor depends on states and "
                             "inputs, and {} most with the size of {}\n",
                             least, largest, factor.weights(most) > 0.0 ? "grows" : "falls", noise_feature(bank, most)),
                 width);
}

}  // namespace modebank::app
