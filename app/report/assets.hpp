#pragma once

#include <string_view>

/// Files of app/report/web, bundled and embedded at build time.
namespace modebank::app::assets {

std::string_view page_html();  ///< the skeleton of every page, see html_page.hpp
std::string_view page_css();
std::string_view plotly_js();  ///< Plotly with its licence
std::string_view run_js();     ///< what draws the page of a run

}  // namespace modebank::app::assets
