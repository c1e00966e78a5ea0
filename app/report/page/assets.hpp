#pragma once

#include <string_view>

/// Files of app/report/web, bundled, of app/report/figures and of configs, embedded at build time.
namespace modebank::app::assets {

std::string_view page_html();  ///< the skeleton of every page, see html_page.hpp
std::string_view page_css();
std::string_view plotly_packed();  ///< Plotly with its licence: gzip in base64
std::string_view plotly_sha256();  ///< of Plotly as it is unpacked, as sha256sum prints it
std::string_view run_js();         ///< what draws the page of a run
std::string_view study_js();       ///< that of a study
std::string_view compare_js();     ///< that of two runs
std::string_view index_js();       ///< that of the index of a folder
std::string_view palette_json();
std::string_view terms_json();  ///< every term's one definition, of pages and of help

// Gnuplot scripts of the figures for papers, see gnuplot.hpp.
std::string_view figure_style();
std::string_view figure_strip();
std::string_view figure_local_models();
std::string_view figure_estimates();
std::string_view figure_prediction();
std::string_view figure_nis();
std::string_view figure_selection();
std::string_view figure_pit();
std::string_view figure_coverage();
std::string_view figure_transition();
std::string_view figure_effects();
std::string_view figure_pareto();

// Configurations of the demo.
std::string_view simulate_ice_ini();
std::string_view demo_ini();

}  // namespace modebank::app::assets
