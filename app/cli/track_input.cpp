#include "app/cli/track_input.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <boost/algorithm/string/trim.hpp>
#include <cmath>
#include <nlohmann/json.hpp>

#include "filter/step/equations/bounds.hpp"
#include "ident/base/not_a_number.hpp"
#include "ident/base/utf8.hpp"
#include "io/import/csv.hpp"
#include "io/table/number.hpp"
#include "modebank/base/error.hpp"

namespace modebank::app {

namespace {

std::string_view trimmed(std::string_view text) {
  const auto blank = [](char c) { return c == ' ' || c == '\t' || c == '\r'; };
  while (!text.empty() && blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && blank(text.back())) text.remove_suffix(1);
  if (text.size() > 1 && text.front() == '"' && text.back() == '"') text = text.substr(1, text.size() - 2);
  return text;
}

/// Where a field that begins at `start` ends: at a comma that is not within quotes.
std::size_t end_of_field(std::string_view line, std::size_t start) {
  const std::size_t first = line.find_first_not_of(" \t", start);
  if (first == std::string_view::npos || line[first] != '"') return line.find(',', start);
  std::size_t quote = line.find('"', first + 1);
  while (quote != std::string_view::npos && quote + 1 < line.size() && line[quote + 1] == '"')
    quote = line.find('"', quote + 2);
  return line.find(',', quote == std::string_view::npos ? start : quote);  // quotes that nobody closed are text
}

/// Of a quoted name the quotes inside, which are written twice.
std::string unquoted(std::string_view field) {
  std::string name(field);
  for (std::size_t k = name.find("\"\""); k != std::string::npos; k = name.find("\"\"", k + 1)) name.erase(k, 1);
  return name;
}

/// Calls visit(position, field) for every field of a CSV line; returns how many there were.
template <class Visit>
std::size_t for_each_field(std::string_view line, Visit visit) {
  std::size_t position = 0;
  for (std::size_t start = 0;; ++position) {
    const std::size_t comma = end_of_field(line, start);
    visit(position, trimmed(line.substr(start, comma == std::string_view::npos ? comma : comma - start)));
    if (comma == std::string_view::npos) return position + 1;
    start = comma + 1;
  }
}

/// What many writers of JSON call numbers that JSON has no name for, outside strings, made null.
std::string without_bare_nan(std::string_view line) {
  std::string result;
  bool quoted = false;
  for (std::size_t k = 0; k < line.size();) {
    const std::string_view rest = line.substr(k);
    std::size_t word = 0;
    for (const std::string_view name : {"NaN", "nan", "-Infinity", "Infinity"})
      if (word == 0 && !quoted && rest.starts_with(name)) word = name.size();
    if (word > 0) {
      result += "null";
      k += word;
      continue;
    }
    if (line[k] == '"' && (k == 0 || line[k - 1] != '\\')) quoted = !quoted;
    result += line[k++];
  }
  return result;
}

nlohmann::json parse_object(std::string_view line) {
  nlohmann::json object = nlohmann::json::parse(line, nullptr, false);
  return object.is_discarded() ? nlohmann::json::parse(without_bare_nan(line), nullptr, false) : object;
}

}  // namespace

SampleReader::SampleReader(SampleColumns columns, LineFormat format) : columns_(std::move(columns)), format_(format) {
  sample_.input.setZero(std::ssize(columns_.inputs));
  sample_.measurement.setConstant(std::ssize(columns_.states), not_a_number);
  next_ = sample_;
}

void SampleReader::remember(const Eigen::VectorXd& input) {
  sample_.input = input;
  any_input_ = true;
}

double& SampleReader::slot(std::size_t i) {
  if (i == 0) return next_.time_s;
  if (i <= columns_.inputs.size()) return next_.input(static_cast<Eigen::Index>(i - 1));
  return next_.measurement(static_cast<Eigen::Index>(i - 1 - columns_.inputs.size()));
}

const std::string& SampleReader::name(std::size_t i) const {
  if (i == 0) return columns_.time;
  return i <= columns_.inputs.size() ? columns_.inputs[i - 1] : columns_.states[i - 1 - columns_.inputs.size()];
}

SampleReader::Line SampleReader::malformed(std::string reason) {
  reason_ = std::move(reason);
  return Line::malformed;
}

SampleReader::Line SampleReader::read(std::string_view line) {
  std::string utf8;
  line = utf8_or_windows_1252(line, utf8);
  if (format_ == LineFormat::automatic || positions_.empty())
    if (line.substr(0, 3) == "\xEF\xBB\xBF") line.remove_prefix(3);  // a byte order mark
  const std::string_view content = trimmed(line);
  if (content.empty()) return Line::blank;
  if (format_ == LineFormat::automatic) format_ = content.front() == '{' ? LineFormat::ndjson : LineFormat::csv;
  if (format_ == LineFormat::csv && positions_.empty()) return read_header(line);
  if (!(format_ == LineFormat::csv ? read_csv(line) : read_json(content))) return Line::malformed;
  return accept();
}

SampleReader::Line SampleReader::read_header(std::string_view line) {
  std::vector<std::string> names;
  fields_ = for_each_field(line, [&](std::size_t, std::string_view field) { names.push_back(unquoted(field)); });
  std::vector<std::size_t> positions;
  for (std::size_t i = 0; i < slots(); ++i) positions.push_back(column_position("standard input", names, name(i)));
  positions_ = std::move(positions);
  return Line::header;
}

bool SampleReader::read_csv(std::string_view line) {
  std::size_t bad = slots();
  const std::size_t fields = for_each_field(line, [&](std::size_t position, std::string_view field) {
    for (std::size_t i = 0; i < positions_.size(); ++i) {
      if (positions_[i] != position) continue;
      const ParsedNumber number = modebank::parse_number(field);
      slot(i) = number.status == NumberStatus::ok ? number.value : not_a_number;
      if (number.status == NumberStatus::text || number.status == NumberStatus::out_of_range) bad = i;
    }
  });
  if (fields != fields_) return malformed(fmt::format("{} fields, the header has {}", fields, fields_)), false;
  if (bad < slots()) return malformed(fmt::format("{} is not a number", name(bad))), false;
  return true;
}

bool SampleReader::read_json(std::string_view line) {
  const nlohmann::json object = parse_object(line);
  if (!object.is_object()) return malformed("not a JSON object"), false;
  for (std::size_t i = 0; i < slots(); ++i) {
    const auto member = object.find(name(i));
    const bool missing = member == object.end() || member->is_null();
    const bool truth = !missing && member->is_boolean();  // 1 and 0, as in text
    if (!missing && !truth && !member->is_number()) return malformed(fmt::format("{} is not a number", name(i))), false;
    slot(i) = missing ? not_a_number : truth ? static_cast<double>(member->get<bool>()) : member->get<double>();
  }
  return true;
}

void SampleReader::leave_out(double& value, const std::string& name, const char* instead) {
  if (!std::isfinite(value) || !is_missing(value)) return;
  remarks_.push_back(fmt::format("{} = {} is beyond {:g}, and {}", name, value, largest_measurement, instead));
  value = not_a_number;
}

/// A missing input is the last known one, as the command that still acts.
SampleReader::Line SampleReader::accept() {
  remarks_.clear();
  for (std::size_t i = 1; i < slots(); ++i)
    leave_out(slot(i), name(i), i <= columns_.inputs.size() ? "the last known one still acts" : "taken as missing");
  if (!std::isfinite(next_.time_s)) return malformed(fmt::format("{} is missing", columns_.time));
  for (Eigen::Index i = 0; i < next_.input.size(); ++i) {
    if (std::isfinite(next_.input(i))) continue;
    if (!any_input_)
      return malformed(
          fmt::format("{} is missing, and no earlier one is known", columns_.inputs[static_cast<std::size_t>(i)]));
    next_.input(i) = sample_.input(i);
  }
  any_input_ = true;
  std::swap(sample_, next_);
  return Line::sample;
}

}  // namespace modebank::app
