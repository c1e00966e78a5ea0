#pragma once

#include <string>
#include <type_traits>
#include <vector>

#include "io/archive/groups/rule.hpp"
#include "io/hdf5/table.hpp"
#include "modebank/base/error.hpp"
#include "modebank/base/names.hpp"

namespace modebank {

/// A member of a row struct, stored as a column of a table.
template <class Row, class T>
struct Column {
  std::string name;
  T Row::*member;
  std::string unit = {};
  Rule rule = rule::any;  ///< rule for the column's values

  Column obeying(const Rule& other) const {
    Column column = *this;
    column.rule = other;
    return column;
  }
};

template <class Row, class T>
Column<Row, T> column(std::string name, T Row::*member, std::string unit = {}) {
  return {std::move(name), member, std::move(unit)};
}

/// The value as the file stores it. Booleans are 8-bit integers, because MATLAB and Octave read HDF5's own booleans as
/// enumerations. Enumerations are words.
template <class T>
auto to_stored(const T& value) {
  if constexpr (std::is_same_v<T, bool>)
    return static_cast<std::int8_t>(value ? 1 : 0);
  else if constexpr (std::is_enum_v<T>)
    return std::string(name_of(value));
  else if constexpr (std::is_integral_v<T> && std::is_signed_v<T> && sizeof(T) == 8)
    return static_cast<std::int64_t>(value);
  else
    return value;
}

template <class T, class Stored>
void from_stored(const Stored& stored, T& value) {
  if constexpr (std::is_same_v<T, bool>) {
    if (stored != 0 && stored != 1) throw DataError("holds " + std::to_string(stored) + ", must be 0 or 1");
    value = stored != 0;
  } else if constexpr (std::is_enum_v<T>) {
    const auto parsed = parse_name<T>(stored);
    if (!parsed) throw DataError("'" + stored + "' is not a known word");
    value = *parsed;
  } else {
    value = static_cast<T>(stored);
  }
}

/// The values of one column in all rows. If each row has a vector, the vectors form a matrix and must have equal
/// lengths.
template <class Row, class T>
hdf5::TableColumn encode(const std::vector<Row>& rows, const Column<Row, T>& column) {
  if constexpr (std::is_same_v<T, Eigen::VectorXd>) {
    const Eigen::Index length = rows.empty() ? 0 : (rows.front().*column.member).size();
    Eigen::MatrixXd values(length, static_cast<Eigen::Index>(rows.size()));
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const Eigen::VectorXd& value = rows[i].*column.member;
      if (value.size() != length) throw std::invalid_argument("lengths differ in the column '" + column.name + "'");
      values.col(static_cast<Eigen::Index>(i)) = value;
    }
    return {column.name, std::move(values)};
  } else {
    std::vector<decltype(to_stored(std::declval<T>()))> values;
    for (const Row& row : rows) values.push_back(to_stored(row.*column.member));
    return {column.name, std::move(values)};
  }
}

/// The first fault that the column's rule finds in its stored values. Empty if all values obey the rule.
inline std::string broken(const Rule& rule, const Sizes& sizes, const hdf5::TableColumn& column, hsize_t first_row) {
  return std::visit(
      [&](const auto& values) {
        using Values = std::decay_t<decltype(values)>;
        if constexpr (std::is_same_v<Values, std::vector<std::string>>)
          return broken_text(values, true);  // messages may contain line breaks
        else if constexpr (std::is_same_v<Values, Eigen::MatrixXd>)
          return broken(rule, sizes, {static_cast<hsize_t>(values.cols()), static_cast<hsize_t>(values.rows())},
                        values.data(), first_row);
        else
          return broken(rule, sizes, {values.size()}, values.data(), first_row);
      },
      column.values);
}

/// Resizes the rows and reads one column into them. `judged`: applies all rules; otherwise applies only rules on
/// positions.
template <class Row, class T>
void decode(const hdf5::TableRows& read, const Column<Row, T>& column, const Sizes& sizes, bool judged,
            std::vector<Row>& rows) {
  hdf5::TableColumn stored = encode(std::vector<Row>(), column);
  hdf5::read_column(read, stored);
  if constexpr (std::is_same_v<T, Eigen::VectorXd>) {
    // A table column with one value per measured signal. In an empty table the column has the smallest possible length.
    const Eigen::Index length = std::get<Eigen::MatrixXd>(stored.values).rows();
    if (const auto signals = sizes.find("n_y");
        signals && read.rows.count > 0 && *signals != static_cast<hsize_t>(length))
      throw DataError("column '" + column.name + "' has " + std::to_string(length) + " values a row, but n_y is " +
                      std::to_string(*signals));
  }
  if (judged || column.rule.index)
    if (const std::string problem = broken(column.rule, sizes, stored, read.rows.first); !problem.empty())
      throw DataError("column '" + column.name + "' " + problem);
  rows.resize(static_cast<std::size_t>(read.rows.count));
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if constexpr (std::is_same_v<T, Eigen::VectorXd>)
      rows[i].*column.member = std::get<Eigen::MatrixXd>(stored.values).col(static_cast<Eigen::Index>(i));
    else
      from_stored(std::get<std::vector<decltype(to_stored(std::declval<T>()))>>(stored.values)[i],
                  rows[i].*column.member);
  }
}

}  // namespace modebank
