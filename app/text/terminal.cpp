#include "app/text/terminal.hpp"

#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <boost/algorithm/string.hpp>
#include <cstdlib>

namespace modebank::app {
namespace {

constexpr int label_width = 10;  // width of the labels at the start of the summary's lines

int stated_width() {
  const char* columns = std::getenv("COLUMNS");
  constexpr int widest = 10'000;  // limit of the width; a larger width would only add blanks
  return columns ? std::clamp(std::atoi(columns), 0, widest) : 0;
}

int terminal_width() {
  winsize size{};
  return isatty(STDOUT_FILENO) && ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0 ? size.ws_col : 0;
}

/// Indentation of continuation lines. It is the width of the label ("windows ", or a word and two or more spaces).
/// Without a label, it is the indentation of the line itself.
std::string indentation_of(const std::string& line, int width) {
  std::size_t indent = std::min(line.find_first_not_of(' '), line.size());
  if (indent == 0 && line.size() > label_width) {
    const std::size_t gap = line.find(' ');
    if (line[label_width - 1] == ' ' && line[label_width] != ' ' && gap < label_width)
      indent = label_width;
    else if (gap < 2 * label_width && line[gap + 1] == ' ')
      indent = std::min(line.find_first_not_of(' ', gap), line.size());
  }
  return std::string(indent < static_cast<std::size_t>(width) / 2 ? indent : 0, ' ');
}

std::string wrapped_line(const std::string& line, int width) {
  const std::string indent = indentation_of(line, width);
  std::string text, rest = line;
  while (columns_of(rest) > width) {
    std::size_t bytes = 0, last_space = 0;
    const std::size_t first =
        std::min(rest.find_first_not_of(' ', indent.size()), rest.size());  // a line is not broken within its label
    for (int column = 0; bytes < rest.size(); ++bytes) {
      if ((static_cast<unsigned char>(rest[bytes]) & 0xC0) != 0x80 && column++ > width) break;
      if (rest[bytes] == ' ' && bytes > first) {
        if (last_space > 0 && column > width + 1) break;
        last_space = bytes;
      }
    }
    if (last_space == 0) last_space = rest.find(' ', first);
    if (last_space == std::string::npos) break;
    const std::size_t next = rest.find_first_not_of(' ', last_space);
    if (next == std::string::npos) break;
    text += boost::trim_right_copy(rest.substr(0, last_space)) + "\n";
    rest = indent + rest.substr(next);
  }
  return text + rest;
}

}  // namespace

Terminal standard_output() {
  const int stated = stated_width();
  return {stated > 0 ? stated : terminal_width()};
}

int columns_of(std::string_view text) {
  return static_cast<int>(
      std::count_if(text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xC0) != 0x80; }));
}

std::string first_columns(std::string_view text, int columns) {
  std::string result;
  for (const char c : text) {
    if ((static_cast<unsigned char>(c) & 0xC0) != 0x80 && columns-- == 0) break;
    result += c;
  }
  return result;
}

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  for (std::size_t begin = 0;;) {
    const std::size_t end = text.find('\n', begin);
    lines.push_back(text.substr(begin, end - begin));
    if (end == std::string::npos) return lines;
    begin = end + 1;
  }
}

std::string wrapped(const std::string& text, int width) {
  if (width <= 0) return text;
  std::string result;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    result += wrapped_line(text.substr(begin, end - begin), width);
    if (end < text.size()) result += "\n";
    begin = end + 1;
  }
  return result;
}

}  // namespace modebank::app
