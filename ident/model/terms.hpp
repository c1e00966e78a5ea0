#pragma once

#include <Eigen/Core>
#include <vector>

#include "modebank/base/names.hpp"

/// Terms make a motion nonlinear. They are functions of the regressors and are added to the linear part. Each term has
/// one coefficient per state, so the model remains linear in its parameters.
namespace modebank {

/// product: of up to three variables. magnitude: |z|. hinge: max(0, z - knot).
enum class TermKind { product, magnitude, hinge };

template <>
struct EnumNames<TermKind> {
  static constexpr Names<3> values{"product", "magnitude", "hinge"};
};

struct Term {
  TermKind kind = TermKind::product;
  std::vector<Eigen::Index> variables;  ///< one to three variables for a product (repeats allowed), one variable for
                                        ///< other terms
  double knot = 0.0;                    ///< knot of a hinge, in units of its variable

  bool operator==(const Term&) const = default;
};

/// V variables and T terms of these variables. Variable i is z_i = clip(direction_i' phi, low_i, high_i) / unit_i. phi
/// are the q regressors of LinearStructure. A direction is a single regressor or a direction of the linear fit. The
/// limits are the training range, because products grow fast beyond it.
struct MotionTerms {
  Eigen::MatrixXd direction = {};  ///< directions of the variables, q x V
  Eigen::VectorXd low, high = {};  ///< V
  Eigen::VectorXd unit = {};       ///< V, positive
  std::vector<Term> terms = {};    ///< T

  bool empty() const { return terms.empty(); }
  Eigen::Index count() const { return static_cast<Eigen::Index>(terms.size()); }
  Eigen::Index variables() const { return direction.cols(); }
};

/// Throws std::invalid_argument if a part of the terms is invalid for q regressors; the message describes the first
/// such part.
void check_terms(const MotionTerms& terms, Eigen::Index regressors);

/// The terms with the indices `used`, and only those variables that appear in these terms.
MotionTerms used_part(const MotionTerms& terms, const std::vector<Term>& used);

/// Evaluates terms at one point. The first use allocates; later ones do not.
class TermValues {
 public:
  void evaluate(const MotionTerms& terms, const Eigen::Ref<const Eigen::VectorXd>& regressors);
  const Eigen::VectorXd& value() const { return value_; }  ///< T
  const Eigen::MatrixXd& slope() const { return slope_; }  ///< derivatives, T x q; 0 for a clipped variable
  bool is_clipped() const { return clipped_; }             ///< whether some variable is clipped

 private:
  Eigen::VectorXd variable_, per_unit_, value_;
  Eigen::MatrixXd by_variable_, slope_;
  bool clipped_ = false;
};

/// Terms of many rows of regressors (N x q), N x T.
Eigen::MatrixXd term_columns(const MotionTerms& terms, const Eigen::Ref<const Eigen::MatrixXd>& regressors);

/// Share of the rows in which some variable lies outside its range. Ignores rows that are not finite.
double share_outside(const MotionTerms& terms, const Eigen::Ref<const Eigen::MatrixXd>& regressors);

}  // namespace modebank
