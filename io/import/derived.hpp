#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "io/import/expression.hpp"
#include "io/import/options.hpp"
#include "io/table/table_reader.hpp"

namespace modebank {

/// A channel that is computed: "NAME [unit] = EXPRESSION".
struct DerivedChannel {
  std::string name, unit;
  Expression expression;
};

/// Throws ConfigurationError, naming the key and the character, for a line that is no derived channel.
DerivedChannel parse_derived(const std::string& line);

/// data.derive and data.where, parsed: a channel may use those before it.
class DerivedChannels {
 public:
  /// Throws ConfigurationError for a line that is none, a name given twice and a channel that uses itself or a later
  /// one.
  explicit DerivedChannels(const DataOptions& options);

  /// Of that name; null when there is none.
  const DerivedChannel* find(const std::string& name) const;
  /// data.where, as a channel of no name; null when it is not set.
  const DerivedChannel* where() const { return where_ ? &*where_ : nullptr; }
  std::vector<std::string> names() const;

 private:
  std::vector<DerivedChannel> channels_;
  std::optional<DerivedChannel> where_;
};

/// A derived channel of one table: computed where its name stands among the request's numbers.
struct DerivedColumn {
  std::size_t position = 0;  ///< in TableRequest::numbers
  std::shared_ptr<const DerivedChannel> channel;
  std::vector<std::size_t> operands;  ///< positions there, all before it
};

/// The request without the columns that are computed.
TableRequest columns_to_read(const TableRequest& request, const std::vector<DerivedColumn>& derived);

/// In which order a table's rows follow each other: run by run (of equal text in column `run` of its texts) and in
/// order of time: the table's own, else of `clock` where that has as many rows, else k / rate_hz.
struct RowOrder {
  const Table& clock;
  std::optional<std::size_t> run;
  double rate_hz = 0.0;
};

/// Puts the derived columns into a table that columns_to_read gave. Throws DataError, naming file and line, where one
/// is missing and may not miss.
void derive_columns(const std::string& file, const TableRequest& request, const std::vector<DerivedColumn>& derived,
                    const RowOrder& order, Table& table);

}  // namespace modebank
