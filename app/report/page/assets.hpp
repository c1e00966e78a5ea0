#pragma once

#include <string_view>

/// Files of app/report/web, bundled, and of configs, embedded at build time.
namespace modebank::app::assets {

std::string_view page_html();  ///< the skeleton of every page, see html_page.hpp
std::string_view page_css();
std::string_view run_js();      ///< what draws the page of a run
std::string_view study_js();    ///< that of a study
std::string_view compare_js();  ///< that of two runs
std::string_view index_js();    ///< that of the index of a folder
std::string_view terms_json();  ///< every term's one definition, of pages and of help

// Configurations of the demo.
std::string_view simulate_ice_ini();
std::string_view demo_ini();

// Systems to simulate.
std::string_view husky_ice_system();
std::string_view three_grips_system();

}  // namespace modebank::app::assets
