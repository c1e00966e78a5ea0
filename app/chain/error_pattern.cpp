#include "app/chain/error_pattern.hpp"

#include <Eigen/QR>
#include <algorithm>
#include <vector>

#include "filter/judge/statistics.hpp"
#include "ident/data/streams.hpp"
#include "ident/terms/selection.hpp"
#include "ident/terms/term_rows.hpp"

namespace modebank {
namespace {

using Eigen::MatrixXd;

constexpr Index rows_per_column = 50;  // an unneeded column costs half a nat, which is 0.01 nats per sample with 50
                                       // rows
constexpr Index most_entries = 1'000'000;
constexpr Index most_folds = 5;

/// The training runs with the bank's normal scores z in place of the states.
Recording runs_of_errors(const Recording& recording, const FilterEvaluation& bank) {
  Recording errors{recording.states, recording.inputs, {}, {}};
  for (std::size_t i = 0; i < recording.runs.size(); ++i) {
    const Trajectory& run = recording.runs[i];
    if (run.role != Role::train || bank.runs[i].pit.cols() != run.samples()) continue;
    Trajectory of_run;
    of_run.run = run.run;
    of_run.time_s = run.time_s;
    of_run.input = run.input;
    of_run.state = normal_scores(bank.runs[i].pit);
    errors.runs.push_back(std::move(of_run));
  }
  return errors;
}

/// Residuals of a least-squares fit to `z`. The residuals of each fold come from a fit to the other folds.
MatrixXd left_out_errors(const TermRows& rows, const MatrixXd& z) {
  const Index folds = std::min(most_folds, rows.parts);
  MatrixXd errors = z;
  for (Index f = 0; f < folds; ++f) {
    std::vector<Index> inside, outside;
    for (Index k = 0; k < rows.count(); ++k)
      (rows.part[static_cast<std::size_t>(k)] % folds == f ? inside : outside).push_back(k);
    const MatrixXd before = rows.X(outside, Eigen::all), after = z(outside, Eigen::all);
    const MatrixXd coefficients = before.colPivHouseholderQr().solve(after);
    errors(inside, Eigen::all) -= rows.X(inside, Eigen::all) * coefficients;
  }
  return errors;
}

}  // namespace

ErrorPattern error_pattern(const Archive& archive, const FilterEvaluation& bank) {
  const bool lags_stated = archive.windows && !archive.structure;
  if (!lags_stated || archive.step_scatter > most_step_scatter) return {};
  if (archive.bank->model != "linear" && archive.bank->model != "varx") return {};
  const Recording errors = runs_of_errors(*archive.recording, bank);
  LinearStructure before{errors.state_count(), errors.input_count(), true};
  const Index signals = before.states + before.inputs;
  before.state_lags = before.input_lags =
      std::min(usual_lags, errors.transitions(Role::train) / (rows_per_column * signals));
  if (before.state_lags == 0) return {};
  const TermRows rows = gather_term_rows(errors, before, most_entries / before.regressors());
  if (rows.count() < rows_per_column * before.regressors() / 2) return {};
  const MatrixXd z = rows.Y + rows.X.leftCols(before.states);  // the rows' Y are increments of z
  const PartGain gain = gain_over_parts(student_densities(left_out_errors(rows, z)) - student_densities(z), rows);
  return {gain.mean, gain.standard_error};
}

}  // namespace modebank
