#pragma once

#include <string>
#include <vector>

#include "ident/data/trajectory.hpp"
#include "ident/model/linear_model.hpp"
#include "ident/model/local_model.hpp"
#include "ident/model/motion_model.hpp"
#include "io/archive/groups/sizes.hpp"

namespace modebank {

/// Unit of a product: "(a)^2" or "(a)*(b)". Unknown if one unit is unknown.
std::string unit_product(const std::string& a, const std::string& b);
/// Unit of a quotient: "a/b", or "1" for equal units. Unknown if one unit is unknown.
std::string unit_ratio(const std::string& a, const std::string& b);

/// Units of variances, one for each entry.
Unit squared(const Unit& unit);
/// Row-major units of a covariance matrix.
Unit outer(const Unit& unit);
/// Row-major units of a matrix that maps `from` to `to`.
Unit ratios(const Unit& to, const Unit& from);
/// The units of a table's array column as one text. This is the common unit, or all units with commas. Empty if a unit
/// is unknown.
std::string joined(const Unit& unit);

/// Units of the recorded channels. The units of a model's arrays follow from these.
class Units {
 public:
  Units() = default;
  explicit Units(const Recording& recording) : states_(recording.states), inputs_(recording.inputs) {}

  Unit states() const { return of(states_); }
  Unit inputs() const { return of(inputs_); }
  /// Units of named channels. A lagged name such as "wz[k-1]" has the unit of its channel.
  Unit states(const std::vector<std::string>& names) const { return of(states_, names); }
  Unit inputs(const std::vector<std::string>& names) const { return of(inputs_, names); }

 private:
  static Unit of(const std::vector<Channel>& channels);
  static Unit of(const std::vector<Channel>& channels, const std::vector<std::string>& names);

  std::vector<Channel> states_;
  std::vector<Channel> inputs_;
};

/// Units of a motion model's parameters.
Unit unit_of(const std::vector<ModelParameter>& parameters);

/// Units of a mixture's features by name. A feature is a parameter of the windows or of their one-lag fits, or a
/// logarithm (unit "1").
Unit feature_units(const std::vector<std::string>& names, const WindowFits& fits, const Units& units);

/// Units of theta, which contains the rows of [A B (c)] one after another.
Unit parameter_units(const LinearStructure& structure, const Unit& states, const Unit& inputs);

}  // namespace modebank
