#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "app/report/page/page_arrays.hpp"

namespace modebank::app::report {

/// Content of one page. All pages share the other parts (web/page.html, page.css).
struct Page {
  std::string title;
  nlohmann::json data;      ///< input of the script, which shows texts of the data never as markup
  PageArrays arrays;        ///< large arrays of the data
  std::string_view script;  ///< one of the scripts in assets.hpp
};

/// Escapes text for use between tags.
std::string escaped_html(std::string text);

/// Content Security Policy of a page with one of these scripts. It allows only the page's own scripts and style, which
/// are identified by hashes. It forbids all access to the network.
std::string page_policy(const std::vector<std::string_view>& scripts);

/// The HTML file. It contains everything that it needs, and loads nothing.
std::string html_of(const Page& page);

}  // namespace modebank::app::report
