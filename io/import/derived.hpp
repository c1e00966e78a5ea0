#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "io/import/expression.hpp"
#include "io/import/options.hpp"
#include "io/table/table_reader.hpp"

namespace modebank {

/// A computed channel, written as "NAME [unit] = EXPRESSION".
struct DerivedChannel {
  std::string name, unit;
  Expression expression;
};

/// Parses a line. If the line is not a derived channel, throws ConfigurationError with key and position.
DerivedChannel parse_derived(const std::string& line);

/// The parsed data.derive and data.where. A channel may use the derived channels before it.
class DerivedChannels {
 public:
  /// Throws ConfigurationError for an invalid line, a repeated name, and a channel that uses itself or a later channel.
  explicit DerivedChannels(const DataOptions& options);

  /// The channel of that name. Null if there is none.
  const DerivedChannel* find(const std::string& name) const;
  /// data.where as a channel without a name. Null if data.where is not set.
  const DerivedChannel* where() const { return where_ ? &*where_ : nullptr; }
  std::vector<std::string> names() const;

 private:
  std::vector<DerivedChannel> channels_;
  std::optional<DerivedChannel> where_;
};

/// A derived channel of one table. Its values are inserted at `position` among the request's numbers.
struct DerivedColumn {
  std::size_t position = 0;  ///< index in TableRequest::numbers
  std::shared_ptr<const DerivedChannel> channel;
  std::vector<std::size_t> operands;  ///< indices in TableRequest::numbers; all are less than `position`
};

/// The request without the columns that are computed.
TableRequest columns_to_read(const TableRequest& request, const std::vector<DerivedColumn>& derived);

/// Order of a table's rows. They are sorted by run (the text in column `run`), then by time. Times are the table's own
/// times. Without these they are the times of `clock` if it has the same number of rows, otherwise k / rate_hz.
struct RowOrder {
  const Table& clock;
  std::optional<std::size_t> run;
  double rate_hz = 0.0;
};

/// Inserts the derived columns into a table that was read by columns_to_read. Throws DataError with file and line if a
/// forbidden missing value occurs.
void derive_columns(const std::string& file, const TableRequest& request, const std::vector<DerivedColumn>& derived,
                    const RowOrder& order, Table& table);

}  // namespace modebank
