#include "io/import/expression.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>

#include "ident/base/characters.hpp"
#include "ident/base/nearest_name.hpp"
#include "ident/base/printable.hpp"
#include "io/import/expression_functions.hpp"
#include "io/import/expression_program.hpp"
#include "io/table/number.hpp"
#include "modebank/base/error.hpp"

namespace modebank {

struct ExpressionToken {
  enum class Kind { number, channel, function, constant, symbol };
  Kind kind = Kind::symbol;
  std::string text;    ///< a number's text in muParser's syntax, or a channel's name
  std::size_t at = 0;  ///< position in the user's text, counted from 0
};

namespace {

constexpr std::size_t longest_text = 2000, deepest = 50;

bool begins_name(char c) { return is_letter(c) || c == '_'; }

/// The operator at the start of a text. Empty if there is none.
std::string_view symbol_at(std::string_view text) {
  for (const std::string_view two : {"==", "!=", "<=", ">=", "&&", "||"})
    if (text.starts_with(two)) return text.substr(0, 2);
  constexpr std::string_view ones = "+-*/^<>?:(),";
  return ones.find(text.front()) == std::string_view::npos ? std::string_view() : text.substr(0, 1);
}

}  // namespace

std::string take_channel_name(std::string_view& text) {
  std::string name;
  if (text.empty()) return name;
  if (text.front() == '\'') {
    std::size_t i = 1;
    for (; i < text.size(); ++i) {
      const bool quote = text[i] == '\'';
      if (quote && !(i + 1 < text.size() && text[i + 1] == '\'')) break;
      if (quote) ++i;
      name += text[i];
    }
    if (i >= text.size()) return {};
    text.remove_prefix(i + 1);
    return name;
  }
  if (!begins_name(text.front())) return name;
  std::size_t end = 1;
  while (end < text.size() && (begins_name(text[end]) || is_digit(text[end]) || text[end] == '.')) ++end;
  name = text.substr(0, end);
  text.remove_prefix(end);
  return name;
}

std::string quoted_channel_name(std::string_view name) {
  std::string result = "'";
  for (const char c : name) result += c == '\'' ? std::string("''") : std::string(1, c);
  return result + "'";
}

bool can_be_stated(std::string_view name) { return !name.empty() && !name_holds_controls(name); }

std::string listed_channel_names(const std::vector<std::string>& names) {
  std::string result;
  for (const std::string& name : names) {
    const bool plain = name.find(',') == std::string::npos && !name.starts_with('\'') && without_blanks(name) == name;
    result += (&name == &names.front() ? "" : ", ") + (plain ? name : quoted_channel_name(name));
  }
  return result;
}

/// Converts the text to tokens, and the tokens to steps. The argument of diff or unwrap becomes a separate step.
class ExpressionParser {
 public:
  ExpressionParser(Expression& result, std::string_view text) : result_(result), text_(text) {}

  void parse() {
    if (text_.size() > longest_text)
      throw ConfigurationError(fmt::format("{}: {} characters, but at most {} are allowed", result_.key_.substr(0, 60),
                                           text_.size(), longest_text));
    tokenise();
    if (tokens_.empty()) fail(text_.size(), "there is no expression");
    check_parentheses();
    compile(0, tokens_.size(), Expression::Step::Then::nothing);
  }

 private:
  using Token = ExpressionToken;
  using Kind = Token::Kind;
  static constexpr const char* only_in_functions = "a comma is allowed only between arguments of a function";

  [[noreturn]] void fail(std::size_t at, const std::string& what) const {
    throw ConfigurationError(fmt::format("{}: at character {} (\"{}\"): {}", result_.key_, at + 1,
                                         at < text_.size() ? text_.substr(at, 20) : "end", what));
  }

  void tokenise() {
    for (std::size_t at = 0; at < text_.size();) {
      if (text_[at] == ' ' || text_[at] == '\t') {
        ++at;
        continue;
      }
      std::string_view rest = text_.substr(at);
      tokens_.push_back(token_at(at, rest));
      at = text_.size() - rest.size();
    }
  }

  /// Removes one token from `rest`.
  Token token_at(std::size_t at, std::string_view& rest) {
    if (rest.front() == '\'' || is_letter(rest.front())) return name_at(at, rest);
    if (is_digit(rest.front()) || (rest.front() == '.' && rest.size() > 1 && is_digit(rest[1])))
      return number_at(at, rest);
    const std::string_view symbol = symbol_at(rest);
    if (symbol.empty())
      fail(at, rest.front() == '=' ? "a comparison is ==" : "this is neither a number, channel, function nor operator");
    rest.remove_prefix(symbol.size());
    return {Kind::symbol, std::string(symbol), at};
  }

  Token name_at(std::size_t at, std::string_view& rest) {
    const bool quoted = rest.front() == '\'';
    std::string name = take_channel_name(rest);
    if (name.empty()) fail(at, "a quoted name is empty or has no closing quote");
    const bool called = !quoted && rest.find_first_not_of(" \t") != std::string_view::npos &&
                        rest[rest.find_first_not_of(" \t")] == '(';
    const auto& functions = function_names();
    if (called && std::find(functions.begin(), functions.end(), name) == functions.end())
      fail(at, fmt::format("no function {}{}", name, did_you_mean(name, functions)));
    if (called) return {Kind::function, std::move(name), at};
    if (!quoted && name == "pi") return {Kind::constant, std::move(name), at};
    auto& channels = result_.channels_;
    if (std::find(channels.begin(), channels.end(), name) == channels.end()) channels.push_back(name);
    return {Kind::channel, std::move(name), at};
  }

