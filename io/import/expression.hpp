#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace modebank {

/// A formula over channels, such as v * tan(steer) or diff(unwrap(yaw(qx, qy, qz, qw))). muParser evaluates the formula
/// row by row. muParser's program contains only numbers, operators, the functions below and identifiers made here.
///
/// A channel is written by its name (letters, digits, _ and ., no digit first). In single quotes a name may have any
/// characters ('' is a quote): '/odom.twist.twist.linear.x', '/joint_states.velocity{left}'. Operators: + - * / ^, ==
/// != < > <= >=, && ||, CONDITION ? A : B. Constant: pi. Angles are in radians.
///
/// Functions beside sin cos tan asin acos atan atan2 sinh cosh tanh exp log log2 log10 sqrt abs sign floor ceil round
/// mod hypot min max not rad(degrees) deg(radians) wrap(to -pi..pi):
///   diff(x)                              change since the previous row, per second (first row: as in the second)
///   unwrap(x)                            an angle without jumps of 2 pi
///   yaw(x, y, z, w)                      yaw of a quaternion
///   rotate_x(roll, pitch, yaw, x, y, z)  first component of Rz(yaw) Ry(pitch) Rx(roll) (x, y, z)'; second: rotate_y,
///                                        third: rotate_z
/// A row is missing if a channel of the formula is missing (NaN), or if its value is not finite.
class Expression {
 public:
  /// `key` names the formula in messages. Throws ConfigurationError with the position for a formula that is invalid,
  /// longer than 2,000 characters or nested deeper than 50 parentheses.
  Expression(std::string key, std::string_view text);

  /// The formula's channels in order of first use, without repetition.
  const std::vector<std::string>& channels() const { return channels_; }
  const std::string& key() const { return key_; }

  /// The last row of the previous batch, for each diff and unwrap of the formula.
  struct RowBefore {
    double time_s, value;
  };
  using Memory = std::vector<RowBefore>;

  /// One value per row. `operands` are the channels' columns; all are as long as `time_s`. With `memory` (empty at
  /// first), batches of rows give the same values as all rows together. Only the diff of the very first row differs: it
  /// is missing.
  std::vector<double> evaluate(const std::vector<std::span<const double>>& operands, std::span<const double> time_s,
                               Memory* memory = nullptr) const;

 private:
  /// A muParser program over columns: the channels, then the results of earlier steps.
  struct Step {
    enum class Then { nothing, diff, unwrap };
    std::string program;
    std::vector<std::size_t> columns;  ///< columns of the program's variables c0, c1, ...
    Then then = Then::nothing;         ///< function applied to its result
  };
  friend class ExpressionParser;

  std::string key_;
  std::vector<std::string> channels_;
  std::vector<Step> steps_;
};

/// Removes a name, quoted or not, from the start of `text` and returns the name; empty if there is none.
std::string take_channel_name(std::string_view& text);

/// The name in single quotes, so that take_channel_name can read it.
std::string quoted_channel_name(std::string_view name);

/// Whether a configuration can contain a name: it must not be empty, nor contain line breaks or other control
/// characters.
bool can_be_stated(std::string_view name);

/// Names separated by commas for a configuration; a name that needs quotes is in single quotes.
std::string listed_channel_names(const std::vector<std::string>& names);

}  // namespace modebank
