#include "app/report/figures/figure.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <boost/algorithm/string.hpp>
#include <cmath>

#include "app/report/figures/palette.hpp"
#include "app/report/figures/shown_groups.hpp"

namespace modebank::app::report {
namespace {

/// Between single quotes gnuplot takes everything as it is but the quote, which it misreads at their beginning even
/// when doubled: an apostrophe stands in for it.
std::string quoted(const std::string& text) {
  std::string copy = boost::replace_all_copy(text, "'", "\u2019");
  std::replace_if(
      copy.begin(), copy.end(), [](unsigned char c) { return c < 0x20 || c == 0x7F; }, ' ');
  return "'" + copy + "'";
}

std::string array_text(const std::string& variable, const std::vector<std::string>& texts) {
  std::string values;
  for (const std::string& text : texts) values += (values.empty() ? "" : ", ") + quoted(text);
  return fmt::format("array {}[{}] = [{}]\n", variable, texts.size(), values);
}

/// One line of a comment, whatever the text holds.
std::string comment(const std::string& text) {
  std::string copy = text;
  std::replace_if(
      copy.begin(), copy.end(), [](unsigned char c) { return c < 0x20; }, ' ');
  return "# " + copy + "\n";
}

/// Text as LaTeX prints it.
std::string latex_text(const std::string& text) {
  std::string result;
  for (const char c : text) {
    const std::string_view special = "&%$#_{}";
    if (special.find(c) != std::string_view::npos)
      result += std::string("\\") + c;
    else if (c == '\\')
      result += "\\textbackslash{}";
    else if (c == '~' || c == '^')
      result += std::string("\\") + c + "{}";
    else
      result += static_cast<unsigned char>(c) < 0x20 ? ' ' : c;
  }
  return result;
}

}  // namespace

std::string Figure::latex_sign() const {
  return fmt::format("% \\usepackage{{graphicx}}; the file is {}.pdf\n", name_);
}

std::string Figure::script_sign() const { return comment("Drawn by gnuplot 5 or later: gnuplot " + name_ + ".gp"); }

std::string Figure::latex() const {
  return latex_sign() + fmt::format(
                            "\\begin{{figure}}\n  \\centering\n  "
                            "\\includegraphics[width=\\columnwidth]{{{0}}}\n  \\caption{{{1}}}\n  "
                            "\\label{{fig:{0}}}\n\\end{{figure}}\n",
                            name_, latex_text(caption_));
}

void Figure::set(const std::string& variable, double value) {
  settings_ += std::isfinite(value) ? fmt::format("{} = {:.9g}\n", variable, value) : variable + " = NaN\n";
}
void Figure::set(const std::string& variable, Eigen::Index value) {
  settings_ += fmt::format("{} = {}\n", variable, value);
}
void Figure::set(const std::string& variable, const std::string& text) {
  settings_ += variable + " = " + quoted(text) + "\n";
}
void Figure::set(const std::string& variable, const std::vector<std::string>& texts) {
  settings_ += array_text(variable, texts);
}

void Figure::add_block(const std::string& title, const std::vector<std::string>& columns,
                       const Eigen::Ref<const Eigen::MatrixXd>& rows) {
  if (!data_.empty()) data_ += "\n\n";
  data_ += comment(title) + comment(boost::join(columns, " | "));
  if (rows.rows() == 0) data_ += fmt::format("{}\n", fmt::join(std::vector<std::string>(columns.size(), "NaN"), " "));
  for (Eigen::Index i = 0; i < rows.rows(); ++i) {
    std::string line;
    for (Eigen::Index j = 0; j < rows.cols(); ++j)
      line += (j ? " " : "") + (std::isfinite(rows(i, j)) ? fmt::format("{:.9g}", rows(i, j)) : std::string("NaN"));
    data_ += line + "\n";
  }
}

std::string Figure::script() const {
  const Palette colours = palette();
  return script_sign() + "figure = " + quoted(name_) + "\n" + array_text("palette", colours.modes) +
         "bank_colour = " + quoted(colours.filters.at("bank")) +
         "\nbaseline_colour = " + quoted(colours.filters.at("baseline")) +
         "\noutlier_colour = " + quoted(colours.outlier) + "\n" + settings_ + "load 'style.gp'\n" +
         std::string(script_);
}

}  // namespace modebank::app::report
