#pragma once

#include <fmt/format.h>
#include <muParser.h>

#include <cstddef>
#include <string>
#include <vector>

#include "io/import/expression_functions.hpp"

namespace modebank {

/// A muParser program with its own variables c0, c1, ...
class Program {
 public:
  Program(const std::string& text, std::size_t columns) : values_(columns, 1.0) {
    define_functions(parser_);
    for (std::size_t i = 0; i < columns; ++i) parser_.DefineVar(fmt::format("c{}", i), &values_[i]);
    parser_.SetExpr(text);
  }
  double operator()() { return parser_.Eval(); }
  std::vector<double>& values() { return values_; }

 private:
  std::vector<double> values_;
  mu::Parser parser_;
};

}  // namespace modebank
