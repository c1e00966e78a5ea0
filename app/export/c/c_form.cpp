#include <fmt/format.h>

#include <boost/algorithm/string.hpp>

#include "app/export/c/c_parts.hpp"
#include "app/export/forms.hpp"
#include "app/export/names.hpp"
#include "modebank/base/error.hpp"

namespace modebank::app {
namespace {

/// What the program's text does not have is refused, not left out: it would be another filter.
void refuse_what_c_lacks(const ExportedBank& exported) {
  const auto refuse = [&](const std::string& what) {
    throw DataError(fmt::format("{}: cannot be exported to C: {}", exported.archive, what));
  };
  if (exported.options.variant == FilterVariant::salvi2025) refuse("filter.variant = salvi2025");
  if (!exported.bank.drift.empty()) refuse("modes that drift (bank.drift)");
  if (!exported.bank.terms.empty()) refuse("a motion that bends (window.terms)");
  if (!exported.bank.noise_factor.empty())
    refuse("process noise that follows state and input (--bank.noise_by_input none learns a bank without it)");
  if (exported.bank.is_quantised()) refuse("measurements in steps (data.quantum)");
}

std::string in_style(std::string text, const std::string& prefix, bool single_precision) {
  using boost::algorithm::replace_all;
  replace_all(text, "$real", single_precision ? "float" : "double");
  replace_all(text, "$f", single_precision ? "f" : "");
  replace_all(text, "$F", single_precision ? "F" : "");
  replace_all(text, "$p", prefix);
  replace_all(text, "$P", boost::algorithm::to_upper_copy(prefix));
  return text;
}

}  // namespace

CFiles to_c(const ExportedBank& exported, const std::string& stem, bool single_precision) {
  refuse_what_c_lacks(exported);
  // A file may be called double.c, but nothing in it.
  const std::string prefix = identifiers({boost::algorithm::to_lower_copy(stem)}, Language::c).front();
  const std::string source = c_form::opening(exported, "The numbers and the filter of a bank of modes") +
                             fmt::format("#include \"{}.h\"\n\n#include <math.h>\n\n", stem) +
                             c_form::constants(exported, single_precision) + c_form::data(exported) +
                             c_form::program(exported);
  return {in_style(c_form::header(exported, prefix), prefix, single_precision),
          in_style(source, prefix, single_precision)};
}

}  // namespace modebank::app
