#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "app/report/page/page_arrays.hpp"

namespace modebank::app::report {

/// Content of one page, without the parts that all pages share (web/page.html, page.css).
struct Page {
  std::string title;
  nlohmann::json data;      ///< input of the script; the script shows its texts only as text, never as markup
  PageArrays arrays;        ///< the large arrays of the data
  std::string_view script;  ///< an asset of assets.hpp
};

/// Escapes text for use between tags.
std::string escaped_html(std::string text);

/// Content Security Policy of a page with one of these scripts. It allows only the page's own scripts and style,
/// identified by hashes. Any access to the network is forbidden.
std::string page_policy(const std::vector<std::string_view>& scripts);

/// The HTML file. It is self-contained and loads nothing from outside.
std::string html_of(const Page& page);

}  // namespace modebank::app::report
