#include "app/text/judged_runs.hpp"

#include <set>

namespace modebank {

const SummaryRow* pooled_row(const Archive& archive, const std::string& filter, Role role) {
  return modebank::pooled_row(archive.summary, filter, role);
}

std::optional<ScoresAhead> scores_ahead(const Archive& archive, const std::string& filter, Role role,
                                        Eigen::Index steps) {
  const auto of = [](const auto& row) { return ScoresAhead{row.log_score, row.rmse, row.coverage_95}; };
  if (const SummaryRow* row = steps == 1 ? pooled_row(archive, filter, role) : nullptr) return of(*row);
  for (const HorizonRow& row : archive.horizons)
    if (row.filter == filter && row.role == role && row.run == "*" && row.horizon == steps) return of(row);
  return {};
}

const DiagnosticsRow* diagnosis(const Archive& archive, const std::string& filter, Role role, Eigen::Index mode) {
  for (const DiagnosticsRow& row : archive.diagnostics)
    if (row.filter == filter && row.role == role && row.mode == mode) return &row;
  return nullptr;
}

const FilterEvaluation* evaluation_of(const Archive& archive, const std::string& filter) {
  for (const FilterEvaluation& evaluation : archive.evaluations)
    if (evaluation.filter == filter) return &evaluation;
  return nullptr;
}

Role judged_role(const Archive& archive) { return modebank::judged_role(archive.summary); }

std::vector<std::size_t> positions_of(const Recording& recording, Role role) {
  std::vector<std::size_t> positions;
  for (std::size_t i = 0; i < recording.runs.size(); ++i)
    if (recording.runs[i].role == role) positions.push_back(i);
  return positions;
}

const char* words_for(Role role) { return role == Role::test ? "held-out" : "training"; }

bool are_stretches(const Recording& recording) {
  std::set<std::string> drives;
  for (const Trajectory& run : recording.runs) drives.insert(run.file + run.run.substr(0, run.run.rfind('.')));
  return drives.size() < recording.runs.size();
}

const char* noun_of_runs(Eigen::Index count, bool stretches) {
  return count == 1 ? (stretches ? "stretch" : "run") : stretches ? "stretches" : "runs";
}

}  // namespace modebank
