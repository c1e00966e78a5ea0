#include "io/csv/csv_text.hpp"

#include <algorithm>

#include "ident/base/utf8.hpp"
#include "io/table/number.hpp"

namespace modebank {

namespace {

constexpr std::string_view utf8_mark = "\xEF\xBB\xBF", low_first = "\xFF\xFE", high_first = "\xFE\xFF";

bool is_blank(char c) { return c == ' ' || c == '\t'; }

/// Whether a quote that follows this character opens a quoted field.
bool starts_field(char before) { return std::string_view(",;|\t \n\r").find(before) != std::string_view::npos; }

/// Converts UTF-16 to UTF-8. An unpaired surrogate becomes U+FFFD.
std::string from_utf16(std::string_view content) {
  bool low_byte_first = content.starts_with(low_first);
  if (low_byte_first || content.starts_with(high_first))
    content.remove_prefix(2);
  else
    low_byte_first = content.size() > 1 && content[1] == '\0';
  const auto unit = [&](std::size_t i) {
    const auto first = static_cast<unsigned char>(content[i]), second = static_cast<unsigned char>(content[i + 1]);
    return static_cast<std::uint32_t>(low_byte_first ? first | second << 8 : first << 8 | second);
  };
  std::string text;
  text.reserve(content.size() / 2);
  for (std::size_t i = 0; i + 1 < content.size(); i += 2) {
    const std::uint32_t code = unit(i);
    const bool high = code >= 0xD800 && code < 0xDC00, low = code >= 0xDC00 && code < 0xE000;
    const std::uint32_t next = high && i + 3 < content.size() ? unit(i + 2) : 0;
    if (high && next >= 0xDC00 && next < 0xE000) {
      append_utf8(text, 0x10000 + ((code - 0xD800) << 10) + (next - 0xDC00));
      i += 2;
    } else {
      append_utf8(text, high || low ? 0xFFFD : code);
    }
  }
  return text;
}

}  // namespace

bool is_utf16(std::string_view content) {
  if (content.starts_with(low_first) || content.starts_with(high_first)) return true;
  constexpr std::size_t looked_at = 64;
  const std::string_view first = content.substr(0, looked_at);
  std::size_t zeros[2] = {0, 0};
  for (std::size_t i = 0; i < first.size(); ++i) zeros[i % 2] += first[i] == '\0' ? 1 : 0;
  const std::size_t half = first.size() / 2;
  return half >= 2 && ((zeros[0] == 0 && zeros[1] == half) || (zeros[1] == 0 && zeros[0] >= half));
}

std::string_view as_utf8(std::string_view content, std::string& storage) {
  if (content.starts_with(utf8_mark)) content.remove_prefix(utf8_mark.size());
  if (!is_utf16(content)) return utf8_or_windows_1252(content, storage);
  storage = from_utf16(content);
  return storage;
}

std::string_view without_first_lines(std::string_view text, std::size_t lines) {
  for (; lines > 0 && !text.empty(); --lines) {
    const std::size_t end = text.find_first_of("\r\n");
    if (end == std::string_view::npos) return {};
    text.remove_prefix(text.substr(end).starts_with("\r\n") ? end + 2 : end + 1);
  }
  return text;
}

std::string_view without_empty_tail(std::string_view text, char separator) {
  const std::string empty = std::string(" \t\r\n") + separator;
  const std::size_t last = text.find_last_not_of(empty);
  if (last == std::string_view::npos) return text;
  return text.substr(0, std::min(text.find_first_of("\r\n", last), text.size()));
}

std::vector<TextRecord> first_records(std::string_view text, bool complete, std::size_t at_most) {
  std::vector<TextRecord> records;
  bool quoted = false;
  char before = '\n';
  std::uint64_t line = 1, started = 1;
  std::size_t start = 0;
  const auto finish = [&](std::size_t end) {
    const std::string_view record = without_blanks(text.substr(start, end - start));
    if (!record.empty()) records.push_back({text.substr(start, end - start), started});
    start = end + 1;
  };
  for (std::size_t i = 0; i < text.size() && records.size() < at_most; ++i) {
    const char c = text[i];
    if (before == '\n' && !quoted && is_comment(text.substr(i, 1))) i = std::min(text.find('\n', i), text.size()) - 1;
    if (c == '"') {
      if (quoted)
        quoted = false;  // a second quote continues the quoted field
      else
        quoted = starts_field(before) || before == '"';
    }
    const bool ends_line = c == '\n' || (c == '\r' && (i + 1 == text.size() || text[i + 1] != '\n'));
    if (ends_line) ++line;
    if (ends_line && !quoted) {
      finish(i);
      started = line;
    }
    before = text[i];
  }
  if (complete && records.size() < at_most && start < text.size()) finish(text.size());
  return records;
}

bool is_comment(std::string_view record) {
  const std::string_view text = without_blanks(record);
  return !text.empty() && (text.front() == '#' || text.front() == '%');
}

std::vector<std::string> fields_of(std::string_view record, char separator) {
  if (separator == '\t')  // a tab at the end is also a separator
    while (!record.empty() && (record.back() == '\r' || record.back() == '\n')) record.remove_suffix(1);
  else
    record = without_blanks(record);
  std::vector<std::string> fields(1);
  bool quoted = false, fresh = true;
  for (std::size_t i = 0; i < record.size() && fields.size() <= most_csv_columns; ++i) {
    const char c = record[i];
    if (c == '"' && (quoted || fresh)) {
      quoted = !quoted;
      fresh = !quoted;
    } else if (!quoted && (separator == ' ' ? is_blank(c) : c == separator)) {
      while (separator == ' ' && i + 1 < record.size() && is_blank(record[i + 1])) ++i;
      fields.emplace_back();
      fresh = true;
    } else {
      fields.back() += c;
      fresh = fresh && is_blank(c);
    }
  }
  for (std::string& field : fields) field = std::string(without_blanks(field));
  return fields;
}

PreparedText prepare_text(std::string_view text, bool blanks_separate, std::uint64_t first_line) {
  PreparedText result;
  result.text.reserve(text.size());
  std::uint64_t line = first_line;
  for (std::size_t start = 0; start < text.size(); ++line) {
    const std::size_t end = std::min(text.find('\n', start), text.size());
    std::string_view record = text.substr(start, end - start);
    if (is_comment(record)) {
      result.comment_lines.push_back(line);
    } else if (blanks_separate) {
      record = without_blanks(record);
      bool quoted = false;
      for (std::size_t i = 0; i < record.size(); ++i) {
        quoted = quoted != (record[i] == '"');
        if (quoted || !is_blank(record[i]))
          result.text += record[i];
        else if (!is_blank(record[i - 1]))
          result.text += blank_separator;
      }
    } else {
      result.text += record;
    }
    if (end < text.size()) result.text += '\n';
    start = end + 1;
  }
  return result;
}

}  // namespace modebank
