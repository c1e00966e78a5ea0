#include "ident/base/interruption.hpp"

#include <utility>

namespace modebank {

namespace {

thread_local const std::function<void()>* current_hook = nullptr;

}  // namespace

Interruptible::Interruptible(std::function<void()> hook) : hook_(std::move(hook)), outer_(current_hook) {
  current_hook = &hook_;
}

Interruptible::~Interruptible() { current_hook = outer_; }

void interruption_point() {
  if (current_hook != nullptr) (*current_hook)();
}

}  // namespace modebank
