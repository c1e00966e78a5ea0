#pragma once

#include <vector>

#include "app/config/option_table.hpp"

/// The sections of the option table.
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

/// The lines of a system file, keys of its section [system]; no keys of a configuration.
const std::vector<Option>& system_parameters();

}  // namespace modebank::app
