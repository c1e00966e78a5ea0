#include "io/recording/recording_reader.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "ident/base/printable.hpp"
#include "io/recording/alternating_frames.hpp"
#include "io/table/number.hpp"
#include "io/table/stamp_column.hpp"
#include "modebank/base/error.hpp"

namespace modebank {

namespace {

using Form = LogWant::Form;

std::string type_name(MessageColumn::Form form) {
  return form == MessageColumn::Form::time ? "time" : form == MessageColumn::Form::text ? "text" : "number";
}

/// The order of columns: numbers, then texts, then stamps and their nanoseconds.
LogRequest log_request(const TableRequest& request) {
  LogRequest wanted{request.table, {}};
  for (const std::string& number : request.numbers) wanted.columns.push_back({number, Form::number});
  for (const std::string& text : request.texts) wanted.columns.push_back({text, Form::text});
  if (!request.time.column.empty()) wanted.columns.push_back({request.time.column, Form::exact});
  if (!request.time.second.empty()) wanted.columns.push_back({request.time.second, Form::exact});
  return wanted;
}

/// Columns that show whether all rows of a request belong to the same motion. Empty if data.run already separates
/// motions.
std::vector<std::string> looked_at_frames(const LogTopic& topic, const TableRequest& request) {
  std::vector<std::string> columns = frame_columns(topic);
  const bool told_apart = std::any_of(columns.begin(), columns.end(), [&](const std::string& column) {
    return std::find(request.texts.begin(), request.texts.end(), column) != request.texts.end();
  });
  if (told_apart || request.numbers.empty()) columns.clear();
  return columns;
}

const std::filesystem::path& checked(const std::filesystem::path& definitions) {
  std::error_code error;
  if (!definitions.empty() && !std::filesystem::is_directory(definitions, error))
    throw ConfigurationError(fmt::format("data.definitions: {} is not a folder", definitions.string()));
  return definitions;
}

[[noreturn]] void fail(const std::string& file, std::uint64_t message, const std::string& column,
                       const std::string& why) {
  throw DataError(fmt::format("{}:{}: column {}: {}", file, message, column, why));
}

/// Values that are not numbers become NaN if they may be missing; otherwise they are errors.
void check_numbers(const std::string& file, const TableRequest& request, Table& table) {
  for (std::size_t i = 0; i < table.numbers.size(); ++i) {
    const bool may_miss = !request.may_miss.empty() && request.may_miss[i];
    for (std::size_t k = 0; k < table.numbers[i].size(); ++k) {
      double& value = table.numbers[i][k];
      if (std::isfinite(value)) continue;
      if (!may_miss) fail(file, table.line[k], request.numbers[i], "missing value");
      value = std::numeric_limits<double>::quiet_NaN();
    }
  }
}

/// Stamps are exact. Other columns of times have the unit TimeRequest::unit. If that is automatic, the unit is found in
/// the same way as for any file.
void set_times(const std::string& file, const TimeRequest& request, bool is_stamp, LogColumn& column,
               const LogColumn* second, Table& table) {
  if (!request.may_miss) {
    const bool none =
        std::find(column.exact.begin(), column.exact.end(), no_exact_value) != column.exact.end() ||
        std::any_of(column.numbers.begin(), column.numbers.end(), [](double v) { return !std::isfinite(v); });
    if (none) throw DataError(fmt::format("{}: column {}: missing value", file, request.column));
  }
  if (is_stamp) {
    table.time_ns = std::move(column.exact);
    return;
  }
  StampColumn stamps(request, "");
  stamps.reserve(table.rows());
  const auto text = [](const LogColumn& of, std::size_t k) {
    return of.exact.empty() ? fmt::format("{}", of.numbers[k]) : fmt::to_string(of.exact[k]);
  };
  for (std::size_t k = 0; k < table.rows(); ++k) {
    const bool none = column.numbers.empty() && column.exact[k] == no_exact_value;
    const NumberStatus status = none                      ? NumberStatus::missing
                                : second != nullptr       ? stamps.add(text(column, k), text(*second, k))
                                : !column.numbers.empty() ? stamps.add(column.numbers[k])
                                                          : stamps.add(column.exact[k]);
    if (status == NumberStatus::missing)
      stamps.add_missing();
    else if (status != NumberStatus::ok)
      fail(file, table.line[k], request.column, stamps.complaint(status, text(column, k)));
  }
  stamps.finish(file, table);
}

/// Lines of Python that read Protobuf messages into a data frame. docs/howto/formats.md contains the same lines.
std::string protobuf_lines(const std::string& path) {
  return fmt::format(R"( (topics and columns are examples):
from mcap.reader import make_reader
from mcap_protobuf.decoder import DecoderFactory
import pandas, modebank
messages = make_reader(open("{}", "rb"), decoder_factories=[DecoderFactory()]).iter_decoded_messages(topics=["/motion"])
frame = pandas.DataFrame([{{"time": m.log_time / 1e9, "wz": p.wz, "left": p.left, "right": p.right}} for _, _, m, p in messages])
archive = modebank.run({{"drive": frame}}, state="wz", input=["left", "right"], time="time", **{{"data.split": "blocks 10"}}))",
                     path);
}

}  // namespace

