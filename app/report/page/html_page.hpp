#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "app/report/page/page_arrays.hpp"

namespace modebank::app::report {

/// One page, without the parts common to all (web/page.html, page.css).
struct Page {
  std::string title;
  nlohmann::json data;      ///< input of the script; its texts are always displayed as text
  PageArrays arrays;        ///< the large arrays of the data
  std::string_view script;  ///< an asset of assets.hpp
};

/// Escapes text for use between tags.
std::string escaped_html(std::string text);

/// Permissions of a page with one of these scripts (Content Security Policy): its own scripts and style, identified by
/// hashes. It must neither fetch nor send anything.
std::string page_policy(const std::vector<std::string_view>& scripts);

/// The self-contained HTML file, which refers to nothing outside.
std::string html_of(const Page& page);

}  // namespace modebank::app::report
