#pragma once

#include <vector>

#include "app/config/option_table.hpp"

/// Sections of the option table.
namespace modebank::app {

std::vector<Option> data_options();
std::vector<Option> window_options();
std::vector<Option> mixture_options();
std::vector<Option> bank_options();
std::vector<Option> filter_options();
std::vector<Option> archive_options();  ///< and [job]
std::vector<Option> study_options();
std::vector<Option> track_options();
std::vector<Option> report_options();
std::vector<Option> simulate_options();

/// Keys of the section [system] in a system file. A configuration does not have these keys.
const std::vector<Option>& system_parameters();

}  // namespace modebank::app
