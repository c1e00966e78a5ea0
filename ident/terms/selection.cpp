#include "ident/terms/selection.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "ident/base/linalg.hpp"
#include "ident/fit/robust_regression.hpp"
#include "ident/fit/scale.hpp"
#include "ident/lag/student_density.hpp"
#include "ident/model/transitions.hpp"
#include "ident/terms/dictionary.hpp"

namespace modebank {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr Index folds = 4;
constexpr Index most_terms = 16;
constexpr double clipped_errors = 6.0;  // limit of an error, in robust standard deviations

// as a share of the errors' standard deviation; needed because more than half of the errors may be zero
constexpr double least_share = 0.02;
constexpr double ridge = 1e-6;        // share of the number of rows; columns have unit root mean square
constexpr double new_share = 1e-3;    // smallest share of a column that must be independent of the previous columns
constexpr double least_gain = 0.002;  // smallest gain of each further term [nats/sample]
constexpr double exact_share = 1e-9;  // as a share of the increments; a smaller error counts as an exact prediction
constexpr double least_scale = 1e-150;
constexpr Index patience = 3;  // the search ends after this number of successive steps that gain less than a quarter of
                               // least_gain

VectorXd robust_deviations(const MatrixXd& errors, const MatrixXd& increments) {
  VectorXd deviation(errors.cols());
  for (Index i = 0; i < errors.cols(); ++i) {
    const double sd = std::sqrt(errors.col(i).squaredNorm() / static_cast<double>(errors.rows()));
    const double size = std::sqrt(increments.col(i).squaredNorm() / static_cast<double>(errors.rows()));
    deviation(i) = std::max({normalised_mad(errors.col(i)), least_share * sd, exact_share * size, least_scale});
  }
  return deviation;
}

/// Cross-validated regression, fold by fold, from Gram matrices alone.
class FoldedRegression {
 public:
  FoldedRegression(const MatrixXd& columns, const MatrixXd& targets, const std::vector<Index>& fold)
      : N_(static_cast<double>(columns.rows())), rows_(folds) {
    for (std::size_t k = 0; k < fold.size(); ++k)
      rows_[static_cast<std::size_t>(fold[k])].push_back(static_cast<Index>(k));
    const Index C = columns.cols();
    gram_ = MatrixXd::Zero(C, C);
    cross_ = MatrixXd::Zero(C, targets.cols());
    for (const std::vector<Index>& of_fold : rows_) {
      columns_.emplace_back(columns(of_fold, Eigen::all));
      targets_.emplace_back(targets(of_fold, Eigen::all));
      MatrixXd G = MatrixXd::Zero(C, C);
      G.selfadjointView<Eigen::Lower>().rankUpdate(columns_.back().transpose());
      G.triangularView<Eigen::StrictlyUpper>() = G.transpose();
      gram_ += G;
      cross_ += columns_.back().transpose() * targets_.back();
      left_gram_.push_back(std::move(G));
      left_cross_.emplace_back(columns_.back().transpose() * targets_.back());
    }
  }

  /// Errors of the left-out rows, predicted with the columns `taken`.
  MatrixXd errors(const std::vector<Index>& taken) const {
    MatrixXd result(static_cast<Index>(N_), cross_.cols());
    for (std::size_t f = 0; f < rows_.size(); ++f) {
      MatrixXd A = gram_(taken, taken) - left_gram_[f](taken, taken);
      A.diagonal().array() += ridge * N_;
      const MatrixXd h = cross_(taken, Eigen::all) - left_cross_[f](taken, Eigen::all);
      const MatrixXd left = targets_[f] - columns_[f](Eigen::all, taken) * solve_semidefinite(A, h);
      result(rows_[f], Eigen::all) = left;
    }
    return result;
  }

  /// Decrease of the left-out rows' squared errors for each candidate column. Minus infinity for columns that depend
  /// linearly on the columns already taken.
  VectorXd gains(const std::vector<Index>& taken) const {
    const Index C = gram_.cols();
    VectorXd gain = VectorXd::Zero(C);
    for (std::size_t f = 0; f < rows_.size(); ++f) {
      const MatrixXd &A2 = left_gram_[f], &h2 = left_cross_[f];
      const MatrixXd A_rows = gram_(taken, Eigen::all) - A2(taken, Eigen::all), A2_rows = A2(taken, Eigen::all);
      MatrixXd square = A_rows(Eigen::all, taken);
      square.diagonal().array() += ridge * N_;
      const MatrixXd h = cross_ - h2;
      const MatrixXd theta = solve_semidefinite(square, MatrixXd(h(taken, Eigen::all)));
      const MatrixXd project = solve_semidefinite(square, A_rows);  // columns already taken x C
      const MatrixXd A2_project = A2_rows(Eigen::all, taken) * project;
      const VectorXd own = gram_.diagonal() - A2.diagonal();
      VectorXd left = own - A_rows.cwiseProduct(project).colwise().sum().transpose();
      const MatrixXd rho_times_left = h - A_rows.transpose() * theta;
      const MatrixXd response = h2 - A2_rows.transpose() * theta -
                                project.transpose() * (h2(taken, Eigen::all) - A2_rows(Eigen::all, taken) * theta);
      const VectorXd energy = A2.diagonal() - 2.0 * project.cwiseProduct(A2_rows).colwise().sum().transpose() +
                              project.cwiseProduct(A2_project).colwise().sum().transpose();
      for (Index j = 0; j < C; ++j) {
        if (!(left(j) >= new_share * gram_(j, j)) || !(gram_(j, j) > 0.0)) {
          gain(j) = -std::numeric_limits<double>::infinity();
          continue;
        }
        for (Index i = 0; i < cross_.cols(); ++i) {
          const double rho = rho_times_left(j, i) / left(j);
          gain(j) += 2.0 * rho * response(j, i) - rho * rho * energy(j);
        }
      }
    }
    return gain;
  }

