// SPDX-License-Identifier: GPL-3.0-or-later
#include "oriented/shared_oriented_surface.hpp"

#include <map>
#include <mutex>
#include <vector>

namespace lamina {

std::shared_ptr<const OrientedSurface> shared_oriented_surface(const Facets& facets, const FacetOptics& optics,
                                                               const DirectionSet& set, const AzimuthBlocks& azimuths,
                                                               int fineness, ThreadPool& pool) {
  static std::mutex lock;
  static std::map<std::vector<double>, std::weak_ptr<const OrientedSurface>> known;
  std::vector<double> key{facets.alpha,
                          facets.across(),
                          facets.angle,
                          static_cast<double>(facets.distribution),
                          static_cast<double>(facets.correlated),
                          static_cast<double>(facets.compensate),
                          optics.here,
                          optics.beyond,
                          static_cast<double>(azimuths.orders),
                          static_cast<double>(azimuths.mirrored),
                          static_cast<double>(fineness)};
  if (optics.metal) {
    key.insert(key.end(), {optics.metal->real(), optics.metal->imag()});
  }
  if (optics.film) {
    key.insert(key.end(), optics.film->key().begin(), optics.film->key().end());
  }
  for (const DirectionSet::Range& range : set.ranges()) {
    key.insert(key.end(),
               {range.ior, range.nodes.low(), range.nodes.high(), static_cast<double>(range.nodes.mu.size())});
  }
  {
    const std::scoped_lock guard(lock);
    if (const auto place = known.find(key); place != known.end()) {
      if (std::shared_ptr<const OrientedSurface> surface = place->second.lock()) {
        return surface;
      }
    }
  }
  const auto surface = std::make_shared<const OrientedSurface>(facets, optics, set, azimuths, fineness, pool);
  const std::scoped_lock guard(lock);
  std::erase_if(known, [](const auto& entry) { return entry.second.expired(); });
  known[key] = surface;
  return surface;
}

}  // namespace lamina
