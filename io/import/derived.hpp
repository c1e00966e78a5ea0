#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "io/import/expression.hpp"
#include "io/import/options.hpp"
#include "io/table/table_reader.hpp"

namespace modebank {

/// A computed channel: "NAME [unit] = EXPRESSION".
struct DerivedChannel {
  std::string name, unit;
  Expression expression;
};

/// Throws ConfigurationError with key and position for a line that is not a derived channel.
DerivedChannel parse_derived(const std::string& line);

/// Parsed data.derive and data.where. A channel may use earlier derived channels.
class DerivedChannels {
 public:
  /// Throws ConfigurationError for an invalid line, for a name given twice, and for a channel that uses itself or a
  /// later one.
  explicit DerivedChannels(const DataOptions& options);

  /// The channel of that name; null if there is none.
  const DerivedChannel* find(const std::string& name) const;
  /// data.where as a channel without a name; null if data.where is not set.
  const DerivedChannel* where() const { return where_ ? &*where_ : nullptr; }
  std::vector<std::string> names() const;

 private:
  std::vector<DerivedChannel> channels_;
  std::optional<DerivedChannel> where_;
};

/// A derived channel of one table. It is computed for its position among the request's numbers.
struct DerivedColumn {
  std::size_t position = 0;  ///< index in TableRequest::numbers
  std::shared_ptr<const DerivedChannel> channel;
  std::vector<std::size_t> operands;  ///< indices of the operands in TableRequest::numbers, all smaller than `position`
};

/// The request without the computed columns.
TableRequest columns_to_read(const TableRequest& request, const std::vector<DerivedColumn>& derived);

/// Order of a table's rows: by run (the text in column `run`), then by time. Times are the table's own; else those of
/// `clock` if it has as many rows; else k / rate_hz.
struct RowOrder {
  const Table& clock;
  std::optional<std::size_t> run;
  double rate_hz = 0.0;
};

/// Inserts the derived columns into a table that was read by columns_to_read. Throws DataError with file and line if a
/// value is missing and may not be.
void derive_columns(const std::string& file, const TableRequest& request, const std::vector<DerivedColumn>& derived,
                    const RowOrder& order, Table& table);

}  // namespace modebank
