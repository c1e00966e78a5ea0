#include "ident/model/terms.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>

namespace modebank {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr std::size_t most_factors = 3;

bool fits(const Term& term, Index variables) {
  const std::size_t most = term.kind == TermKind::product ? most_factors : 1;
  return !term.variables.empty() && term.variables.size() <= most &&
         std::all_of(term.variables.begin(), term.variables.end(), [&](Index v) { return v >= 0 && v < variables; });
}

MatrixXd clipped_variables(const MotionTerms& terms, const Eigen::Ref<const MatrixXd>& regressors) {
  MatrixXd z = regressors * terms.direction;
  for (Index v = 0; v < z.cols(); ++v)
    z.col(v) = z.col(v).cwiseMax(terms.low(v)).cwiseMin(terms.high(v)) / terms.unit(v);
  return z;
}

}  // namespace

void check_terms(const MotionTerms& terms, Index regressors) {
  const auto require = [](bool holds, const std::string& what) {
    if (!holds) throw std::invalid_argument("the terms' " + what);
  };
  const Index V = terms.variables();
  if (terms.empty() && V == 0) return;
  require(terms.direction.rows() == regressors, "directions have " + std::to_string(terms.direction.rows()) +
                                                    " entries for " + std::to_string(regressors) + " regressors");
  require(terms.low.size() == V && terms.high.size() == V && terms.unit.size() == V,
          "each variable needs one range and one unit");
  require(terms.direction.allFinite() && terms.low.allFinite() && terms.high.allFinite() && terms.unit.allFinite(),
          "variables are not finite");
  require((terms.low.array() <= terms.high.array()).all() && (terms.unit.array() > 0.0).all(),
          "ranges are empty or units are not positive");
  for (const Term& term : terms.terms)
    require(fits(term, V) && std::abs(term.knot) < 1e300, "variables or knots are out of range");
}

MotionTerms used_part(const MotionTerms& terms, const std::vector<Term>& used) {
  std::vector<Index> kept;
  for (const Term& term : used) kept.insert(kept.end(), term.variables.begin(), term.variables.end());
  std::sort(kept.begin(), kept.end());
  kept.erase(std::unique(kept.begin(), kept.end()), kept.end());
  MotionTerms part{terms.direction(Eigen::all, kept), terms.low(kept), terms.high(kept), terms.unit(kept), used};
  for (Term& term : part.terms)
    for (Index& variable : term.variables)
      variable = std::lower_bound(kept.begin(), kept.end(), variable) - kept.begin();
  return part;
}

void TermValues::evaluate(const MotionTerms& terms, const Eigen::Ref<const VectorXd>& regressors) {
  const Index V = terms.variables(), T = terms.count();
  variable_.resize(V);
  per_unit_.resize(V);
  value_.resize(T);
  by_variable_.resize(T, V);
  slope_.resize(T, terms.direction.rows());
  variable_.noalias() = terms.direction.transpose() * regressors;
  clipped_ = false;
  for (Index v = 0; v < V; ++v) {
    const bool clipped = !(variable_(v) >= terms.low(v) && variable_(v) <= terms.high(v));
    clipped_ = clipped_ || clipped;
    variable_(v) = std::min(std::max(variable_(v), terms.low(v)), terms.high(v)) / terms.unit(v);
    per_unit_(v) = clipped ? 0.0 : 1.0 / terms.unit(v);
  }
  by_variable_.setZero();
  for (Index t = 0; t < T; ++t) {
    const Term& term = terms.terms[static_cast<std::size_t>(t)];
    const Index first = term.variables.front();
    const double z = variable_(first);
    if (term.kind == TermKind::magnitude) {
      value_(t) = std::abs(z);
      by_variable_(t, first) = z < 0.0 ? -1.0 : 1.0;
    } else if (term.kind == TermKind::hinge) {
      value_(t) = std::max(0.0, z - term.knot);
      by_variable_(t, first) = z > term.knot ? 1.0 : 0.0;
    } else {
      value_(t) = 1.0;
      for (std::size_t i = 0; i < term.variables.size(); ++i) {
        value_(t) *= variable_(term.variables[i]);
        double others = 1.0;
        for (std::size_t j = 0; j < term.variables.size(); ++j)
          if (j != i) others *= variable_(term.variables[j]);
        by_variable_(t, term.variables[i]) += others;
      }
    }
  }
  by_variable_.array().rowwise() *= per_unit_.transpose().array();
  slope_.noalias() = by_variable_ * terms.direction.transpose();
}

MatrixXd term_columns(const MotionTerms& terms, const Eigen::Ref<const MatrixXd>& regressors) {
  const MatrixXd z = clipped_variables(terms, regressors);
  MatrixXd columns(regressors.rows(), terms.count());
  for (Index t = 0; t < terms.count(); ++t) {
    const Term& term = terms.terms[static_cast<std::size_t>(t)];
    auto column = columns.col(t);
    column = z.col(term.variables.front());
    if (term.kind == TermKind::magnitude) column = column.cwiseAbs();
    if (term.kind == TermKind::hinge) column = (column.array() - term.knot).cwiseMax(0.0);
    for (std::size_t i = 1; i < term.variables.size(); ++i) column.array() *= z.col(term.variables[i]).array();
  }
  return columns;
}

double share_outside(const MotionTerms& terms, const Eigen::Ref<const MatrixXd>& regressors) {
  const MatrixXd z = regressors * terms.direction;
  Index outside = 0, known = 0;
  for (Index k = 0; k < z.rows(); ++k) {
    if (!z.row(k).allFinite()) continue;
    ++known;
    const auto row = z.row(k).transpose().array();
    outside += (row < terms.low.array()).any() || (row > terms.high.array()).any() ? 1 : 0;
  }
  return known > 0 ? static_cast<double>(outside) / static_cast<double>(known) : 0.0;
}

}  // namespace modebank
