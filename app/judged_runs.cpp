#include "app/judged_runs.hpp"

namespace modebank::app {

const SummaryRow* pooled_row(const Archive& archive, const std::string& filter, Role role) {
  for (const SummaryRow& row : archive.summary)
    if (row.filter == filter && row.role == role && row.run == "*") return &row;
  return nullptr;
}

Role judged_role(const Archive& archive) { return pooled_row(archive, "bank", Role::test) ? Role::test : Role::train; }

const char* words_for(Role role) { return role == Role::test ? "held-out" : "training"; }

}  // namespace modebank::app
