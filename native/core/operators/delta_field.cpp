// SPDX-License-Identifier: GPL-3.0-or-later
#include "operators/delta_field.hpp"

namespace lamina {
namespace {

template <int size>
Eigen::Array<double, size, 1> repeated(const Eigen::Array<double, size, 1>& pass) {
  return (pass < 1.0).select(1.0 / (1.0 - pass), 1.0);
}

std::vector<Deltas> deltas_of(const std::vector<ScatteringFunction>& layers) {
  std::vector<Deltas> own;
  for (const ScatteringFunction& layer : layers) {
    own.push_back({layer.reflect_above.delta, layer.transmit.delta, layer.reflect_below.delta});
  }
  return own;
}

}  // namespace

template <int size>
DeltasOf<size> joined(const DeltasOf<size>& above, const DeltasOf<size>& below) {
  const auto between = repeated<size>(above.reflect_below * below.reflect_above);
  return {above.reflect_above + above.transmit * below.reflect_above * between * above.transmit,
          below.transmit * between * above.transmit,
          below.reflect_below + below.transmit * above.reflect_below * between * below.transmit};
}

template <int size>
DeltaFieldOf<size>::DeltaFieldOf(const std::vector<DeltasOf<size>>& own) {
  const std::size_t count = own.size();
  if (count == 0) {
    return;
  }
  const auto nothing = DeltasOf<size>::nothing(own.front().transmit.size());
  std::vector<DeltasOf<size>> below(count + 1, nothing);  // below[k]: layers k to the end
  for (std::size_t k = count; k-- > 0;) {
    below[k] = joined(own[k], below[k + 1]);
  }
  from_above.reserve(count);
  from_below.reserve(count);
  DeltasOf<size> over = nothing;  // layers 0 to k - 1
  for (std::size_t k = 0; k < count; ++k) {
    const DeltasOf<size>& layer = own[k];
    const DeltasOf<size>& under = below[k + 1];
    const auto round_trip = repeated<size>(over.reflect_below * layer.transmit * under.reflect_above * layer.transmit);
    const typename DeltasOf<size>::Share down = over.transmit * round_trip;
    const typename DeltasOf<size>::Share up = under.transmit * round_trip;
    from_above.push_back({down, down * layer.transmit * under.reflect_above});
    from_below.push_back({up * layer.transmit * over.reflect_below, up});
    over = joined(over, layer);
  }
}

template <int size>
DeltaFieldOf<size>::DeltaFieldOf(const std::vector<ScatteringFunction>& layers)
  requires(size == Eigen::Dynamic)
    : DeltaFieldOf(deltas_of(layers)) {}

template Deltas joined(const Deltas& above, const Deltas& below);
template struct DeltaFieldOf<1>;
template struct DeltaFieldOf<Eigen::Dynamic>;

}  // namespace lamina
