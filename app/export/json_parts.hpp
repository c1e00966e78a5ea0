#pragma once

#include <Eigen/Core>
#include <nlohmann/json.hpp>
#include <vector>

#include "app/export/exported_bank.hpp"
#include "io/archive/bank/units.hpp"

/// Members that several exported JSON forms share.
namespace modebank::app {

/// A JSON object whose members keep the order in which they were added.
using OrderedJson = nlohmann::ordered_json;

/// The vector as a JSON array. An unknown number (NaN) becomes null.
OrderedJson vector_json(const Eigen::VectorXd& v);
OrderedJson matrix_json(const Eigen::MatrixXd& M);

Unit units_of(const std::vector<Channel>& channels);
OrderedJson channels_json(const std::vector<Channel>& channels);

/// A matrix with its standard errors (null if unknown) and the units of its entries (empty if unknown).
OrderedJson quantity(const Eigen::MatrixXd& value, const Eigen::MatrixXd& error, const Unit& units);

OrderedJson verdict_json(const ExportedBank& bank);
OrderedJson source_json(const ExportedBank& bank);
/// The families of the modes: title, modes, use, stay, means of the time constant and of the gains.
OrderedJson families_json(const ExportedBank& bank);
/// The index of a mode's family in the list of families.
OrderedJson family_of(const ExportedBank& bank, Eigen::Index mode);

}  // namespace modebank::app
