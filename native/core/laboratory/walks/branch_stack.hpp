// SPDX-License-Identifier: GPL-3.0-or-later
// The branches of a scattering walk that are still to be estimated.
#pragma once
#include <vector>

namespace lamina {

/// A walk of the scattering equation follows one branch at a time; the others wait here.
template <typename Branch>
class BranchStack {
 public:
  void push(const Branch& branch) { waiting_.push_back(branch); }

  /// Moves the last waiting branch to `next`; false if none waits.
  bool pop(Branch& next) {
    if (waiting_.empty()) {
      return false;
    }
    next = waiting_.back();
    waiting_.pop_back();
    return true;
  }

 private:
  std::vector<Branch> waiting_;
};

}  // namespace lamina
