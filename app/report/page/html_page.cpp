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

/// JSON for a script element. "<" is escaped, so that no text can end the element or begin a comment. Bytes that are
/// not UTF-8 are replaced.
std::string json_in_script(const nlohmann::json& data) {
  std::string text = data.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  boost::replace_all(text, "<", "\\u003c");
  return text;
}

void append_arrays(const PageArrays& arrays, std::string& html) {
  for (std::size_t i = 0; i < arrays.stored().size(); ++i) {
    html += fmt::format("<script type=\"text/plain\" id=\"a{}\">", i);
    html += arrays.stored()[i];
    html += "</script>\n";
  }
}

/// The hash of an element as a source for the policy. It is converted from hexadecimal digits to base64.
std::string hash_source(std::string_view hex) {
  std::string bytes;
  for (std::size_t i = 0; i < hex.size(); i += 2)
    bytes += static_cast<char>(std::stoi(std::string(hex.substr(i, 2)), nullptr, 16));
  return fmt::format(" 'sha256-{}'", base64(bytes));
}

void append_part(std::string_view name, const Page& page, std::string& html) {
  if (name == "title")
    html += escaped_html(page.title);
  else if (name == "policy")
    html += page_policy({page.script});
  else if (name == "css")
    html += assets::page_css();
  else if (name == "data")
    html += json_in_script(page.data);
  else if (name == "arrays")
    append_arrays(page.arrays, html);
  else if (name == "script")
    html += page.script;
  else
    throw std::logic_error(fmt::format("page.html has a part {} without content", name));
}

}  // namespace

std::string page_policy(const std::vector<std::string_view>& scripts) {
  std::string runs;
  for (const std::string_view script : scripts) runs += hash_source(sha256_hex(script));
  // Scripts set style attributes on the elements that they create, so the policy allows style attributes.
  return fmt::format(
      "default-src 'none'; script-src{}; style-src{}; style-src-attr 'unsafe-inline'; img-src data: blob:", runs,
      hash_source(sha256_hex(assets::page_css())));
}

std::string html_of(const Page& page) {
  constexpr std::size_t tables = 4'000'000;
  std::string html;
  html.reserve(page.arrays.bytes() + page.script.size() + tables);
  std::string_view rest = assets::page_html();
  constexpr std::string_view open = "{{", close = "}}";
  for (auto at = rest.find(open); at != std::string_view::npos; at = rest.find(open)) {
    const auto end = rest.find(close, at);
    html += rest.substr(0, at);
    append_part(rest.substr(at + open.size(), end - at - open.size()), page, html);
    rest.remove_prefix(end + close.size());
  }
  return html += rest;
}

}  // namespace modebank::app::report
