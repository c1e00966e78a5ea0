#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace modebank {

/// A formula over channels, such as v * tan(steer) or diff(unwrap(yaw(qx, qy, qz, qw))). muParser evaluates it row by
/// row. The program for muParser contains only numbers, operators, the functions below and identifiers that this class
/// makes.
///
/// A channel is written as its name: letters, digits, _ and ., beginning with no digit. A name in single quotes may
/// contain any characters ('' means one quote): '/odom.twist.twist.linear.x', '/joint_states.velocity{left}'.
/// Operators: + - * / ^, == != < > <= >=, && ||, CONDITION ? A : B. Constant: pi. Angles are in radians.
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
  /// `key` names the formula in messages. Throws ConfigurationError with the position if the formula is invalid, longer
  /// than 2,000 characters, or nested more than 50 parentheses deep.
  Expression(std::string key, std::string_view text);

  /// The formula's channels in the order of their first use, each once.
  const std::vector<std::string>& channels() const { return channels_; }
  const std::string& key() const { return key_; }

  /// The last row of the previous batch, for each `diff` and `unwrap` of the formula.
  struct RowBefore {
    double time_s, value;
  };
  using Memory = std::vector<RowBefore>;

  /// Computes one value per row. `operands`: columns of the channels, each with the length of `time_s`. With `memory`
  /// (empty at first), the values of batches equal those of all rows together. The only exception is `diff` in the very
  /// first row, which is missing.
  std::vector<double> evaluate(const std::vector<std::span<const double>>& operands, std::span<const double> time_s,
                               Memory* memory = nullptr) const;

 private:
  /// A muParser program over columns. The columns are the channels, then the results of earlier steps.
  struct Step {
    enum class Then { nothing, diff, unwrap };
    std::string program;
    std::vector<std::size_t> columns;  ///< columns of the program's variables c0, c1, ...
    Then then = Then::nothing;         ///< the function that is applied to the program's result
  };
  friend class ExpressionParser;

  std::string key_;
  std::vector<std::string> channels_;
  std::vector<Step> steps_;
};

/// Removes a name, with or without quotes, from the start of `text`. Returns the name, or an empty text if there is
/// none.
std::string take_channel_name(std::string_view& text);

/// The name in single quotes, in the form that take_channel_name reads.
std::string quoted_channel_name(std::string_view name);

/// Whether a configuration can contain a name. The name must not be empty and must not contain line breaks or other
/// control characters.
bool can_be_stated(std::string_view name);

/// Names for a configuration, separated by commas. Names that need quotes are in single quotes.
std::string listed_channel_names(const std::vector<std::string>& names);

}  // namespace modebank