 private:
  double N_;
  std::vector<std::vector<Index>> rows_;
  std::vector<MatrixXd> columns_, targets_, left_gram_, left_cross_;
  MatrixXd gram_, cross_;
};

MatrixXd of_unit_size(MatrixXd columns) {
  for (Index j = 0; j < columns.cols(); ++j) {
    const double rms = columns.col(j).stableNorm() / std::sqrt(static_cast<double>(columns.rows()));
    if (rms > 0.0 && std::isfinite(rms)) columns.col(j) /= rms;
  }
  return columns;
}

bool stands_still(const std::vector<VectorXd>& path) {
  if (std::ssize(path) <= patience + 1) return false;
  double before = -std::numeric_limits<double>::infinity(), lately = before;
  for (std::size_t i = 0; i < path.size(); ++i) {
    double& of = std::ssize(path) - static_cast<Index>(i) <= patience ? lately : before;
    of = std::max(of, path[i].mean());
  }
  return lately < before + 0.25 * least_gain;
}

/// The first step of the path whose loss relative to the best step is negligible or within one standard error.
std::size_t fewest_as_good(const std::vector<VectorXd>& path, const TermRows& rows) {
  const auto best = std::max_element(path.begin(), path.end(),
                                     [](const VectorXd& a, const VectorXd& b) { return a.mean() < b.mean(); });
  for (std::size_t i = 0; i < path.size(); ++i) {
    const PartGain loss = gain_over_parts(*best - path[i], rows);
    if (loss.mean <= std::max(loss.standard_error, least_gain)) return i;
  }
  return 0;
}

}  // namespace

VectorXd student_densities(const MatrixXd& errors) {
  VectorXd density = VectorXd::Zero(errors.rows());
  for (Index i = 0; i < errors.cols(); ++i) {
    const double rms = std::sqrt(errors.col(i).squaredNorm() / static_cast<double>(errors.rows()));
    density += fitted_student_log_density(errors.col(i), std::max(1e-3 * rms, least_scale));
  }
  return density;
}

MatrixXd design_of(const TermRows& rows, const LinearStructure& structure, const MotionTerms& terms) {
  const MatrixXd X = rows.regressors(structure);
  MatrixXd design(X.rows(), X.cols() + terms.count());
  design.leftCols(X.cols()) = X;
  if (!terms.empty()) design.rightCols(terms.count()) = term_columns(terms, X);
  return design;
}

MatrixXd fit_terms(const TermRows& rows, const LinearStructure& structure, const MotionTerms& terms,
                   const FitOptions& options) {
  const MatrixXd design = design_of(rows, structure, terms);
  MatrixXd coefficients(design.cols(), rows.Y.cols());
  for (Index i = 0; i < rows.Y.cols(); ++i)
    coefficients.col(i) = robust_or_least_squares({design, rows.Y.col(i)}, options);
  return coefficients;
}

SelectedTerms select_terms(const TermRows& rows, const LinearStructure& structure, const FitOptions& options) {
  SelectedTerms selected{structure, {}};
  const MatrixXd X = rows.regressors(structure);
  const MatrixXd fit = fit_terms(rows, structure, {}, options);
  const MatrixXd errors = rows.Y - X * fit;
  const VectorXd deviation = robust_deviations(errors, rows.Y);
  MatrixXd targets = rows.Y;
  for (Index i = 0; i < targets.cols(); ++i) {
    const double most = clipped_errors * deviation(i);
    targets.col(i) = (X * fit.col(i) + errors.col(i).cwiseMax(-most).cwiseMin(most)) / deviation(i);
  }
  const MotionTerms dictionary = make_dictionary(structure, X, fit, targets);
  // An orthonormal basis of the linear regressors is used, because lags of a smooth signal are nearly equal columns.
  // Any basis is valid.
  const MatrixXd basis = decompose(X, excitation_tolerance).U;
  MatrixXd columns(X.rows(), basis.cols() + dictionary.count());
  columns << basis, term_columns(dictionary, X);
  columns = of_unit_size(std::move(columns));
  std::vector<Index> fold;
  for (const Index part : rows.part) fold.push_back(part % folds);
  const FoldedRegression regression(columns, targets, fold);
  std::vector<Index> taken(static_cast<std::size_t>(basis.cols()));
  for (std::size_t j = 0; j < taken.size(); ++j) taken[j] = static_cast<Index>(j);
  const double of_units = deviation.array().log().sum();
  const auto score = [&] { return VectorXd(student_densities(regression.errors(taken)).array() - of_units); };
  std::vector<VectorXd> path{score()};
  while (std::ssize(path) <= most_terms && !stands_still(path)) {
    VectorXd gains = regression.gains(taken);
    for (const Index j : taken) gains(j) = -std::numeric_limits<double>::infinity();
    Index best = 0;
    if (!(gains.maxCoeff(&best) > 0.0)) break;
    taken.push_back(best);
    path.push_back(score());
  }
  const std::size_t count = fewest_as_good(path, rows);
  std::vector<Term> terms;
  for (std::size_t t = 0; t < count; ++t)
    terms.push_back(
        dictionary.terms[static_cast<std::size_t>(taken[static_cast<std::size_t>(basis.cols()) + t] - basis.cols())]);
  if (!terms.empty()) selected.terms = used_part(dictionary, terms);
  selected.left_out = std::move(path[count]);
  return selected;
}

}  // namespace modebank
