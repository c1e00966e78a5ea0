#include <algorithm>
#include <cmath>

#include "app/chain/finding_text.hpp"
#include "app/chain/judged_runs.hpp"
#include "app/chain/stages.hpp"
#include "ident/check/stream_check.hpp"

namespace modebank {
namespace {

std::vector<const Trajectory*> runs_of(const Recording& recording, Role role) {
  std::vector<const Trajectory*> runs;
  for (const Trajectory& run : recording.runs)
    if (run.role == role) runs.push_back(&run);
  return runs;
}

Densities densities_of(const FilterEvaluation& evaluation, const Recording& recording, Role role) {
  Densities densities{evaluation.filter, {}};
  for (std::size_t i = 0; i < recording.runs.size(); ++i)
    if (recording.runs[i].role == role) densities.of_runs.push_back(evaluation.runs[i].log_density);
  return densities;
}

/// Median standard deviation of the predictions of measurement i.
double innovation_sd(const FilterEvaluation& bank, const Recording& recording, Role role, Index i) {
  std::vector<double> variances;
  for (std::size_t r = 0; r < recording.runs.size(); ++r) {
    const RunEvaluation& run = bank.runs[r];
    const Index n_y = run.innovation.rows();
    for (Index k = 0; k < run.log_density.size() && recording.runs[r].role == role; ++k)
      if (!std::isnan(run.log_density(k))) variances.push_back(run.innovation_covariance(i * n_y + i, k));
  }
  if (variances.empty()) return 0.0;
  const auto middle = variances.begin() + std::ssize(variances) / 2;
  std::nth_element(variances.begin(), middle, variances.end());
  return std::sqrt(*middle);
}

/// Over the judged runs, one after another. `quantum`: of the bank; where it has one its scores know of the rounding.
std::vector<Resolution> resolutions(const FilterEvaluation& bank, const Eigen::VectorXd& quantum,
                                    const Recording& recording, Role role) {
  const std::vector<const Trajectory*> runs = runs_of(recording, role);
  Index samples = 0;
  for (const Trajectory* run : runs) samples += run->samples();
  std::vector<Resolution> states;
  for (Index i = 0; i < recording.state_count(); ++i) {
    Eigen::VectorXd values(samples);
    Index at = 0;
    for (const Trajectory* run : runs) {
      values.segment(at, run->samples()) = run->state.row(i).transpose();
      at += run->samples();
    }
    const bool known = i < quantum.size() && quantum(i) > 0.0;
    const ChannelCheck check = known ? ChannelCheck() : check_channel(values);
    states.push_back({recording.states[static_cast<std::size_t>(i)].name, check.quantum, check.repeated,
                      innovation_sd(bank, recording, role, i)});
  }
  return states;
}

}  // namespace

std::optional<Finding> find_modes(const Archive& archive) {
  const FilterEvaluation* bank = nullptr;
  std::vector<Densities> competitors;
  const Role role = judged_role(archive);
  for (const FilterEvaluation& evaluation : archive.evaluations) {
    if (evaluation.filter == "bank")
      bank = &evaluation;
    else
      competitors.push_back(densities_of(evaluation, *archive.recording, role));
  }
  if (!bank || !archive.bank) return {};
  Finding finding =
      judge_modes({*archive.bank, role, densities_of(*bank, *archive.recording, role), competitors, archive.summary,
                   archive.horizons, resolutions(*bank, archive.bank->quantum, *archive.recording, role),
                   archive.free_runs, archive.one_motion_drifts()});
  finding.text = finding_text(finding);
  return finding;
}

}  // namespace modebank
