#pragma once

#include <hdf5.h>

#include <limits>
#include <string>
#include <vector>

#include "io/archive/groups/sizes.hpp"

namespace modebank {

/// Allowed values of a member, in addition to its type and extents. The layout gives a rule to each member that has
/// forbidden values. Readers enforce the rule.
struct Rule {
  /// Rules that concern all numbers of a member together.
  enum class Form {
    none,
    increasing,     ///< each value is greater than the previous value
    probabilities,  ///< each slice along the last extent sums to 1
    covariances     ///< each slice along the last two extents is a symmetric, positive semidefinite matrix
  };
  double least = -std::numeric_limits<double>::infinity();
  double most = std::numeric_limits<double>::infinity();
  bool above_least = false;     ///< the value `least` itself is not allowed
  bool finite = true;           ///< false: infinite values within the bounds are allowed
  bool may_be_missing = false;  ///< NaN marks an unknown value
  std::string below = {};       ///< a letter: the values are positions below this letter's extent
  Form form = Form::none;
  bool index = false;  ///< values are used as positions or sizes, so every reader checks them, not only verification
};

/// The rules that the layout uses.
namespace rule {

/// Any value, including NaN and infinities. For computed results.
inline const Rule any{.finite = false, .may_be_missing = true};
inline const Rule finite{};
inline const Rule finite_or_missing{.may_be_missing = true};
inline const Rule positive{.least = 0.0, .above_least = true};
inline const Rule not_negative{.least = 0.0};
inline constexpr double one = 1.0 + 1e-9;  ///< allows for rounding errors
inline const Rule share{.least = 0.0, .most = one};
inline const Rule at_least_one{.least = 1.0, .index = true};
inline const Rule increasing{.form = Rule::Form::increasing};
inline const Rule probabilities{.least = 0.0, .most = one, .form = Rule::Form::probabilities};
inline const Rule covariances{.form = Rule::Form::covariances};

/// Numbers of lags and channels. The limit is far above any real number, but products of such sizes cannot overflow.
inline const Rule lags{.least = 1.0, .most = 1000.0, .index = true};
inline const Rule delay{.least = 0.0, .most = 1000.0, .index = true};
inline const Rule channels{.least = 0.0, .most = 1e5, .index = true};

inline Rule between(double least, double most) { return {.least = least, .most = most, .index = true}; }
/// Positions below the letter's extent. Any position if no array has bound the letter.
inline Rule position(std::string letter) { return {.least = 0.0, .below = std::move(letter), .index = true}; }
/// Positions below the letter's extent, or -1 for no position.
inline Rule position_or_none(std::string letter) { return {.least = -1.0, .below = std::move(letter), .index = true}; }

}  // namespace rule

/// Describes the first value that breaks the rule, for example "holds 255 at (3), must lie in 0 .. 3". Empty if all
/// values obey the rule. `shape` is in row-major order. `first_row`: index of the first of these rows in the whole
/// array.
template <class Number>
std::string broken(const Rule& rule, const Sizes& sizes, const hdf5::Shape& shape, const Number* values,
                   hsize_t first_row = 0);

/// Describes the first control character in the texts; empty if the texts have none. When names are printed, a terminal
/// would execute such a character. `whole`: the text is not a name, so line breaks and tabs are allowed.
std::string broken_text(const std::vector<std::string>& texts, bool whole = false);

}  // namespace modebank
