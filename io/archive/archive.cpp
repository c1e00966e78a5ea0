#include "io/archive/archive.hpp"

namespace modebank {

std::optional<Bank> Archive::bank_of(const std::string& filter) const {
  if (filter == "bank") return bank;
  if (filter == "baseline") return baseline;
  if (filter == "noise_only") return noise_only;
  if (filter == "one_motion") return one_motion;
  if (filter == "nonlinear") return nonlinear;
  if (filter == "drifting" && drifting) return fixed_bank(*drifting);
  if (filter == combined_name && bank) return combined_frame(*bank);
  return {};
}

void FilterEvaluation::with_run(std::size_t run, const Fields& fields,
                                const std::function<void(const RunEvaluation&)>& body) const {
  if (!in_file) return body(runs.at(run));
  RunEvaluation said;
  FreeRun unused;
  in_file(run, fields, said, unused);
  body(said);
}

void FilterEvaluation::with_free_run(std::size_t run, const std::function<void(const FreeRun&)>& body) const {
  if (!in_file) return body(free_runs.at(run));
  RunEvaluation unused;
  FreeRun free_run;
  in_file(run, {"free_run_mean", "free_run_sd", "free_run_lower", "free_run_upper"}, unused, free_run);
  body(free_run);
}

}  // namespace modebank
