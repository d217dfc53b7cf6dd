// SPDX-License-Identifier: GPL-3.0-or-later
// The lobes of a rough boundary from single directions to the nodes.
#pragma once
#include <Eigen/Core>
#include <memory>
#include <mutex>
#include <vector>

#include "operators/directions.hpp"

namespace lamina {

/// Projections of outgoing light, reflected and transmitted, by order: [live node of that medium, incoming direction].
struct LobeColumns {
  std::vector<Eigen::MatrixXd> reflected;
  std::vector<Eigen::MatrixXd> transmitted;
};

/// Keeps the columns of the last targets, because the rows of a lookup table use the same directions. Thread-safe.
class LastColumns {
 public:
  /// The columns of the targets, made by `make(mu, common)` if they are not those of the last call. `common`: C of
  /// Directions.
  template <typename Make>
  std::shared_ptr<const LobeColumns> known_or_made(const Directions& directions, const Make& make) {
    const Eigen::VectorXd mu = directions.mu.tail(directions.targets);
    const Eigen::VectorXd common = directions.ior * directions.scale.tail(directions.targets);
    {
      const std::scoped_lock guard(lock_);
      if (columns_ && mu_.size() == mu.size() && mu_ == mu && common_ == common) {
        return columns_;
      }
    }
    const auto columns = std::make_shared<const LobeColumns>(make(mu, common));
    const std::scoped_lock guard(lock_);
    mu_ = mu;
    common_ = common;
    columns_ = columns;
    return columns;
  }

 private:
  std::mutex lock_;
  Eigen::VectorXd mu_;
  Eigen::VectorXd common_;
  std::shared_ptr<const LobeColumns> columns_;
};

}  // namespace lamina