RecordingReader::RecordingReader(const std::vector<std::filesystem::path>& files,
                                 const std::filesystem::path& definitions)
    : path_(files.front()), log_(files, KnownDefinitions(checked(definitions))) {}

std::vector<TableInfo> RecordingReader::tables() const {
  std::vector<TableInfo> tables;
  for (const LogTopic& topic : log_.topics()) {
    TableInfo& table = tables.emplace_back(TableInfo{topic.name, topic.type, {}, topic.messages});
    for (const MessageColumn& column : topic.columns)
      table.columns.push_back({column.path, "", type_name(column.form)});
  }
  return tables;
}

std::string RecordingReader::why_without(const std::string& column) const {
  for (const LogTopic& topic : log_.topics())
    if (!topic.problem.empty() && column.starts_with(topic.name + "."))
      return fmt::format("topic {} ({}) cannot be read: {} (name a folder with .msg files in data.definitions)",
                         topic.name, topic.type, topic.problem);
  return {};
}

std::vector<std::string> RecordingReader::left_out() const {
  std::vector<std::string> topics;
  std::string problem;
  bool protobuf = false;
  for (const LogTopic& topic : log_.topics()) {
    if (topic.problem.empty()) continue;
    topics.push_back(fmt::format("{} ({})", topic.name, topic.type));
    if (problem.empty()) problem = topic.problem;
    protobuf = protobuf || topic.problem.find("\"protobuf\"") != std::string::npos;
  }
  if (topics.empty()) return {};
  return {fmt::format("left out: {} cannot be read: {}{}", fmt::join(topics, ", "), problem,
                      protobuf ? protobuf_lines(path_.string()) : "")};
}

InputFile RecordingReader::described(const UsedMessages& used) const {
  InputFile file{printable_name(std::filesystem::absolute(path_).string()), 0, used.hex()};
  for (const std::filesystem::path& part : log_.files()) file.bytes += std::filesystem::file_size(part);
  return file;
}

InputFile RecordingReader::describe(const std::vector<TableRequest>& requests) const {
  std::vector<LogRequest> topics;
  for (const TableRequest& request : requests) topics.push_back({request.table, {}});
  std::vector<std::string> notes;
  UsedMessages used;
  log_.read(topics, notes, &used);
  return described(used);
}

std::vector<Table> RecordingReader::read(const std::vector<TableRequest>& requests, InputFile* file) const {
  std::vector<LogRequest> wanted;
  std::vector<std::vector<std::string>> frames;
  for (const TableRequest& request : requests) {
    wanted.push_back(log_request(request));
    frames.push_back(looked_at_frames(log_.topics()[request.table], request));
    for (const std::string& column : frames.back()) wanted.back().columns.push_back({column, Form::text});
  }
  std::vector<std::string> notes = log_.notes();
  UsedMessages used;
  std::vector<LogRows> rows = log_.read(wanted, notes, file == nullptr ? nullptr : &used);
  if (file != nullptr) *file = described(used);
  std::vector<Table> tables;
  for (std::size_t r = 0; r < requests.size(); ++r) {
    const TableRequest& request = requests[r];
    Table& table = tables.emplace_back();
    const LogTopic& topic = log_.topics()[request.table];
    for (std::size_t i = 0; i < frames[r].size() && table.alternation.empty(); ++i)
      table.alternation =
          alternation_text(topic, frames[r][i], rows[r].columns[rows[r].columns.size() - frames[r].size() + i].text);
    table.line = std::move(rows[r].message);
    auto column = rows[r].columns.begin();
    for (std::size_t i = 0; i < request.numbers.size(); ++i) table.numbers.push_back(std::move((column++)->numbers));
    check_numbers(path_.string(), request, table);
    for (std::size_t i = 0; i < request.texts.size(); ++i) {
      table.texts.push_back(std::move((column++)->text));
      for (std::string& text : table.texts.back()) text = std::string(without_blanks(text));
    }
    if (request.time.column.empty()) continue;
    LogColumn& time = *column++;
    const auto& known = log_.topics()[request.table].columns;
    const bool is_stamp = std::any_of(known.begin(), known.end(), [&](const MessageColumn& c) {
      return c.path == request.time.column && c.form == MessageColumn::Form::time;
    });
    set_times(path_.string(), request.time, is_stamp, time, request.time.second.empty() ? nullptr : &*column, table);
  }
  if (!tables.empty()) tables.front().notes.insert(tables.front().notes.begin(), notes.begin(), notes.end());
  return tables;
}

}  // namespace modebank
