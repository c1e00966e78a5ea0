#include "io/import/run_roles.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "ident/base/natural_order.hpp"
#include "ident/base/nearest_name.hpp"
#include "modebank/base/error.hpp"

namespace modebank {

namespace {

/// Natural order: run_2 comes before run_10.
std::string listed(const std::vector<std::string>& runs) {
  std::vector<std::string> names;
  for (const std::size_t i : natural_order(runs)) names.push_back(runs[i]);
  return fmt::format("{}", fmt::join(names, ", "));
}

void assign(const std::vector<std::string>& runs, const std::vector<std::string>& named, Role role,
            std::vector<std::optional<Role>>& roles) {
  for (const std::string& name : named) {
    const auto found = std::find(runs.begin(), runs.end(), name);
    if (found == runs.end())
      throw ConfigurationError(fmt::format("data.{}: unknown run \"{}\"{}; runs: {}", name_of(role), name,
                                           did_you_mean(name, runs), listed(runs)));
    auto& assigned = roles[static_cast<std::size_t>(found - runs.begin())];
    if (assigned)
      throw ConfigurationError(fmt::format("data.{}: run \"{}\" is already named in data.{}; runs: {}", name_of(role),
                                           name, name_of(*assigned), listed(runs)));
    assigned = role;
  }
}

}  // namespace

std::vector<std::optional<Role>> assign_roles(const std::vector<std::string>& runs,
                                              const std::vector<std::string>& train,
                                              const std::vector<std::string>& test) {
  std::vector<std::optional<Role>> roles(runs.size());
  assign(runs, train, Role::train, roles);
  assign(runs, test, Role::test, roles);
  if (!train.empty() && !test.empty()) return roles;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    if (roles[i]) continue;
    if (train.empty() && test.empty())
      roles[i] = i % 2 == 0 ? Role::train : Role::test;
    else
      roles[i] = train.empty() ? Role::train : Role::test;
  }
  return roles;
}

}  // namespace modebank
