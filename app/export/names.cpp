#include "app/export/names.hpp"

#include <fmt/format.h>

#include <boost/algorithm/string.hpp>
#include <nlohmann/json.hpp>
#include <set>

#include "ident/base/characters.hpp"

namespace modebank::app {
namespace {

/// Keywords of C up to C23 and of C++, because programs in both languages may include the header.
constexpr const char* c_words =
    "alignas alignof and and_eq asm atomic_cancel atomic_commit atomic_noexcept auto bitand bitor bool break case "
    "catch "
    "char char16_t char32_t char8_t class co_await co_return co_yield compl concept const const_cast consteval "
    "constexpr constinit continue decltype default delete do double dynamic_cast else enum explicit export extern "
    "false float for friend goto if inline int long mutable namespace new noexcept not not_eq nullptr operator or "
    "or_eq private protected public reflexpr register reinterpret_cast requires restrict return short signed sizeof "
    "static static_assert static_cast struct switch synchronized template this thread_local throw true try typedef "
    "typeid typename typeof typeof_unqual union unsigned using virtual void volatile wchar_t while xor xor_eq";

std::set<std::string> keywords() {
  std::set<std::string> words;
  boost::algorithm::split(words, c_words, boost::algorithm::is_space());
  return words;
}

/// C reserves names that begin with '_' for the compiler.
std::string identifier(const std::string& name) {
  const std::string result = letters_and_digits(name);
  if (result.empty()) return "unnamed";
  return is_digit(result.front()) ? "n" + result : result;
}

}  // namespace

std::vector<std::string> identifiers(const std::vector<std::string>& names) {
  std::set<std::string> taken = keywords();
  std::vector<std::string> result;
  for (const std::string& name : names) {
    const std::string base = identifier(name);
    std::string candidate = base;
    for (int i = 2; !taken.insert(candidate).second; ++i) candidate = fmt::format("{}_{}", base, i);
    result.push_back(candidate);
  }
  return result;
}

std::string comment_text(std::string_view text) {
  // JSON replaces bytes that are not UTF-8.
  using nlohmann::json;
  std::string result = json::parse(json(text).dump(-1, ' ', false, json::error_handler_t::replace)).get<std::string>();
  for (char& c : result)
    if (is_control(c) || c == '\\') c = ' ';
  // Line breaks that are not ASCII: NEL, LINE SEPARATOR and PARAGRAPH SEPARATOR.
  for (const char* breaks : {"\xc2\x85", "\xe2\x80\xa8", "\xe2\x80\xa9"})
    boost::algorithm::replace_all(result, breaks, " ");
  boost::algorithm::replace_all(result, "*/", "* /");
  boost::algorithm::replace_all(result, "/*", "/ *");
  boost::algorithm::replace_all(result, "?\?/", "? ?/");  // ??/ is the trigraph of a backslash
  return result;
}

std::string file_stem(std::string_view text) {
  std::string stem;
  for (const char c : text) stem += is_letter(c) || is_digit(c) || c == '-' ? c : '_';
  return stem.empty() ? "modebank" : stem;
}

}  // namespace modebank::app
