#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <sstream>
#include <string>

#include "modebank/ident/auto_diff_motion_model.hpp"
#include "modebank/ident/windows.hpp"
#include "tests/ident/public_run.hpp"
#include "tests/support/paths.hpp"

// Nonlinear regression sets of NIST's StRD through the public API: a response y of one predictor u. y is passed as a
// "state" that does not depend on its past.
namespace modebank {
namespace {

/// y = Function(b, u).
template <class Function>
struct Regression {
  template <class T>
  void operator()(const T* b, const T*, const T* u, double, T* next) const {
    next[0] = Function()(b, u[0]);
  }
};

struct Chwirut2 {
  template <class T>
  T operator()(const T* b, const T& x) const {
    return exp(-b[0] * x) / (b[1] + b[2] * x);
  }
};
struct DanWood {
  template <class T>
  T operator()(const T* b, const T& x) const {
    return b[0] * pow(x, b[1]);
  }
};
struct Gauss2 {
  template <class T>
  T operator()(const T* b, const T& x) const {
    const auto bell = [&](int i) { return b[i] * exp(-(x - b[i + 1]) * (x - b[i + 1]) / (b[i + 2] * b[i + 2])); };
    return b[0] * exp(-b[1] * x) + bell(2) + bell(5);
  }
};
struct CubicOverCubic {  // Hahn1, Thurber
  template <class T>
  T operator()(const T* b, const T& x) const {
    return (b[0] + x * (b[1] + x * (b[2] + x * b[3]))) / (1.0 + x * (b[4] + x * (b[5] + x * b[6])));
  }
};
struct Kirby2 {
  template <class T>
  T operator()(const T* b, const T& x) const {
    return (b[0] + x * (b[1] + x * b[2])) / (1.0 + x * (b[3] + x * b[4]));
  }
};
struct Lanczos3 {
  template <class T>
  T operator()(const T* b, const T& x) const {
    return b[0] * exp(-b[1] * x) + b[2] * exp(-b[3] * x) + b[4] * exp(-b[5] * x);
  }
};
struct Mgh09 {
  template <class T>
  T operator()(const T* b, const T& x) const {
    return b[0] * (x * x + x * b[1]) / (x * x + x * b[2] + b[3]);
  }
};
struct Misra1a {
  template <class T>
  T operator()(const T* b, const T& x) const {
    return b[0] * (1.0 - exp(-b[1] * x));
  }
};
struct Rat43 {
  template <class T>
  T operator()(const T* b, const T& x) const {
    return b[0] / pow(1.0 + exp(b[1] - b[2] * x), 1.0 / b[3]);
  }
};

struct NistSet {
  Eigen::MatrixXd starts;  ///< p x 2, the harder of the two starts first
  Eigen::VectorXd certified, standard_deviation;
  RecordedRun run;
};

std::vector<double> numbers_of(const std::string& text) {
  std::istringstream stream(text);
  std::vector<double> numbers;
  for (double value; stream >> value;) numbers.push_back(value);
  return numbers;
}

NistSet read_nist(const std::string& name) {
  std::ifstream file(test::shared_data_dir() / "nist" / (name + ".dat"));
  NistSet set;
  std::vector<std::vector<double>> parameters, data;
  for (std::string line; std::getline(file, line);) {
    if (const auto equals = line.find('='); equals != std::string::npos && line.find("b") < equals) {
      const std::vector<double> row = numbers_of(line.substr(equals + 1));
      if (row.size() == 4) parameters.push_back(row);
    } else if (const std::vector<double> row = numbers_of(line); row.size() == 2) {
      data.push_back(row);
    }
  }
  using Eigen::Index;
  const auto p = static_cast<Index>(parameters.size()), N = static_cast<Index>(data.size());
  set.starts.resize(p, 2);
  set.certified.resize(p);
  set.standard_deviation.resize(p);
  for (Index j = 0; j < p; ++j) {
    set.starts.row(j) << parameters[j][0], parameters[j][1];
    set.certified(j) = parameters[j][2];
    set.standard_deviation(j) = parameters[j][3];
  }
  Eigen::MatrixXd state = Eigen::MatrixXd::Zero(1, N + 1), input = Eigen::MatrixXd::Zero(1, N + 1);
  for (Index k = 0; k < N; ++k) {
    state(0, k + 1) = data[k][0];
    input(0, k) = data[k][1];
  }
  set.run = test::public_run(state, input);
  return set;
}

/// Number of correct significant digits, as defined by NIST.
double digits(const Eigen::VectorXd& value, const Eigen::VectorXd& certified) {
  return -std::log10(((value - certified).array() / certified.array()).abs().maxCoeff() + 1e-16);
}

template <class Function, int P>
void expect_certified(const std::string& name, int start = 0) {
  const NistSet set = read_nist(name);
  ASSERT_EQ(set.certified.size(), P) << name;
  std::vector<ModelParameter> b(P);
  for (int j = 0; j < P; ++j) {
    b[j].name = "b" + std::to_string(j + 1);
    b[j].start = set.starts(j, start);
  }
  const auto model = make_auto_diff_model<1, 1, P>(Regression<Function>(), "regression", b);
  FitOptions options;
  options.loss = Loss::trivial;
  options.prior = Prior::none;
  options.length = std::ssize(set.run.time_s) - 1;
  options.max_iterations = 10'000;
  const ident::Windows fit = ident::fit_windows({{set.run}, {}, {}}, options, *model);
  const Eigen::VectorXd theta = view(fit.theta), sd = view(fit.covariance).reshaped(P, P).diagonal().cwiseSqrt();
  EXPECT_EQ(fit.status.at(0), FitStatus::converged) << name;
  const double parameter_digits = digits(theta, set.certified);
  const double sd_digits = digits(sd, set.standard_deviation);
  EXPECT_GE(parameter_digits, 6.0) << name << ": " << theta.transpose();
  EXPECT_GE(sd_digits, 5.0) << name << ": " << sd.transpose();
  ::testing::Test::RecordProperty(name, std::to_string(parameter_digits) + " / " + std::to_string(sd_digits));
}

TEST(Nist, CertifiedValuesFromTheHarderStart) {
  MODEBANK_NEEDS_SHARED_DATA();
  expect_certified<Chwirut2, 3>("Chwirut2");
  expect_certified<DanWood, 2>("DanWood");
  expect_certified<Gauss2, 8>("Gauss2");
  expect_certified<CubicOverCubic, 7>("Hahn1");
  expect_certified<Kirby2, 5>("Kirby2");
  expect_certified<Lanczos3, 6>("Lanczos3");
  expect_certified<Mgh09, 4>("MGH09");
  expect_certified<Misra1a, 2>("Misra1a");
  expect_certified<Rat43, 4>("Rat43");
  expect_certified<CubicOverCubic, 7>("Thurber");
}

}  // namespace
}  // namespace modebank
