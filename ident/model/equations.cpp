#include "ident/model/equations.hpp"

#include <cmath>
#include <cstdio>

namespace modebank {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4g", value);
  return text;
}

/// Makes "wz[k]" of "wz". The names of other samples already contain their sample.
std::string at_its_sample(const std::string& name) { return name.empty() || name.back() != ']' ? name + "[k]" : name; }

/// A printed sum of products: "a x - b y".
class Sum {
 public:
  void add(double coefficient, const std::string& of) {
    if (coefficient == 0.0) return;
    const std::string size = number(std::abs(coefficient)) + (of.empty() ? "" : " " + of);
    if (text_.empty())
      text_ = (coefficient < 0.0 ? "-" : "") + size;
    else
      text_ += (coefficient < 0.0 ? " - " : " + ") + size;
  }
  std::string text() const { return text_.empty() ? "0" : text_; }

 private:
  std::string text_;
};

std::vector<std::string> regressor_names(const LinearStructure& s, const std::vector<std::string>& states,
                                         const std::vector<std::string>& inputs) {
  std::vector<std::string> names;
  for (const std::string& name : states) names.push_back(at_its_sample(name));
  for (const std::string& name : inputs) names.push_back(at_its_sample(name));
  if (s.intercept) names.emplace_back("");
  return names;
}

/// Names of the variables in terms. A regressor has its own name; directions are called p1, p2, ...
struct VariableNames {
  std::vector<std::string> names, definitions;

  VariableNames(const MotionTerms& terms, const std::vector<std::string>& regressors) {
    for (Index v = 0; v < terms.variables(); ++v) {
      const VectorXd direction = terms.direction.col(v);
      Index at = 0;
      direction.cwiseAbs().maxCoeff(&at);
      const bool single = direction(at) == 1.0 && (direction.array() != 0.0).count() == 1;
      names.push_back(single ? regressors[static_cast<std::size_t>(at)]
                             : "p" + std::to_string(definitions_of_directions_++ + 1));
      const std::string range = names.back() + " within " + number(terms.low(v)) + " to " + number(terms.high(v));
      if (single) {
        definitions.push_back(range);
        continue;
      }
      Sum sum;
      for (Index i = 0; i < direction.size(); ++i) sum.add(direction(i), regressors[static_cast<std::size_t>(i)]);
      definitions.push_back(names.back() + " = " + sum.text() + ", " + range);
    }
  }

 private:
  int definitions_of_directions_ = 0;
};

/// The text "max(0, p1 - 0.4)", and the factor that converts the coefficient of the term to these units.
std::pair<std::string, double> in_units(const Term& term, const MotionTerms& terms,
                                        const std::vector<std::string>& names) {
  const auto name = [&](Index v) { return names[static_cast<std::size_t>(v)]; };
  const Index first = term.variables.front();
  if (term.kind == TermKind::magnitude) return {"|" + name(first) + "|", 1.0 / terms.unit(first)};
  if (term.kind == TermKind::hinge) {
    const double knot = term.knot * terms.unit(first);
    const std::string shift = knot == 0.0 ? "" : (knot > 0.0 ? " - " : " + ") + number(std::abs(knot));
    return {"max(0, " + name(first) + shift + ")", 1.0 / terms.unit(first)};
  }
  std::string text;
  double factor = 1.0;
  for (const Index v : term.variables) {
    text += (text.empty() ? "" : " * ") + name(v);
    factor /= terms.unit(v);
  }
  return {text, factor};
}

}  // namespace

std::vector<std::string> equations(const LinearStructure& s, const LinearModel& model, const MotionTerms& terms,
                                   const Eigen::MatrixXd& bend, const std::vector<std::string>& state_names,
                                   const std::vector<std::string>& input_names) {
  if (std::ssize(state_names) != s.dimension() || std::ssize(input_names) != s.acting_inputs()) return {};
  const std::vector<std::string> regressors = regressor_names(s, state_names, input_names);
  const VariableNames variables(terms, regressors);
  std::vector<std::string> lines;
  const Eigen::MatrixXd F = model.full_form();
  for (Index i = 0; i < s.states; ++i) {
    Sum sum;
    for (Index j = 0; j < s.dimension(); ++j) sum.add(F(i, j), regressors[static_cast<std::size_t>(j)]);
    for (Index j = 0; j < s.acting_inputs(); ++j)
      sum.add(model.B(i, j), regressors[static_cast<std::size_t>(s.dimension() + j)]);
    sum.add(model.c(i), "");
    for (Index t = 0; t < terms.count(); ++t) {
      const auto [text, factor] = in_units(terms.terms[static_cast<std::size_t>(t)], terms, variables.names);
      sum.add(bend(i, t) * factor, text);
    }
    lines.push_back(state_names[static_cast<std::size_t>(i)] + "[k+1] = " + sum.text());
  }
  lines.insert(lines.end(), variables.definitions.begin(), variables.definitions.end());
  return lines;
}

}  // namespace modebank
