#include "app/report/page/paired_runs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "app/text/judged_runs.hpp"

namespace modebank::app::report {
namespace {

const FilterEvaluation* bank_of(const Archive& archive) {
  for (const FilterEvaluation& evaluation : archive.evaluations)
    if (evaluation.filter == "bank") return &evaluation;
  return nullptr;
}

Eigen::VectorXd log_density(const FilterEvaluation& evaluation, std::size_t run) {
  Eigen::VectorXd density;
  evaluation.with_run(run, {"log_density"}, [&](const RunEvaluation& said) { density = said.log_density; });
  return density;
}

bool same_samples(const Trajectory& a, const Trajectory& b) {
  return a.run == b.run && a.role == b.role && a.time_s == b.time_s && a.state == b.state;
}

/// Pairs of equal judged runs in two archives, as indices into each archive. Empty unless both archives have runs and a
/// scored bank.
std::vector<std::pair<std::size_t, std::size_t>> common_runs(const Archive& one, const Archive& other) {
  std::vector<std::pair<std::size_t, std::size_t>> common;
  if (!one.recording || !other.recording || !bank_of(one) || !bank_of(other)) return common;
  const auto &first = one.recording->runs, &second = other.recording->runs;
  for (std::size_t i = 0; i < first.size(); ++i) {
    if (first[i].role != judged_role(one)) continue;
    const auto found =
        std::find_if(second.begin(), second.end(), [&](const Trajectory& run) { return same_samples(first[i], run); });
    if (found != second.end()) common.emplace_back(i, static_cast<std::size_t>(found - second.begin()));
  }
  return common;
}

}  // namespace

ArchiveGain gain_between(const Archive& better, const Archive& other) {
  ArchiveGain result;
  result.gain.gain = result.gain.standard_error = result.gain.margin = std::numeric_limits<double>::quiet_NaN();
  if (!better.recording || !other.recording || !bank_of(better) || !bank_of(other)) {
    result.difference = "they were not both scored";
    return result;
  }
  std::vector<Eigen::VectorXd> of_better, of_other;
  for (const auto& [i, j] : common_runs(better, other)) {
    of_better.push_back(log_density(*bank_of(better), i));
    of_other.push_back(log_density(*bank_of(other), j));
  }
  result.runs = std::ssize(of_better);
  if (result.runs == 0)
    result.difference = "they have no judged run with the same samples in common";
  else
    result.gain = paired_gain("", of_better, of_other);
  return result;
}

std::string gain_words(const PairedGain& gain) {
  const std::string size = fmt::format(" by {:.3f}", std::abs(gain.gain));
  return std::isfinite(gain.standard_error) ? fmt::format("{} ± {:.3f} nats per sample", size, gain.standard_error)
                                            : size + " nats per sample";
}

}  // namespace modebank::app::report
