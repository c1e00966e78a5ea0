#include "io/import/expression_functions.hpp"

#include <array>
#include <cmath>
#include <functional>
#include <numbers>

namespace modebank {

namespace {

using std::numbers::pi;

struct Vector {
  double x, y, z;
};

/// Rz(yaw) Ry(pitch) Rx(roll) v. The rotations are about fixed axes, first about x, as in ROS' definition of roll,
/// pitch and yaw.
Vector rotated(double roll, double pitch, double yaw, Vector v) {
  v = {v.x, std::cos(roll) * v.y - std::sin(roll) * v.z, std::sin(roll) * v.y + std::cos(roll) * v.z};
  v = {std::cos(pitch) * v.x + std::sin(pitch) * v.z, v.y, -std::sin(pitch) * v.x + std::cos(pitch) * v.z};
  return {std::cos(yaw) * v.x - std::sin(yaw) * v.y, std::sin(yaw) * v.x + std::cos(yaw) * v.y, v.z};
}

double yaw_of(double x, double y, double z, double w) {
  return std::atan2(2.0 * (w * z + x * y), w * w + x * x - y * y - z * z);
}

/// NaN if any value is NaN. Comparisons alone would ignore NaN.
template <class Better>
double chosen(const double* values, int count, Better better) {
  double best = values[0];
  for (int i = 1; i < count; ++i)
    if (std::isnan(values[i]) || better(values[i], best)) best = values[i];
  return best;
}
double smallest(const double* values, int count) { return chosen(values, count, std::less<>()); }
double largest(const double* values, int count) { return chosen(values, count, std::greater<>()); }

struct Function1 {
  const char* name;
  double (*value)(double);
};
constexpr std::array functions1{
    Function1{"sin", [](double x) { return std::sin(x); }},
    Function1{"cos", [](double x) { return std::cos(x); }},
    Function1{"tan", [](double x) { return std::tan(x); }},
    Function1{"asin", [](double x) { return std::asin(x); }},
    Function1{"acos", [](double x) { return std::acos(x); }},
    Function1{"atan", [](double x) { return std::atan(x); }},
    Function1{"sinh", [](double x) { return std::sinh(x); }},
    Function1{"cosh", [](double x) { return std::cosh(x); }},
    Function1{"tanh", [](double x) { return std::tanh(x); }},
    Function1{"exp", [](double x) { return std::exp(x); }},
    Function1{"log", [](double x) { return std::log(x); }},
    Function1{"log2", [](double x) { return std::log2(x); }},
    Function1{"log10", [](double x) { return std::log10(x); }},
    Function1{"sqrt", [](double x) { return std::sqrt(x); }},
    Function1{"abs", [](double x) { return std::abs(x); }},
    Function1{"sign", [](double x) { return x > 0.0   ? 1.0
                                            : x < 0.0 ? -1.0
                                                      : 0.0 * x; }},
    Function1{"floor", [](double x) { return std::floor(x); }},
    Function1{"ceil", [](double x) { return std::ceil(x); }},
    Function1{"round", [](double x) { return std::round(x); }},
    Function1{"not", [](double x) { return std::isnan(x) ? x
                                           : x == 0.0    ? 1.0
                                                         : 0.0; }},
    Function1{"rad", [](double x) { return x * pi / 180.0; }},
    Function1{"deg", [](double x) { return x * 180.0 / pi; }},
    Function1{"wrap", [](double x) { return std::remainder(x, 2.0 * pi); }},
};

struct Function2 {
  const char* name;
  double (*value)(double, double);
};
constexpr std::array functions2{
    Function2{"atan2", [](double y, double x) { return std::atan2(y, x); }},
    Function2{"hypot", [](double x, double y) { return std::hypot(x, y); }},
    Function2{"mod", [](double x, double y) { return x - y * std::floor(x / y); }},
};

struct Rotation {
  const char* name;
  double (*value)(double, double, double, double, double, double);
};
constexpr std::array rotations{
    Rotation{"rotate_x",
             [](double a, double b, double c, double x, double y, double z) {
               return rotated(a, b, c, {x, y, z}).x;
             }},
    Rotation{"rotate_y",
             [](double a, double b, double c, double x, double y, double z) {
               return rotated(a, b, c, {x, y, z}).y;
             }},
    Rotation{"rotate_z",
             [](double a, double b, double c, double x, double y, double z) {
               return rotated(a, b, c, {x, y, z}).z;
             }},
};

}  // namespace

void define_functions(mu::Parser& parser) {
  parser.ClearFun();
  parser.ClearConst();
  parser.DefineConst("pi", pi);
  for (const Function1& f : functions1) parser.DefineFun(f.name, f.value);
  for (const Function2& f : functions2) parser.DefineFun(f.name, f.value);
  for (const Rotation& f : rotations) parser.DefineFun(f.name, f.value);
  parser.DefineFun("yaw", yaw_of);
  parser.DefineFun("min", smallest);
  parser.DefineFun("max", largest);
}

const std::vector<std::string>& function_names() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all{"yaw", "min", "max", "diff", "unwrap"};
    for (const Function1& f : functions1) all.emplace_back(f.name);
    for (const Function2& f : functions2) all.emplace_back(f.name);
    for (const Rotation& f : rotations) all.emplace_back(f.name);
    return all;
  }();
  return names;
}

}  // namespace modebank
