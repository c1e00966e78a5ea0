#include <algorithm>
#include <cmath>

#include "app/chain/error_pattern.hpp"
#include "app/chain/stages.hpp"
#include "app/text/finding_text.hpp"
#include "app/text/judged_runs.hpp"
#include "app/text/operating_point.hpp"
#include "filter/step/motions.hpp"
#include "ident/check/run_check.hpp"
#include "ident/check/stream_check.hpp"
#include "ident/model/equations.hpp"
#include "ident/model/parameter_labels.hpp"

namespace modebank {
namespace {

Densities densities_of(const FilterEvaluation& evaluation, const Recording& recording, Role role) {
  Densities densities{evaluation.filter, {}};
  for (std::size_t i = 0; i < recording.runs.size(); ++i)
    if (recording.runs[i].role == role) densities.of_runs.push_back(evaluation.runs[i].log_density);
  return densities;
}

/// For each run and sample of a recording: true if the robot rests.
using Rests = std::vector<std::vector<bool>>;

Rests rests_of(const Recording& recording) {
  Eigen::VectorXd still_level = Eigen::VectorXd::Zero(recording.input_count());
  for (const Trajectory& run : recording.runs)
    for (Index i = 0; i < still_level.size(); ++i)
      for (const double value : run.input.row(i))
        if (std::isfinite(value)) still_level(i) = std::max(still_level(i), still_share * std::abs(value));
  Rests rests;
  for (const Trajectory& run : recording.runs)
    rests.push_back(resting_samples({run.time_s, run.state}, {run.time_s, run.input}, still_level));
  return rests;
}

std::vector<std::pair<std::string, double>> coefficients_of(const Bank& bank) {
  const std::vector<std::string> labels = parameter_labels(bank.structure, bank.state_names, bank.input_names);
  const Eigen::VectorXd theta = bank.theta(0);
  std::vector<std::pair<std::string, double>> coefficients;
  for (Index i = 0; i < theta.size(); ++i) coefficients.emplace_back(labels[static_cast<std::size_t>(i)], theta(i));
  return coefficients;
}

/// Resolution of each state over all judged runs. `quantum`: the bank's rounding steps. A state with a rounding step
/// repeats its values, and its scores are masses of intervals. Samples at rest are ignored, because even fine
/// measurements repeat their values at rest.
std::vector<Resolution> resolutions(const Eigen::VectorXd& quantum, const Recording& recording, Role role) {
  const Rests rests = rests_of(recording);
  Index samples = 0;
  for (const Trajectory& run : recording.runs) samples += run.role == role ? run.samples() : 0;
  std::vector<Resolution> states;
  for (Index i = 0; i < recording.state_count(); ++i) {
    Eigen::VectorXd values(samples);
    std::vector<bool> at_rest;
    for (std::size_t r = 0; r < recording.runs.size(); ++r) {
      const Trajectory& run = recording.runs[r];
      if (run.role != role) continue;
      values.segment(std::ssize(at_rest), run.samples()) = run.state.row(i).transpose();
      at_rest.insert(at_rest.end(), rests[r].begin(), rests[r].end());
    }
    app::Spread spread(1);
    spread.add(values.transpose());
    const bool known = i < quantum.size() && quantum(i) > 0.0;
    states.push_back({recording.states[static_cast<std::size_t>(i)].name,
                      known ? 0.0 : repeats_in_motion(values, at_rest), spread.deviation()(0)});
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
    else if (evaluation.filter != combined_name)
      competitors.push_back(densities_of(evaluation, *archive.recording, role));
  }
  if (!bank || !archive.bank) return {};
  Finding finding =
      judge_modes({*archive.bank, role, densities_of(*bank, *archive.recording, role), competitors, archive.summary,
                   archive.horizons, resolutions(archive.bank->quantum, *archive.recording, role), archive.free_runs,
                   archive.step_scatter, archive.diagnostics, error_pattern(archive, *bank),
                   archive.baseline ? response_samples(*archive.baseline) : 1.0});
  if (finding.without_noise && archive.baseline) finding.coefficients = coefficients_of(*archive.baseline);
  if (finding.description == Description::one_nonlinear_motion && archive.nonlinear) {
    const Bank& bent = *archive.nonlinear;
    finding.equations = equations(bent.structure, bent.modes.front().model, bent.terms, bent.modes.front().bend,
                                  bent.state_names, bent.input_names);
  }
  finding.terms_asked = archive.terms_asked || archive.nonlinear;
  finding.stretches = are_stretches(*archive.recording);
  finding.text = finding_text(finding);
  return finding;
}

}  // namespace modebank
