#pragma once

#include <string_view>

/// Files of app/report/web (bundled) and of configs, built into the program.
namespace modebank::app::assets {

std::string_view page_html();  ///< frame of every page, see html_page.hpp
std::string_view page_css();
std::string_view run_js();      ///< script of the page of a run
std::string_view study_js();    ///< script of a study's page
std::string_view compare_js();  ///< script of the page that compares runs
std::string_view terms_json();  ///< definitions of all terms, for pages and for `help`

// Configurations of the demo.
std::string_view simulate_demo_ini();
std::string_view demo_ini();

// Systems to simulate.
std::string_view three_grips_system();
std::string_view two_grounds_system();

}  // namespace modebank::app::assets
