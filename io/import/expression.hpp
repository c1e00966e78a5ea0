#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace modebank {

/// A formula over channels, such as v * tan(steer) or diff(unwrap(yaw(qx, qy, qz, qw))), evaluated row by row by
/// muParser, which sees numbers, its operators, the functions below and identifiers of our own alone.
///
/// A channel stands by its name (letters, digits, _ and ., no digit first) or in single quotes, where it may hold
/// anything ('' is a quote): '/odom.twist.twist.linear.x', '/joint_states.velocity{left}'. Operators: + - * / ^,
/// == != < > <= >=, && ||, CONDITION ? A : B. Constant: pi. Angles are in radians.
///
/// Besides sin cos tan asin acos atan atan2 sinh cosh tanh exp log log2 log10 sqrt abs sign floor ceil round mod hypot
/// min max not rad(degrees) deg(radians) wrap(to -pi..pi):
///   diff(x)                                  change since the row before, per second (first row: that of the second)
///   unwrap(x)                                an angle without jumps of 2 pi
///   yaw(x, y, z, w)                          of a quaternion
///   rotate_x(roll, pitch, yaw, x, y, z)      first component of Rz(yaw) Ry(pitch) Rx(roll) (x, y, z)'; rotate_y and
///                                            rotate_z the others
/// A row where any channel of the formula is missing (NaN), or whose value is not finite, is missing.
class Expression {
 public:
  /// `key` names the formula in messages. Throws ConfigurationError, saying at which character, for what is no formula
  /// and for one that is too long (2,000 characters) or too deep (50 parentheses).
  Expression(std::string key, std::string_view text);

  /// The channels that it names, each once, in order of first use.
  const std::vector<std::string>& channels() const { return channels_; }
  const std::string& key() const { return key_; }

  /// The row before the first of a further batch, for each diff and unwrap of the formula.
  struct RowBefore {
    double time_s, value;
  };
  using Memory = std::vector<RowBefore>;

  /// One value per row. `operands` are the channels' columns; all are as long as `time_s`. With `memory` (empty at
  /// first) batches of rows give what all rows together would, but for diff in the first row of all, which is missing.
  std::vector<double> evaluate(const std::vector<std::span<const double>>& operands, std::span<const double> time_s,
                               Memory* memory = nullptr) const;

 private:
  /// A program of muParser over columns: channels first, then what earlier steps gave.
  struct Step {
    enum class Then { nothing, diff, unwrap };
    std::string program;
    std::vector<std::size_t> columns;  ///< that the program names, as c0, c1, ...
    Then then = Then::nothing;         ///< done to the column that it gives
  };
  friend class ExpressionParser;

  std::string key_;
  std::vector<std::string> channels_;
  std::vector<Step> steps_;
};

/// A name at the start of `text`, quoted or not, which is taken off it; empty when there is none.
std::string take_channel_name(std::string_view& text);

/// The name in single quotes, as take_channel_name reads it.
std::string quoted_channel_name(std::string_view name);

/// Whether a configuration can state a name of the user's data: it has characters, and none of them is a line end or
/// another control character.
bool can_be_stated(std::string_view name);

/// Names by commas, as a configuration states them: one that would read otherwise stands in single quotes.
std::string listed_channel_names(const std::vector<std::string>& names);

}  // namespace modebank
