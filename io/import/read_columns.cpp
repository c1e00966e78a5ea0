#include "io/import/read_columns.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "modebank/base/error.hpp"

namespace modebank {

namespace {

/// Columns that are requested from a table at once, and where their values go: to numbers, or to one of the other
/// types.
struct AskedColumns {
  TableRequest request;
  std::vector<std::size_t> columns;

  void into(Table&& table, FileColumns& result) const {
    std::vector<FileColumn>& of_table = result.tables[request.table];
    for (std::size_t i = 0; i < request.numbers.size(); ++i) of_table[columns[i]] = std::move(table.numbers[i]);
    if (!request.texts.empty()) of_table[columns.front()] = std::move(table.texts.front());
    if (!request.time.column.empty()) of_table[columns.front()] = std::move(table.time_ns);
    for (const auto& [word, count] : table.missing_words)  // the counts are per column, so the note states none
      table.notes.push_back(fmt::format("\"{}\" is read as a missing value (data.na)", word));
    if (!table.alternation.empty()) result.alternation[request.table] = std::move(table.alternation);
    for (std::string& note : table.notes)
      if (std::find(result.notes.begin(), result.notes.end(), note) == result.notes.end())
        result.notes.push_back(std::move(note));
  }

  void add_number(std::size_t column, const std::string& name) {
    columns.push_back(column);
    request.numbers.push_back(name);
    request.may_miss.push_back(true);
  }
};

AskedColumns text_piece(std::size_t table, std::size_t column, const std::string& name) {
  AskedColumns piece{{}, {column}};
  piece.request.table = table;
  piece.request.texts = {name};
  return piece;
}

AskedColumns stamp_piece(std::size_t table, std::size_t column, const std::string& name) {
  AskedColumns piece{{}, {column}};
  piece.request.table = table;
  piece.request.time.column = name;
  piece.request.time.may_miss = true;
  return piece;
}

/// Number of columns for each name. A name that occurs twice cannot be requested.
std::map<std::string, int> name_counts(const TableInfo& table) {
  std::map<std::string, int> counts;
  for (const ColumnInfo& column : table.columns) ++counts[column.name];
  return counts;
}

/// The pieces to read. A column of stamps or texts is one piece; all other columns together are one piece of numbers.
std::vector<AskedColumns> pieces_of(const std::vector<TableInfo>& tables, const ColumnChoice& wanted) {
  std::vector<AskedColumns> pieces;
  for (std::size_t t = 0; t < tables.size(); ++t) {
    AskedColumns numbers;
    numbers.request.table = t;
    const std::map<std::string, int> counts = name_counts(tables[t]);
    for (std::size_t c = 0; c < tables[t].columns.size(); ++c) {
      const ColumnInfo& column = tables[t].columns[c];
      if (!wanted(tables[t], column) || counts.at(column.name) > 1) continue;
      if (column.type == "time")
        pieces.push_back(stamp_piece(t, c, column.name));
      else if (column.type == "text")
        pieces.push_back(text_piece(t, c, column.name));
      else
        numbers.add_number(c, column.name);
    }
    if (!numbers.columns.empty()) pieces.push_back(std::move(numbers));
  }
  return pieces;
}

/// Tries to read the columns with these types. Returns whether this worked; `result` then contains the columns.
bool try_read(const TableReader& reader, const std::vector<AskedColumns>& pieces, FileColumns& result) {
  std::vector<TableRequest> requests;
  for (const AskedColumns& piece : pieces) requests.push_back(piece.request);
  try {
    std::vector<Table> tables = reader.read(requests, nullptr);
    for (std::size_t i = 0; i < pieces.size(); ++i) pieces[i].into(std::move(tables[i]), result);
    return true;
  } catch (const DataError&) {
    return false;
  }
}

/// Reads columns [first, end) of a piece of numbers. If this fails, reads each half separately. A single column that
/// cannot be read as numbers becomes text.
void read_numbers(const TableReader& reader, const AskedColumns& piece, std::size_t first, std::size_t end,
                  FileColumns& result) {
  AskedColumns part;
  part.request.table = piece.request.table;
  for (std::size_t i = first; i < end; ++i) part.add_number(piece.columns[i], piece.request.numbers[i]);
  if (try_read(reader, {part}, result)) return;
  if (end - first == 1) {
    try_read(reader, {text_piece(part.request.table, part.columns[0], part.request.numbers[0])}, result);
    return;
  }
  const std::size_t middle = first + (end - first) / 2;
  read_numbers(reader, piece, first, middle, result);
  read_numbers(reader, piece, middle, end, result);
}

void read_apart(const TableReader& reader, const AskedColumns& piece, FileColumns& result) {
  if (!piece.request.numbers.empty()) {
    read_numbers(reader, piece, 0, piece.columns.size(), result);
  } else if (!piece.request.time.column.empty()) {  // the column's name is usual for times, but its values are not
                                                    // valid times
    AskedColumns number;
    number.request.table = piece.request.table;
    number.add_number(piece.columns.front(), piece.request.time.column);
    read_numbers(reader, number, 0, 1, result);
  }
  const std::vector<FileColumn>& found = result.tables[piece.request.table];
  const auto unread = [&](std::size_t column) { return std::holds_alternative<std::monostate>(found[column]); };
  if (std::all_of(piece.columns.begin(), piece.columns.end(), unread))
    reader.read({piece.request}, nullptr);  // throws if no column can be read
}

}  // namespace

ColumnChoice choice_of(const std::string& file, const std::vector<TableInfo>& tables,
                       const std::vector<std::string>& chosen) {
  if (chosen.empty()) return [](const TableInfo&, const ColumnInfo&) { return true; };
  std::vector<std::string> all;
  for (const TableInfo& table : tables) {
    if (!table.name.empty()) all.push_back(table.name);
    for (const ColumnInfo& column : table.columns) all.push_back(column.name);
  }
  for (const std::string& name : chosen)
    if (std::find(all.begin(), all.end(), name) == all.end())
      column_position(file, all, name);  // throws if the name is unknown
  for (const TableInfo& table : tables)
    for (const auto& [name, count] : name_counts(table))
      if (count > 1 && std::find(chosen.begin(), chosen.end(), name) != chosen.end())
        column_position(file, column_names(table), name);  // throws if the name is unknown
  return [chosen](const TableInfo& table, const ColumnInfo& column) {
    const auto has = [&](const std::string& name) {
      return !name.empty() && std::find(chosen.begin(), chosen.end(), name) != chosen.end();
    };
    return has(column.name) || has(table.name);
  };
}

FileColumns read_columns(const TableReader& reader, const std::vector<TableInfo>& tables, const ColumnChoice& wanted) {
  FileColumns result;
  for (const TableInfo& table : tables) {
    result.tables.emplace_back(table.columns.size());
    for (const auto& [name, count] : name_counts(table))
      if (count > 1)
        result.notes.push_back(fmt::format("column \"{}\" is left out, because it occurs {} times", name, count));
  }
  result.alternation.resize(tables.size());
  const std::vector<AskedColumns> pieces = pieces_of(tables, wanted);
  if (try_read(reader, pieces, result)) return result;
  for (const AskedColumns& piece : pieces)
    if (!try_read(reader, {piece}, result)) read_apart(reader, piece, result);
  return result;
}

}  // namespace modebank
