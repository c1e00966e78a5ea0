#include "app/report/page/html_page.hpp"

#include <fmt/format.h>

#include <boost/algorithm/string.hpp>
#include <stdexcept>

#include "app/report/page/assets.hpp"

namespace modebank::app::report {

std::string escaped_html(std::string text) {
  boost::replace_all(text, "&", "&amp;");
  boost::replace_all(text, "<", "&lt;");
  boost::replace_all(text, ">", "&gt;");
  return text;
}

namespace {

/// JSON within a script element: no "<" in it can end or comment out the element. Bytes that are no UTF-8 are replaced.
std::string json_in_script(const nlohmann::json& data) {
  std::string text = data.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  boost::replace_all(text, "<", "\\u003c");
  return text;
}

std::string array_elements(const PageArrays& arrays) {
  std::string text;
  text.reserve(arrays.bytes() + 64 * arrays.stored().size());
  for (std::size_t i = 0; i < arrays.stored().size(); ++i)
    text += fmt::format("<script type=\"text/plain\" id=\"a{}\">{}</script>\n", i, arrays.stored()[i]);
  return text;
}

std::string part(std::string_view name, const Page& page) {
  if (name == "title") return escaped_html(page.title);
  if (name == "css") return std::string(assets::page_css());
  if (name == "data") return json_in_script(page.data);
  if (name == "arrays") return array_elements(page.arrays);
  if (name == "plotly") return std::string(assets::plotly_packed());
  if (name == "script") return std::string(page.script);
  throw std::logic_error(fmt::format("page.html has a part {} that nobody fills", name));
}

}  // namespace

std::string html_of(const Page& page) {
  std::string html;
  std::string_view rest = assets::page_html();
  constexpr std::string_view open = "{{", close = "}}";
  for (auto at = rest.find(open); at != std::string_view::npos; at = rest.find(open)) {
    const auto end = rest.find(close, at);
    html += rest.substr(0, at);
    html += part(rest.substr(at + open.size(), end - at - open.size()), page);
    rest.remove_prefix(end + close.size());
  }
  return html += rest;
}

}  // namespace modebank::app::report
