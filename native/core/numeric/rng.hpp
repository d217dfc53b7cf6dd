// SPDX-License-Identifier: GPL-3.0-or-later
// Random numbers of one sample, independent of other samples.
#pragma once
#include <bit>
#include <cstdint>

namespace lamina {

/// Random numbers of one sample: xoshiro256++ (Blackman and Vigna 2019). splitmix64 fills its state from the seed and
/// the sample's number, so that any thread may draw samples in any order.
class Rng {
 public:
  Rng(std::uint64_t seed, std::uint64_t sample) {
    std::uint64_t state = mixed(seed) ^ (sample * 0x9e3779b97f4a7c15U);
    for (std::uint64_t& word : state_) {
      state += 0x9e3779b97f4a7c15U;
      word = mixed(state);
    }
  }

  std::uint64_t bits() {
    const std::uint64_t result = std::rotl(state_[0] + state_[3], 23) + state_[0];
    const std::uint64_t shifted = state_[1] << 17U;
    state_[2] ^= state_[0];
    state_[3] ^= state_[1];
    state_[1] ^= state_[2];
    state_[0] ^= state_[3];
    state_[2] ^= shifted;
    state_[3] = std::rotl(state_[3], 45);
    return result;
  }

  /// Uniform in (0, 1), both ends excluded, so that logarithms and divisions are safe.
  double uniform() { return (static_cast<double>(bits() >> 12U) + 0.5) * 0x1.0p-52; }

 private:
  static std::uint64_t mixed(std::uint64_t z) {
    z = (z ^ (z >> 30U)) * 0xbf58476d1ce4e5b9U;
    z = (z ^ (z >> 27U)) * 0x94d049bb133111ebU;
    return z ^ (z >> 31U);
  }

  std::uint64_t state_[4] = {};
};

}  // namespace lamina
