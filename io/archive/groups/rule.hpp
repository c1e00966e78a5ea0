#pragma once

#include <hdf5.h>

#include <limits>
#include <string>
#include <vector>

#include "io/archive/groups/sizes.hpp"

namespace modebank {

/// What the values of one member of the layout may be, beside its kind and extents: the layout names one where any
/// value will not do, and whoever reads the member is kept from others, whatever they read it for.
struct Rule {
  /// Of all numbers of a member together.
  enum class Form {
    none,
    increasing,     ///< each above the one before
    probabilities,  ///< each stretch of the last extent sums to 1, unless some of it is missing
    parts,          ///< each stretch of the last extent sums to at most 1
    covariances,    ///< each stretch of the last two extents is a symmetric, positive semidefinite matrix
    spreads         ///< the same as it was computed: symmetric, of variances that are not negative, as far as known
  };
  double least = -std::numeric_limits<double>::infinity();
  double most = std::numeric_limits<double>::infinity();
  bool above_least = false;     ///< not `least` itself
  bool finite = true;           ///< false: infinities will do where the bounds allow them
  bool may_be_missing = false;  ///< NaN stands for what is not known
  std::string below = {};       ///< a letter: positions, below the extent that it has taken
  double beyond = 0.0;          ///< how far above the last position they may lie; 1: counts
  Form form = Form::none;
  bool index = false;  ///< values become positions or sizes: every reader checks them, not verification alone
};

/// The rules that the layout speaks of.
namespace rule {

/// Anything, NaN and infinities included: what was computed and is only shown.
inline const Rule any{.finite = false, .may_be_missing = true};
inline const Rule finite{};
inline const Rule finite_or_missing{.may_be_missing = true};
inline const Rule positive{.least = 0.0, .above_least = true};
inline const Rule not_negative{.least = 0.0};
inline const Rule not_negative_or_missing{.least = 0.0, .finite = false, .may_be_missing = true};
inline constexpr double one = 1.0 + 1e-9;  ///< but for rounding
inline const Rule share{.least = 0.0, .most = one};
inline const Rule share_or_missing{.least = 0.0, .most = one, .may_be_missing = true};
/// Infinite, too: what divides by it may be zero.
inline const Rule at_most_one{.most = one, .finite = false, .may_be_missing = true};
inline const Rule at_least_one{.least = 1.0, .index = true};
inline const Rule increasing{.form = Rule::Form::increasing};
inline const Rule probabilities{.least = 0.0, .most = one, .form = Rule::Form::probabilities};
inline const Rule probabilities_or_missing{
    .least = 0.0, .most = one, .may_be_missing = true, .form = Rule::Form::probabilities};
inline const Rule parts_or_missing{.least = 0.0, .most = one, .may_be_missing = true, .form = Rule::Form::parts};
inline const Rule covariances{.form = Rule::Form::covariances};
inline const Rule spreads{.finite = false, .may_be_missing = true, .form = Rule::Form::spreads};

/// Of a model, and of its channels: more than anybody asks for, and few enough that sizes made of them are numbers.
inline const Rule lags{.least = 1.0, .most = 1000.0, .index = true};
inline const Rule delay{.least = 0.0, .most = 1000.0, .index = true};
inline const Rule channels{.least = 0.0, .most = 1e5, .index = true};

inline Rule between(double least, double most) { return {.least = least, .most = most, .index = true}; }
/// Positions below the extent that the letter has taken; while no array has bound it, any position.
inline Rule position(std::string letter) { return {.least = 0.0, .below = std::move(letter), .index = true}; }
/// The same, or -1 for none.
inline Rule position_or_none(std::string letter) { return {.least = -1.0, .below = std::move(letter), .index = true}; }
/// How many of what the letter counts.
inline Rule count_of(std::string letter) { return {.least = 0.0, .below = std::move(letter), .beyond = 1.0}; }

}  // namespace rule

/// What of the values, `shape` in row-major order, breaks the rule, e.g. "holds 255 at (3), must lie in 0 .. 3"; empty
/// when nothing does.
/// `first_row`: the row of the whole array that the values begin with.
template <class Number>
std::string broken(const Rule& rule, const Sizes& sizes, const hdf5::Shape& shape, const Number* values,
                   hsize_t first_row = 0);

/// What of the texts a terminal would obey, for names are printed; empty when nothing does. Line ends and tabs will do
/// in a text that is no name, `whole`.
std::string broken_text(const std::vector<std::string>& texts, bool whole = false);

}  // namespace modebank
