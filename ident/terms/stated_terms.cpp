#include "ident/terms/stated_terms.hpp"

#include <algorithm>
#include <boost/algorithm/string.hpp>
#include <cmath>
#include <regex>
#include <stdexcept>

#include "modebank/base/error.hpp"

namespace modebank {
namespace {

using Eigen::Index;

/// Splits at commas outside of parentheses.
std::vector<std::string> parts_of(const std::string& text) {
  std::vector<std::string> parts(1);
  int depth = 0;
  for (const char c : text) {
    depth += c == '(' ? 1 : c == ')' ? -1 : 0;
    if (c == ',' && depth == 0)
      parts.emplace_back();
    else
      parts.back() += c;
  }
  for (std::string& part : parts) boost::trim(part);
  return parts;
}

StatedTerm product_of(const std::string& text) {
  StatedTerm term;
  boost::split(term.names, text, [](char c) { return c == '*'; });
  for (std::string& name : term.names) boost::trim(name);
  return term;
}

StatedTerm read_term(const std::string& text) {
  static const std::regex magnitude(R"(\|\s*([^|*(),]+?)\s*\|)");
  static const std::regex hinge(R"(max\(\s*0\s*,\s*([^|*(),]+?)\s*(?:([+-])\s*([0-9.]+(?:[eE][+-]?[0-9]+)?)\s*)?\))");
  std::smatch found;
  if (std::regex_match(text, found, magnitude)) return {TermKind::magnitude, {found[1]}};
  if (std::regex_match(text, found, hinge)) {
    const double size = found[3].matched ? std::stod(found[3]) : 0.0;
    return {TermKind::hinge, {found[1]}, found[2] == "-" ? size : -size};
  }
  StatedTerm term = product_of(text);
  const bool named = std::all_of(term.names.begin(), term.names.end(), [](const std::string& name) {
    return !name.empty() && name.find_first_of("|()") == std::string::npos;
  });
  if (term.names.size() < 2 || term.names.size() > 3 || !named)
    throw std::invalid_argument("has '" + text +
                                "'; write NAME * NAME, NAME * NAME * NAME, |NAME| or max(0, NAME - NUMBER)");
  return term;
}

Index position_of(const std::string& name, const std::vector<std::string>& names) {
  const auto of_sample = [&](const std::string& one) { return one == name || one == name + "[k+1]"; };
  const auto found = std::find_if(names.begin(), names.end(), of_sample);
  if (found == names.end())
    throw DataError("window.terms: no regressor is called '" + name + "'; there are " + boost::join(names, ", "));
  return found - names.begin();
}

}  // namespace

std::vector<StatedTerm> read_terms(const std::string& text) {
  std::vector<StatedTerm> terms;
  for (const std::string& part : parts_of(text)) terms.push_back(read_term(part));
  return terms;
}

MotionTerms stated_terms(const std::vector<StatedTerm>& stated, const std::vector<std::string>& names,
                         const Eigen::MatrixXd& regressors) {
  const auto q = std::ssize(names);
  MotionTerms all;
  all.direction = Eigen::MatrixXd::Identity(regressors.cols(), q);
  all.low = regressors.leftCols(q).colwise().minCoeff();
  all.high = regressors.leftCols(q).colwise().maxCoeff();
  all.unit = (regressors.leftCols(q).colwise().squaredNorm() / static_cast<double>(regressors.rows())).cwiseSqrt();
  for (double& unit : all.unit)
    if (!(unit > 0.0)) unit = 1.0;
  std::vector<Term> terms;
  for (const StatedTerm& one : stated) {
    Term& term = terms.emplace_back(Term{one.kind, {}, 0.0});
    for (const std::string& name : one.names) term.variables.push_back(position_of(name, names));
    term.knot = one.knot / all.unit(term.variables.front());
  }
  return used_part(all, terms);
}

}  // namespace modebank
