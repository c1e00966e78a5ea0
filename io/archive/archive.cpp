#include "io/archive/archive.hpp"

namespace modebank {

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
