#include "io/archive/groups/rule.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <sstream>
#include <type_traits>

#include "ident/base/covariance.hpp"
#include "ident/base/printable.hpp"

namespace modebank {

namespace {

std::string number_text(double value) {
  std::ostringstream text;
  text.imbue(std::locale::classic());
  text.precision(15);
  text << value;
  return text.str();
}

/// Some rows of an array, and the index of the first of these rows.
struct RowRange {
  const hdf5::Shape& shape;
  hsize_t first_row;
};

/// Position of the i-th value, for example "(3, 0)". Empty for a scalar.
std::string place(const RowRange& rows, std::size_t i) {
  const hdf5::Shape& shape = rows.shape;
  if (shape.empty()) return {};
  std::string text;
  for (std::size_t d = shape.size(); d-- > 0;) {
    const auto extent = static_cast<std::size_t>(std::max<hsize_t>(shape[d], 1));
    text = std::to_string(d == 0 ? i + rows.first_row : i % extent) + (text.empty() ? "" : ", ") + text;
    i /= extent;
  }
  return " at (" + text + ")";
}

/// The rule, with the letter's extent as the bound for positions.
Rule bound(Rule rule, const Sizes& sizes) {
  if (rule.below.empty()) return rule;
  if (const auto extent = sizes.find(rule.below)) rule.most = static_cast<double>(*extent) - 1.0;
  return rule;
}

bool holds(const Rule& rule, double value) {
  if (std::isnan(value)) return rule.may_be_missing;
  if (rule.finite && std::isinf(value)) return false;
  return (rule.above_least ? value > rule.least : value >= rule.least) && value <= rule.most;
}

std::string demand(const Rule& rule) {
  const std::string least = number_text(rule.least), most = number_text(rule.most == rule::one ? 1.0 : rule.most);
  std::string text = "must be finite";
  if (std::isfinite(rule.least) && std::isfinite(rule.most))
    text = "must lie in " + least + " .. " + most;
  else if (std::isfinite(rule.least))
    text = (rule.above_least ? "must be above " : "must be at least ") + least;
  return text + (rule.may_be_missing ? " or NaN" : "");
}

using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Number of values in one matrix or row. Its extents are the last `dimensions` extents of the array.
std::size_t values_in(const hdf5::Shape& shape, std::size_t dimensions) {
  std::size_t count = 1;
  for (std::size_t d = shape.size() - std::min(dimensions, shape.size()); d < shape.size(); ++d)
    count *= static_cast<std::size_t>(shape[d]);
  return count;
}

std::string not_increasing(const RowRange& rows, std::span<const double> values) {
  for (std::size_t i = 1; i < values.size(); ++i)
    if (!(values[i] > values[i - 1]))
      return "does not increase" + place(rows, i) + ": " + number_text(values[i]) + " after " +
             number_text(values[i - 1]);
  return {};
}

std::string broken_sums(const RowRange& rows, std::span<const double> values) {
  constexpr double tolerance = 1e-6;
  const std::size_t row = values_in(rows.shape, 1);
  for (std::size_t begin = 0; row > 0 && begin < values.size(); begin += row) {
    double sum = 0.0;
    for (std::size_t i = begin; i < begin + row; ++i) sum += values[i];
    if (std::abs(sum - 1.0) > tolerance)
      return "holds probabilities that sum to " + number_text(sum) + place(rows, begin);
  }
  return {};
}

using MatrixOfFile = Eigen::Map<const RowMajor>;

std::string broken_matrices(const RowRange& rows, std::span<const double> values) {
  const std::size_t matrix = values_in(rows.shape, 2);
  const auto side = static_cast<Eigen::Index>(rows.shape.empty() ? 1 : rows.shape.back());
  for (std::size_t begin = 0; matrix > 0 && begin + matrix <= values.size(); begin += matrix) {
    const MatrixOfFile here(values.data() + begin, side, side);
    const bool square = static_cast<std::size_t>(side * side) == matrix;
    if (!square || !is_covariance(here))
      return "holds a matrix" + place(rows, begin) +
             " that is not a covariance: not symmetric or not positive semidefinite";
  }
  return {};
}

std::string broken_form(Rule::Form form, const RowRange& rows, std::span<const double> values) {
  switch (form) {
    case Rule::Form::none:
      return {};
    case Rule::Form::increasing:
      return not_increasing(rows, values);
    case Rule::Form::probabilities:
      return broken_sums(rows, values);
    case Rule::Form::covariances:
      return broken_matrices(rows, values);
  }
  return {};
}

}  // namespace

template <class Number>
std::string broken(const Rule& given, const Sizes& sizes, const hdf5::Shape& shape, const Number* values,
                   hsize_t first_row) {
  const Rule rule = bound(given, sizes);
  const RowRange rows{shape, first_row};
  const auto count = static_cast<std::size_t>(hdf5::element_count(shape));
  for (std::size_t i = 0; i < count; ++i)
    if (!holds(rule, static_cast<double>(values[i])))
      return "holds " + number_text(static_cast<double>(values[i])) + place(rows, i) + ", " + demand(rule);
  if (rule.form == Rule::Form::none) return {};
  if constexpr (std::is_same_v<Number, double>)
    return broken_form(rule.form, rows, {values, count});
  else
    return broken_form(rule.form, rows, std::vector<double>(values, values + count));
}

template std::string broken(const Rule&, const Sizes&, const hdf5::Shape&, const double*, hsize_t);
template std::string broken(const Rule&, const Sizes&, const hdf5::Shape&, const std::int8_t*, hsize_t);
template std::string broken(const Rule&, const Sizes&, const hdf5::Shape&, const std::int32_t*, hsize_t);
template std::string broken(const Rule&, const Sizes&, const hdf5::Shape&, const std::int64_t*, hsize_t);
template std::string broken(const Rule&, const Sizes&, const hdf5::Shape&, const std::uint64_t*, hsize_t);

std::string broken_text(const std::vector<std::string>& texts, bool whole) {
  for (const std::string& text : texts)
    if (whole ? holds_controls(text) : name_holds_controls(text))
      return "has the text \"" + printable_name(text) + "\", which contains control characters";
  return {};
}

}  // namespace modebank