  Token number_at(std::size_t at, std::string_view& rest) {
    double value = 0.0;
    const auto [stop, error] = std::from_chars(rest.data(), rest.data() + rest.size(), value);
    if (error != std::errc()) fail(at, "the number does not fit a double");
    rest.remove_prefix(static_cast<std::size_t>(stop - rest.data()));
    if (!rest.empty() && (is_letter(rest.front()) || rest.front() == '.'))
      fail(at, "a number and a name need an operator between them");
    return {Kind::number, fmt::format("{:.17g}", value), at};
  }

  void check_parentheses() const {
    std::size_t depth = 0;
    for (const Token& token : tokens_) {
      if (token.kind != Kind::symbol) continue;
      if (token.text == "(" && ++depth > deepest)
        fail(token.at, fmt::format("parentheses are nested more than {} deep", deepest));
      if (token.text == ")" && depth-- == 0) fail(token.at, "this closes a parenthesis that was never opened");
    }
    if (depth > 0) fail(text_.size(), "a parenthesis is not closed");
  }

  /// Position after the parenthesis that closes the parenthesis at `open`.
  std::size_t after_closing(std::size_t open) const {
    std::size_t depth = 0, i = open;
    do {
      if (tokens_[i].kind == Kind::symbol) depth += tokens_[i].text == "(" ? 1 : 0;
      if (tokens_[i].kind == Kind::symbol) depth -= tokens_[i].text == ")" ? 1 : 0;
      ++i;
    } while (depth > 0);
    return i;
  }

  std::size_t channel_position(const std::string& name) const {
    const auto& channels = result_.channels_;
    return static_cast<std::size_t>(std::find(channels.begin(), channels.end(), name) - channels.begin());
  }

  /// Adds a step that computes tokens `first` to `end`. Returns the column of its result.
  std::size_t compile(std::size_t first, std::size_t end, Expression::Step::Then then) {
    Expression::Step step;
    step.then = then;
    std::vector<std::pair<std::size_t, std::size_t>> places;  // positions in the program and the matching positions in
                                                              // the user's text
    const auto name_of = [&step](std::size_t column) {
      const auto known = std::find(step.columns.begin(), step.columns.end(), column);
      const auto position = static_cast<std::size_t>(known - step.columns.begin());
      if (known == step.columns.end()) step.columns.push_back(column);
      return fmt::format("c{}", position);
    };
    int depth = 0;
    for (std::size_t i = first; i < end; ++i) {
      const Token& token = tokens_[i];
      places.emplace_back(step.program.size(), token.at);
      if (token.text == "(" && token.kind == Kind::symbol) ++depth;
      if (token.text == ")" && token.kind == Kind::symbol) --depth;
      if (token.text == "," && token.kind == Kind::symbol && depth == 0) fail(token.at, only_in_functions);
      const bool of_column = token.kind == Kind::function && (token.text == "diff" || token.text == "unwrap");
      if (of_column) {
        const std::size_t after = after_closing(i + 1);
        if (after == i + 3) fail(tokens_[i + 2].at, token.text + " needs an argument");
        using Then = Expression::Step::Then;
        step.program += name_of(compile(i + 2, after - 1, token.text == "diff" ? Then::diff : Then::unwrap));
        i = after - 1;
      } else {
        step.program += token.kind == Kind::channel ? name_of(channel_position(token.text)) : token.text;
      }
      if (token.kind != Kind::function || of_column) step.program += ' ';  // muParser does not allow a blank before (
    }
    try_out(step, places, end < tokens_.size() ? tokens_[end].at : text_.size());
    result_.steps_.push_back(std::move(step));
    return result_.channels_.size() + result_.steps_.size() - 1;
  }

  /// muParser reports errors only at the first evaluation.
  void try_out(const Expression::Step& step, const std::vector<std::pair<std::size_t, std::size_t>>& places,
               std::size_t end) const {
    try {
      Program program(step.program, step.columns.size());
      program();
    } catch (const mu::ParserError& error) {
      std::size_t at = end;
      for (const auto& [place, source] : places)
        if (static_cast<std::size_t>(error.GetPos()) >= place && error.GetCode() != mu::ecUNEXPECTED_EOF) at = source;
      fail(at, reason(error.GetCode()));
    }
  }

  static std::string reason(mu::EErrorCodes code) {
    switch (code) {
      case mu::ecTOO_MANY_PARAMS:
        return "too many arguments";
      case mu::ecTOO_FEW_PARAMS:
        return "too few arguments";
      case mu::ecMISSING_ELSE_CLAUSE:
        return "CONDITION ? A : B needs its : B";
      case mu::ecUNEXPECTED_EOF:
        return "the expression ends too early";
      case mu::ecUNEXPECTED_VAL:
      case mu::ecUNEXPECTED_VAR:
        return "an operator is missing before this";
      case mu::ecUNEXPECTED_ARG_SEP:
        return only_in_functions;
      default:
        return "this is not expected here";
    }
  }

  Expression& result_;
  std::string_view text_;
  std::vector<Token> tokens_;
};

Expression::Expression(std::string key, std::string_view text) : key_(std::move(key)) {
  try {
    ExpressionParser(*this, text).parse();
  } catch (const mu::ParserError& error) {
    throw ConfigurationError(fmt::format("{}: {}", key_, error.GetMsg()));
  }
}

}  // namespace modebank
