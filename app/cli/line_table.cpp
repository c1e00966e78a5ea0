#include "app/cli/line_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "ident/base/not_a_number.hpp"
#include "ident/base/utf8.hpp"
#include "io/csv/csv.hpp"
#include "io/csv/csv_dialect.hpp"
#include "io/csv/csv_text.hpp"
#include "io/table/memory_table.hpp"
#include "io/table/name_unit.hpp"
#include "io/table/number.hpp"
#include "modebank/base/error.hpp"

namespace modebank::app {
namespace {

constexpr const char* stream_name = "standard input";

bool holds(const std::vector<std::string>& all, const std::string& one) {
  return std::find(all.begin(), all.end(), one) != all.end();
}

/// Options for a single stream with all columns. There are no files, runs or roles. Every value may be missing.
DataOptions of_a_stream(DataOptions data) {
  for (std::string* text : {&data.inputs, &data.states, &data.run, &data.label}) text->clear();
  for (std::vector<std::string>* names : {&data.truth, &data.train, &data.test}) names->clear();
  data.split = {};
  data.join = Join::time;
  data.lag_auto = false;
  data.missing = Missing::predict;
  data.format.skip_rows = 0;
  data.format.skip_automatic = false;
  return data;
}

/// Removes the formula of each derived channel that the stream has as a column.
void derive_what_lacks(DataOptions& data, const std::vector<std::string>& columns) {
  std::erase_if(data.derive, [&](const std::string& line) { return holds(columns, parse_derived(line).name); });
}

ColumnInfo column_of(const std::string& name) { return {name, std::string(split_unit(name).unit), {}}; }

/// Adds the columns from which channels are read or computed.
void add_columns(const DerivedChannels& derived, const std::vector<std::string>& channels,
                 std::vector<std::string>& columns) {
  for (const std::string& channel : channels)
    if (const DerivedChannel* const computed = derived.find(channel); computed != nullptr)
      add_columns(derived, computed->expression.channels(), columns);
    else if (!holds(columns, channel))
      columns.push_back(channel);
}

/// Replaces NaN and infinities outside strings by null.
std::string without_bare_nan(std::string_view line) {
  std::string result;
  bool quoted = false;
  for (std::size_t k = 0; k < line.size();) {
    std::size_t word = 0;
    for (const std::string_view name : {"NaN", "nan", "-Infinity", "Infinity"})
      if (word == 0 && !quoted && line.substr(k).starts_with(name)) word = name.size();
    if (word > 0) result += "null";
    k += word;
    if (word > 0) continue;
    if (line[k] == '"') quoted = !quoted;
    if (quoted && line[k] == '\\' && k + 1 < line.size()) result += line[k++];  // the next character is escaped
    result += line[k++];
  }
  return result;
}

/// Parses a line of NDJSON. The result is_discarded() for other text. Many programs write NaN and Infinity; these
/// become null.
nlohmann::json parse_json_line(std::string_view line) {
  std::string storage;
  line = utf8_or_windows_1252(line, storage);
  nlohmann::json object = nlohmann::json::parse(line, nullptr, false);
  return object.is_discarded() ? nlohmann::json::parse(without_bare_nan(line), nullptr, false) : object;
}

/// The member of an object as text, as in a field of a CSV file. Empty if the member is null or missing.
std::string json_field(const nlohmann::json& object, const std::string& name) {
  const auto member = object.find(name);
  if (member == object.end() || member->is_null()) return {};
  if (member->is_number()) return member->dump();
  if (member->is_boolean()) return member->get<bool>() ? "1" : "0";
  if (member->is_string()) return member->get<std::string>();
  throw DataError(fmt::format("{} is not a number", name));
}

nlohmann::json object_of(const std::string& line) {
  nlohmann::json object = parse_json_line(line);
  if (!object.is_object()) throw DataError("not a JSON object");
  return object;
}

}  // namespace

LineTable::LineTable(const DataOptions& data) : data_(of_a_stream(data)) {}

bool LineTable::open(const std::string& line) {
  if (format_ == Format::unknown) format_ = without_blanks(line).starts_with('{') ? Format::objects : Format::csv;
  if (format_ == Format::objects) {
    open_json(line);
    return true;
  }
  head_ += line + "\n";
  if (is_comment(line)) return false;
  open_csv();
  after_header_ = !starts_with_a_row();
  if (!after_header_) head_.resize(head_.size() - line.size() - 1);
  if (head_.empty()) data_.format.header = HeaderRow::no;
  return !after_header_;
}

/// Reads a stream in the archive's CSV format. The format of any other stream is detected.
void LineTable::open_csv() {
  FormatOptions& format = data_.format;
  try {
    return plan_for(csv_columns(stream_name, head_, format));
  } catch (const ConfigurationError&) {
    if (format.separator == Separator::automatic && format.header == HeaderRow::automatic) throw;
  }
  format.separator = Separator::automatic;
  format.decimal = DecimalMark::automatic;
  format.header = HeaderRow::automatic;
  plan_for(csv_columns(stream_name, head_, format));
}

bool LineTable::starts_with_a_row() const {
  try {
    return rows_of({}, data_.time_unit).rows() > 0;
  } catch (const DataError&) {
    return true;  // a missing value throws, but the line is still a row of numbers
  }
}

void LineTable::open_json(const std::string& line) {
  std::vector<std::string> members;
  const nlohmann::json object = object_of(line);
  for (const auto& [member, value] : object.items()) members.push_back(member);
  derive_what_lacks(data_, members);
  if (data_.time.empty() && holds(members, "time")) data_.time = {"time"};
  const DerivedChannels derived(data_);
  std::vector<std::string> columns = data_.time;
  for (const std::vector<std::string>* channels : {&data_.state, &data_.input})
    add_columns(derived, *channels, columns);
  if (derived.where() != nullptr) add_columns(derived, derived.where()->expression.channels(), columns);
  TableInfo table;
  for (const std::string& column : columns) table.columns.push_back(column_of(column));
  plan_for(table);
}

void LineTable::plan_for(const TableInfo& table) {
  columns_ = column_names(table);
  DataOptions data = data_;
  derive_what_lacks(data, columns_);
  if (data.time.empty() && holds(columns_, "time")) data.time = {"time"};
  if (!data.where.empty()) {
    std::vector<std::string> operands;
    const DerivedChannels derived(data);
    add_columns(derived, derived.where()->expression.channels(), operands);
    if (!std::all_of(operands.begin(), operands.end(), [&](const auto& operand) { return holds(columns_, operand); })) {
      notes_.push_back(fmt::format("data.where = {} names a column that {} lacks, so every sample is used", data.where,
                                   stream_name));
      data.where.clear();
    }
  }
  std::vector<MemoryColumn> columns;  // without rows
  for (const ColumnInfo& column : table.columns) columns.push_back({column, std::vector<std::string>()});
  const MemoryTables stream{{stream_name, {std::make_shared<MemoryTable>(stream_name, std::move(columns))}}};
  plan_ = std::move(plan_import(data, &stream).front());
  SourcePlan& source = plan_->sources.front();
  source.request.may_miss.assign(source.request.numbers.size(), true);
  source.request.time.may_miss = true;
  memory_.resize(source.derived.size());
}

Table LineTable::rows_of(std::span<const std::string> lines, TimeUnit unit) const {
  const SourcePlan& source = plan_->sources.front();
  TableRequest request = columns_to_read(source.request, source.derived);
  request.time.unit = unit;
  if (format_ == Format::objects) return json_rows(lines, request);
  std::string text = head_;
  for (const std::string& line : lines) {
    text += line;
    if (std::count(line.begin(), line.end(), '"') % 2 != 0) text += '"';  // ends an unclosed quote
    text += '\n';
  }
  return parse_csv(stream_name, text, request, data_.format);
}

Table LineTable::json_rows(std::span<const std::string> lines, const TableRequest& request) const {
  std::vector<std::vector<std::string>> texts(columns_.size());
  for (const std::string& line : lines) {
    const nlohmann::json object = object_of(line);
    for (std::size_t i = 0; i < columns_.size(); ++i) texts[i].push_back(json_field(object, columns_[i]));
  }
  std::vector<MemoryColumn> columns;
  for (std::size_t i = 0; i < columns_.size(); ++i) columns.push_back({column_of(columns_[i]), std::move(texts[i])});
  return std::move(MemoryTable(stream_name, std::move(columns)).read({request}, nullptr).front());
}

std::vector<std::string> LineTable::fields_in(const std::string& line) const {
  const CsvDialect dialect = find_dialect(head_ + first_row_ + "\n", true, data_.format);
  return fields_of(line, dialect.separator == Separator::blank ? ' ' : dialect.delimiter());
}

/// If the line after the header has a text in each column and no number, takes it as the row of units.
bool LineTable::take_units(const std::string& line) {
  if (!std::exchange(after_header_, false)) return false;
  const std::vector<std::string> fields = fields_in(line);
  const bool has_number = std::any_of(fields.begin(), fields.end(), [](const std::string& field) {
    return parse_number(field).status == NumberStatus::ok;
  });
  if (fields.size() != columns_.size() || has_number) return false;
  head_ += line + "\n";
  return true;
}

Table LineTable::read(std::span<const std::string> lines) {
  const bool begun = has_rows(), context = begun && format_ == Format::csv;
  std::vector<std::string> all;
  if (context) all.push_back(first_row_);
  all.insert(all.end(), lines.begin(), lines.end());
  Table table;
  try {
    table = rows_of(all, data_.time_unit);
    if (table.rows() != all.size()) throw DataError("not a row of the table");
  } catch (const DataError&) {
    if (take_units(lines.front())) return {};
    throw;
  }
  after_header_ = false;
  if (format_ == Format::objects && !std::all_of(lines.begin(), lines.end(), is_utf8))
    notes_.emplace_back(read_as_windows_1252);
  if (!begun) begin(lines.front(), table);
  if (begun && !unit_known_) learn_unit(lines, table);
  std::move(table.notes.begin(), table.notes.end(), std::back_inserter(notes_));
  if (context) {
    const auto drop_first = [](auto& values) {
      if (!values.empty()) values.erase(values.begin());
    };
    for (auto& column : table.numbers) drop_first(column);
    drop_first(table.line);
    drop_first(table.time_ns);
    drop_first(table.time_s);
  }
  rows_before_ = rows_;
  rows_ += table.rows();
  if (table.form.clock) pass_midnights(table);
  derive(table);
  return table;
}

/// The first row determines the separator of all rows.
void LineTable::begin(const std::string& line, const Table& table) {
  first_row_ = line;
  first_s_ = time_s(table, 0);
  unit_known_ = !has_times() || data_.time_unit != TimeUnit::automatic;
  if (format_ == Format::csv) data_.format.separator = find_dialect(head_ + line + "\n", true, data_.format).separator;
}

/// Finds the unit of times from the first two rows. This unit applies to all later rows.
void LineTable::learn_unit(std::span<const std::string> lines, const Table& table) {
  std::vector<std::string> all{first_row_};
  all.insert(all.end(), lines.begin(), lines.end());
  const std::vector<std::int64_t> found =
      table.rows() == all.size() ? table.time_ns : rows_of(all, TimeUnit::automatic).time_ns;
  for (const std::string_view word : EnumNames<TimeUnit>::values) {
    const TimeUnit unit = *parse_name<TimeUnit>(word);
    if (unit == TimeUnit::automatic || rows_of(all, unit).time_ns != found) continue;
    data_.time_unit = unit;
    break;
  }
  unit_known_ = true;
  const double first_s = time_s(rows_of({&first_row_, 1}, data_.time_unit), 0);
  if (first_s != first_s_) corrected_first_s_ = first_s;
}

double LineTable::time_s(const Table& table, std::size_t row) const {
  constexpr double ns_per_s = 1e9;
  if (!has_times()) return static_cast<double>(rows_before_ + row) / data_.rate_hz;
  if (table.time_ns[row] == missing_stamp) return not_a_number;
  return table.time_s.empty() ? static_cast<double>(table.time_ns[row]) / ns_per_s : table.time_s[row];
}

double LineTable::rest_s(const Table& table, std::size_t row) const {
  const double seconds = time_s(table, row);
  if (!has_times() || !std::isfinite(seconds)) return 0.0;
  const double whole = std::floor(seconds);
  return static_cast<double>(table.time_ns[row] - static_cast<std::int64_t>(whole) * billion) / 1e9 - (seconds - whole);
}

/// Adds the days before this batch: the reader counts days from its first row.
void LineTable::pass_midnights(Table& table) {
  for (std::int64_t& time_ns : table.time_ns)
    if (time_ns != missing_stamp) time_ns = days_.on(time_ns / billion) * billion + time_ns % billion;
}

void LineTable::derive(Table& table) {
  const SourcePlan& source = plan_->sources.front();
  if (source.derived.empty()) return;
  if (!origin_ns_ && !table.time_ns.empty()) origin_ns_ = table.time_ns.front();
  std::vector<double> seconds;  // relative to the first row; a double of nanoseconds since 1970 would lose precision
  for (std::size_t row = 0; row < table.rows(); ++row)
    seconds.push_back(!has_times() || table.time_ns[row] == missing_stamp
                          ? time_s(table, row)
                          : static_cast<double>(table.time_ns[row] - *origin_ns_) / 1e9);
  for (std::size_t i = 0; i < source.derived.size(); ++i) {
    const DerivedColumn& column = source.derived[i];
    std::vector<std::span<const double>> operands;
    for (const std::size_t operand : column.operands) operands.emplace_back(table.numbers[operand]);
    std::vector<double> values = column.channel->expression.evaluate(operands, seconds, &memory_[i]);
    table.numbers.insert(table.numbers.begin() + static_cast<std::ptrdiff_t>(column.position), std::move(values));
  }
}

bool LineTable::is_whole(const std::string& line) const {
  if (format_ == Format::objects) return parse_json_line(line).is_object();
  return fields_in(line).size() == columns_.size();
}

}  // namespace modebank::app
