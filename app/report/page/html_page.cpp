#include "app/report/page/html_page.hpp"

#include <fmt/format.h>

#include <boost/algorithm/string.hpp>
#include <stdexcept>

#include "app/report/page/assets.hpp"
#include "io/files/sha256.hpp"

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

/// As a policy names an element's text by its hash, whose digits are hexadecimal here.
std::string hash_source(std::string_view hex) {
  std::string bytes;
  for (std::size_t i = 0; i < hex.size(); i += 2)
    bytes += static_cast<char>(std::stoi(std::string(hex.substr(i, 2)), nullptr, 16));
  return fmt::format(" 'sha256-{}'", base64(bytes));
}

std::string part(std::string_view name, const Page& page) {
  if (name == "title") return escaped_html(page.title);
  if (name == "policy") return page_policy({page.script});
  if (name == "css") return std::string(assets::page_css());
  if (name == "data") return json_in_script(page.data);
  if (name == "arrays") return array_elements(page.arrays);
  if (name == "plotly") return std::string(assets::plotly_packed());
  if (name == "script") return std::string(page.script);
  throw std::logic_error(fmt::format("page.html has a part {} that nobody fills", name));
}

}  // namespace

std::string page_policy(const std::vector<std::string_view>& scripts) {
  constexpr std::size_t hash_digits = 64;  // what follows them is the file's name
  // Plotly is unpacked into an element of its own; where it draws by WebGL it makes functions of texts.
  std::string runs = hash_source(assets::plotly_sha256().substr(0, hash_digits)) + " 'unsafe-eval'";
  for (const std::string_view script : scripts) runs += hash_source(sha256_hex(script));
  // Plotly fills an element of style, empty at first, rule by rule; elements that are made by a script have attributes
  // of style.
  return fmt::format(
      "default-src 'none'; script-src{}; style-src{}{}; style-src-attr 'unsafe-inline'; img-src data: blob:; "
      "font-src data:; worker-src blob:",
      runs, hash_source(sha256_hex(assets::page_css())), hash_source(sha256_hex("")));
}

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
