#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "app/report/page/page_arrays.hpp"

namespace modebank::app::report {

/// One page, but for the parts that all have (web/page.html, page.css).
struct Page {
  std::string title;
  nlohmann::json data;      ///< what the script draws; texts in it are shown as text, whatever they hold
  PageArrays arrays;        ///< the large part of it
  std::string_view script;  ///< one of assets.hpp
};

/// As text between tags.
std::string escaped_html(std::string text);

/// What browsers let a page with one of these scripts do (Content Security Policy): run its own scripts and use its own
/// style, which it names by their hashes, and fetch or send nothing.
std::string page_policy(const std::vector<std::string_view>& scripts);

/// The self-contained HTML file: nothing in it refers to anything outside.
std::string html_of(const Page& page);

}  // namespace modebank::app::report
