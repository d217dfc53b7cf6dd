// SPDX-License-Identifier: GPL-3.0-or-later
#include "operators/delta_field.hpp"

namespace lamina {
namespace {

Eigen::ArrayXd repeated(const Eigen::ArrayXd& pass) { return (pass < 1.0).select(1.0 / (1.0 - pass), 1.0); }

std::vector<Deltas> deltas_of(const std::vector<ScatteringFunction>& layers) {
  std::vector<Deltas> own;
  for (const ScatteringFunction& layer : layers) {
    own.push_back({layer.reflect_above.delta, layer.transmit.delta, layer.reflect_below.delta});
  }
  return own;
}

}  // namespace

Deltas joined(const Deltas& above, const Deltas& below) {
  const Eigen::ArrayXd between = repeated(above.reflect_below * below.reflect_above);
  return {above.reflect_above + above.transmit * below.reflect_above * between * above.transmit,
          below.transmit * between * above.transmit,
          below.reflect_below + below.transmit * above.reflect_below * between * below.transmit};
}

DeltaField::DeltaField(const std::vector<ScatteringFunction>& layers) : DeltaField(deltas_of(layers)) {}

DeltaField::DeltaField(const std::vector<Deltas>& own) {
  const std::size_t count = own.size();
  if (count == 0) {
    return;
  }
  const Deltas nothing = Deltas::nothing(own.front().transmit.size());
  std::vector<Deltas> above(count + 1, nothing);  // above[k]: layers 0 to k - 1
  std::vector<Deltas> below(count + 1, nothing);  // below[k]: layers k to the end
  for (std::size_t k = 0; k < count; ++k) {
    above[k + 1] = joined(above[k], own[k]);
    below[count - 1 - k] = joined(own[count - 1 - k], below[count - k]);
  }
  for (std::size_t k = 0; k < count; ++k) {
    const Deltas& over = above[k];
    const Deltas& layer = own[k];
    const Deltas& under = below[k + 1];
    const Eigen::ArrayXd round_trip =
        repeated(over.reflect_below * layer.transmit * under.reflect_above * layer.transmit);
    const Eigen::ArrayXd down = over.transmit * round_trip;
    const Eigen::ArrayXd up = under.transmit * round_trip;
    from_above.push_back({down, down * layer.transmit * under.reflect_above});
    from_below.push_back({up * layer.transmit * over.reflect_below, up});
  }
}

}  // namespace lamina
