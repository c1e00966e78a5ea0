#include "app/report/page/paired_runs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "app/chain/judged_runs.hpp"

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

/// The judged runs of one that the other holds, too, with what both banks said of them.
struct CommonRuns {
  std::vector<Eigen::VectorXd> better, other;
};

CommonRuns common_runs(const Archive& better, const Archive& other) {
  CommonRuns common;
  const auto &first = better.recording->runs, &second = other.recording->runs;
  for (std::size_t i = 0; i < first.size(); ++i) {
    if (first[i].role != judged_role(better)) continue;
    const auto found =
        std::find_if(second.begin(), second.end(), [&](const Trajectory& run) { return same_samples(first[i], run); });
    if (found == second.end()) continue;
    common.better.push_back(log_density(*bank_of(better), i));
    common.other.push_back(log_density(*bank_of(other), static_cast<std::size_t>(found - second.begin())));
  }
  return common;
}

}  // namespace

ArchiveGain gain_between(const Archive& better, const Archive& other) {
  ArchiveGain result;
  result.gain.gain = result.gain.standard_error = result.gain.margin = std::numeric_limits<double>::quiet_NaN();
  if (!better.recording || !other.recording || !bank_of(better) || !bank_of(other)) {
    result.difference = "not both were scored";
    return result;
  }
  const CommonRuns common = common_runs(better, other);
  result.runs = std::ssize(common.better);
  if (result.runs == 0)
    result.difference = "no judged run is in both with the same samples";
  else
    result.gain = paired_gain("", common.better, common.other);
  return result;
}

std::string gain_words(const PairedGain& gain) {
  const std::string size = fmt::format(" by {:.3f}", std::abs(gain.gain));
  return std::isfinite(gain.standard_error) ? fmt::format("{} ± {:.3f} nats per sample", size, gain.standard_error)
                                            : size + " nats per sample";
}

}  // namespace modebank::app::report
