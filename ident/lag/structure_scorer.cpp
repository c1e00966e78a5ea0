#include "ident/lag/structure_scorer.hpp"

#include <algorithm>
#include <cmath>

#include "ident/base/linalg.hpp"
#include "ident/fit/robust_regression.hpp"
#include "ident/lag/student_density.hpp"

namespace modebank {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Ridge on the diagonal of a Gram matrix of columns with unit root mean square, as a share of the number of rows. It
/// spreads the effect of collinear columns over these columns. Other coefficients do not change.
constexpr double collinear_ridge = 1e-11;
constexpr double exact_share = 1e-9;  // as a share of the increments; a smaller error counts as an exact prediction

// as a share of the errors' root mean square; needed because more than half of the errors may be zero
constexpr double least_share_of_rms = 1e-3;
constexpr double least_normal_scale = 1e-150;  // the square of this value is still a normal floating-point number

/// All rows of one response except rows first .. first + count - 1.
Transitions rows_without(const LaggedRows& rows, const std::vector<Index>& columns, Index response, Index first,
                         Index count) {
  const Index N = rows.count(), after = N - first - count;
  const auto without = [&](const auto& from, auto to) {
    to.topRows(first) = from.topRows(first);
    to.bottomRows(after) = from.bottomRows(after);
  };
  Transitions kept{MatrixXd(N - count, std::ssize(columns)), MatrixXd(N - count, 1)};
  for (std::size_t j = 0; j < columns.size(); ++j)
    without(rows.X.col(columns[j]), kept.regressors.col(static_cast<Index>(j)));
  without(rows.Y.col(response), kept.increments.col(0));
  return kept;
}

}  // namespace

VectorXd part_rows_of(const StretchParts& parts) {
  VectorXd rows = VectorXd::Zero(parts.count);
  for (const Index part : parts.part) rows(part) += 1.0;
  return rows;
}

LeftOutForecast left_out_forecast(const MatrixXd& errors, const StretchParts& parts, const VectorXd& least_scale) {
  const auto rows = static_cast<double>(errors.rows());
  LeftOutForecast forecast{VectorXd::Zero(parts.count), VectorXd(errors.cols())};
  for (Index i = 0; i < errors.cols(); ++i) {
    forecast.rmse(i) = std::sqrt(errors.col(i).squaredNorm() / rows);
    const double floor = std::max({least_scale(i), least_share_of_rms * forecast.rmse(i), least_normal_scale});
    const VectorXd density = fitted_student_log_density(errors.col(i), floor);
    for (Index k = 0; k < density.size(); ++k) forecast.of_part(parts.part[static_cast<std::size_t>(k)]) += density(k);
  }
  forecast.log_score = forecast.of_part.sum() / rows;
  return forecast;
}

StructureScorer::StructureScorer(const LaggedRows& rows, const VectorXd& quantum) : rows_(rows) {
  least_scale_ = exact_share * (rows.Y.colwise().squaredNorm() / static_cast<double>(rows.count())).cwiseSqrt();
  for (Index i = 0; i < quantum.size(); ++i) least_scale_(i) = std::max(least_scale_(i), quantum(i) / std::sqrt(12.0));
  part_rows_ = part_rows_of(rows.parts);
  for (Index f = 0; f < rows.folds(); ++f) {
    const Index first = rows.fold_begin[static_cast<std::size_t>(f)];
    const Index count = rows.fold_begin[static_cast<std::size_t>(f) + 1] - first;
    const MatrixXd X = rows.X.middleRows(first, count), Y = rows.Y.middleRows(first, count);
    gram_.emplace_back(X.transpose() * X);
    cross_.emplace_back(X.transpose() * Y);
  }
  MatrixXd all_gram = MatrixXd::Zero(rows.X.cols(), rows.X.cols()),
           all_cross = MatrixXd::Zero(rows.X.cols(), rows.states);
  for (std::size_t f = 0; f < gram_.size(); ++f) {
    all_gram += gram_[f];
    all_cross += cross_[f];
  }
  for (std::size_t f = 0; f < gram_.size(); ++f) {
    gram_[f] = all_gram - gram_[f];
    cross_[f] = all_cross - cross_[f];
  }
}

MatrixXd StructureScorer::least_squares_errors(const LinearStructure& structure) const {
  const std::vector<Index> columns = rows_.columns(structure);
  const Index q = std::ssize(columns), of_states = structure.dimension(), of_inputs = structure.acting_inputs();
  MatrixXd errors = rows_.Y;
  for (Index f = 0; f < rows_.folds(); ++f) {
    const Index first = rows_.fold_begin[static_cast<std::size_t>(f)];
    const Index count = rows_.fold_begin[static_cast<std::size_t>(f) + 1] - first;
    if (count == 0 || count == rows_.count()) continue;
    MatrixXd gram = gram_[static_cast<std::size_t>(f)](columns, columns);
    gram.diagonal().array() += collinear_ridge * static_cast<double>(rows_.count());
    const MatrixXd cross = cross_[static_cast<std::size_t>(f)](columns, Eigen::all);
    const Cholesky factor(gram);
    MatrixXd coefficients(q, rows_.states);
    for (Index i = 0; i < rows_.states; ++i)
      coefficients.col(i) =
          factor.definite() ? factor.solve(cross.col(i)) : solve_semidefinite(gram, VectorXd(cross.col(i)));
    auto left_out = errors.middleRows(first, count);
    const auto X = rows_.X.middleRows(first, count);
    left_out.noalias() -= X.leftCols(of_states) * coefficients.topRows(of_states);
    if (of_inputs > 0)
      left_out.noalias() -= X.middleCols(columns[static_cast<std::size_t>(of_states)], of_inputs) *
                            coefficients.middleRows(of_states, of_inputs);
    if (structure.intercept) left_out.noalias() -= X.rightCols(1) * coefficients.bottomRows(1);
  }
  return errors;
}

MatrixXd StructureScorer::robust_errors(const LinearStructure& structure, const FitOptions& options) const {
  const std::vector<Index> columns = rows_.columns(structure);
  MatrixXd errors = least_squares_errors(structure);
  for (Index f = 0; f < rows_.folds(); ++f) {
    const Index first = rows_.fold_begin[static_cast<std::size_t>(f)];
    const Index count = rows_.fold_begin[static_cast<std::size_t>(f) + 1] - first;
    if (count == 0 || count == rows_.count()) continue;
    const MatrixXd X = rows_.X.middleRows(first, count)(Eigen::all, columns);
    for (Index i = 0; i < rows_.states; ++i) {
      const VectorXd theta = robust_coefficients(rows_without(rows_, columns, i, first, count), options);
      if (theta.size() > 0) errors.col(i).segment(first, count) = rows_.Y.col(i).segment(first, count) - X * theta;
    }
  }
  return errors;
}

LeftOutForecast StructureScorer::forecast(const MatrixXd& errors) const {
  return left_out_forecast(errors, rows_.parts, least_scale_);
}

LeftOutForecast StructureScorer::least_squares(const LinearStructure& structure) const {
  return forecast(least_squares_errors(structure));
}

LeftOutForecast StructureScorer::robust(const LinearStructure& structure, const FitOptions& options) const {
  return forecast(robust_errors(structure, options));
}

}  // namespace modebank
