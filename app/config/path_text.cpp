#include "app/config/path_text.hpp"

#include <fmt/format.h>

#include <boost/algorithm/string/trim.hpp>

#include "ident/base/printable.hpp"

namespace modebank::app {

std::string path_text(const std::string& path) {
  const std::string shown = printable_name(path);
  if (shown == path && boost::trim_copy(path) == path && path.find('#') == std::string::npos && !path.starts_with('"'))
    return path;
  std::string text = "\"";
  for (std::size_t i = 0; i < path.size(); ++i) {
    const char c = path[i];
    constexpr char second_set = '\xc2';  // first UTF-8 byte of those control characters that have two bytes
    if (is_control(c) || c == second_set || (i > 0 && path[i - 1] == second_set))
      text += fmt::format("\\x{:02x}", static_cast<unsigned char>(c));
    else
      text += (c == '"' || c == '\\' ? "\\" : "") + std::string(1, c);
  }
  return text + "\"";
}

}  // namespace modebank::app
