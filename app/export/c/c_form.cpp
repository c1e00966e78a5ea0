#include <fmt/format.h>
#include <fmt/ranges.h>

#include <boost/algorithm/string.hpp>
#include <string_view>

#include "app/export/c/c_table.hpp"
#include "app/export/c/templates.hpp"
#include "app/export/forms.hpp"
#include "app/export/names.hpp"
#include "app/text/named_forecasts.hpp"
#include "modebank/base/error.hpp"

namespace modebank::app {
namespace {

/// Throws if filter.c does not support a part of the filter, because the C filter would then give other results.
void refuse_what_c_lacks(const ExportedBank& exported) {
  const auto refuse = [&](const std::string& what) {
    throw DataError(fmt::format("{} cannot be exported to C: {}", exported.archive, what));
  };
  if (exported.options.variant == FilterVariant::salvi2025) refuse("filter.variant = salvi2025");
  if (const std::string part = c_lacks(exported.bank); !part.empty()) refuse(part);
}

std::string lag_text(double lag_s) {
  if (lag_s == 0.0) return "";
  if (lag_s > 0.0)
    return fmt::format("\n * Inputs act {0:.17g} s late: at time t give it those recorded at t - {0:.17g} s.", lag_s);
  return fmt::format(
      "\n * Inputs act {0:.17g} s before they are recorded: at time t give it those recorded at t + {0:.17g} s;"
      "\n * live, measurements wait that long for them.",
      -lag_s);
}

/// The comment at the top of a file: the verdict, the bank's origin and the equation.
std::string opening(const ExportedBank& exported, const char* what) {
  const LinearStructure& s = exported.structure();
  std::string remarks;
  for (const std::string& remark : exported.remarks()) remarks += "\n * " + comment_text(remark) + ".";
  return fmt::format(
      "/* Calibration: {}\n *\n * {}, made by modebank {} of\n * {}, filter {}, SHA-256\n * {}\n * {}\n * dt_s = "
      "{:.17g} s; {} state lag(s), {} input lag(s), delay {} sample(s){}{}\n * {} */\n",
      comment_text(exported.verdict_text()), what, comment_text(exported.provenance.modebank_version),
      comment_text(exported.archive), exported.filter, exported.sha256, exported_equation, exported.bank.dt_s,
      s.state_lags, s.input_lags, fmt::join(s.input_delay.listed(), ", "), lag_text(exported.input_lag_s), remarks,
      transition_meaning);
}

/// The template without its top comment. `prefix` replaces the prefix of the template's identifiers.
std::string named(std::string_view file, const std::string& prefix) {
  std::string text(file.substr(file.find("*/\n") + 3));
  boost::algorithm::replace_all(text, "modebank_", prefix + "_");
  boost::algorithm::replace_all(text, "MODEBANK_", boost::algorithm::to_upper_copy(prefix) + "_");
  return text;
}

/// Replaces the include line of `file` by `text`.
std::string with(std::string source, const std::string& file, const std::string& text) {
  boost::algorithm::replace_first(source, "#include \"" + file + "\"\n", text);
  return source;
}

}  // namespace

CFiles to_c(const ExportedBank& exported, const std::string& stem) {
  refuse_what_c_lacks(exported);
  // A file may be called double.c, but its identifiers must not be keywords.
  const std::string prefix = identifiers({boost::algorithm::to_lower_copy(stem)}).front();
  const std::string header = with(named(assets::filter_h(), prefix), "bank_sizes.h",
                                  c_form::bank_sizes(exported, boost::algorithm::to_upper_copy(prefix)));
  const std::string source = with(with(named(assets::filter_c(), prefix), "filter.h", "#include \"" + stem + ".h\"\n"),
                                  "bank_numbers.h", c_form::bank_numbers(exported));
  return {opening(exported, "A bank of modes and its filter") + header,
          opening(exported, "The numbers and the filter of a bank of modes") + source};
}

}  // namespace modebank::app
