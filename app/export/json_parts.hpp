#pragma once

#include <Eigen/Core>
#include <nlohmann/json.hpp>
#include <vector>

#include "app/export/exported_bank.hpp"
#include "io/archive/bank/units.hpp"

/// Members that all exported JSON pages share.
namespace modebank::app {

/// JSON that keeps its members in the order of writing.
using OrderedJson = nlohmann::ordered_json;

/// An unknown number (NaN) becomes null.
OrderedJson vector_json(const Eigen::VectorXd& v);
OrderedJson matrix_json(const Eigen::MatrixXd& M);

Unit units_of(const std::vector<Channel>& channels);
OrderedJson channels_json(const std::vector<Channel>& channels);

/// A matrix with its standard errors (null if there are none) and the units of its entries (empty if unknown).
OrderedJson quantity(const Eigen::MatrixXd& value, const Eigen::MatrixXd& error, const Unit& units);

OrderedJson verdict_json(const ExportedBank& bank);
OrderedJson source_json(const ExportedBank& bank);
/// The families of the modes: title, modes, use, stay, and the means of time constant and gains.
OrderedJson families_json(const ExportedBank& bank);
/// The index of a mode's family in this list.
OrderedJson family_of(const ExportedBank& bank, Eigen::Index mode);

}  // namespace modebank::app
