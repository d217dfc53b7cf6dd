// SPDX-License-Identifier: GPL-3.0-or-later
#include "rough/shared_surface.hpp"

#include <map>
#include <mutex>
#include <vector>

namespace lamina {
namespace {

/// All parameters on which the boundary's operators depend.
using Key = std::vector<double>;

Key key_of(const Facets& facets, const DirectionSet& set, double ior_above, int orders, double fineness) {
  Key key{facets.alpha,
          static_cast<double>(facets.distribution),
          static_cast<double>(facets.correlated),
          static_cast<double>(facets.compensate),
          static_cast<double>(facets.retro),
          ior_above,
          static_cast<double>(orders),
          fineness};
  for (const DirectionSet::Range& range : set.ranges()) {
    key.insert(key.end(),
               {range.ior, range.nodes.low(), range.nodes.high(), static_cast<double>(range.nodes.mu.size())});
  }
  return key;
}

void add_film(Key& key, const Film* film) {
  if (film != nullptr) {
    key.insert(key.end(), film->key().begin(), film->key().end());
  }
}

template <typename Make>
std::shared_ptr<const RoughSurface> known_or_made(const Key& key, const Make& make) {
  static std::mutex lock;
  static std::map<Key, std::weak_ptr<const RoughSurface>> known;
  {
    const std::scoped_lock guard(lock);
    if (const auto place = known.find(key); place != known.end()) {
      if (std::shared_ptr<const RoughSurface> surface = place->second.lock()) {
        return surface;
      }
    }
  }
  std::shared_ptr<const RoughSurface> surface = make();
  const std::scoped_lock guard(lock);
  std::erase_if(known, [](const auto& entry) { return entry.second.expired(); });
  known[key] = surface;
  return surface;
}

}  // namespace

std::shared_ptr<const RoughSurface> shared_surface(const Interface& interface, const DirectionSet& set,
                                                   double ior_above, int orders, ThreadPool& pool, double fineness) {
  Key key = key_of(interface.facets, set, ior_above, orders, fineness);
  key.push_back(interface.ior);
  add_film(key, interface.film.get());
  return known_or_made(
      key, [&] { return std::make_shared<RoughSurface>(interface, set, ior_above, orders, pool, fineness); });
}

std::shared_ptr<const RoughSurface> shared_surface(const Base& base, const DirectionSet& set, double ior_above,
                                                   int orders, ThreadPool& pool, double fineness, double tolerance) {
  Key key = key_of(base.facets, set, ior_above, orders, fineness);
  key.insert(key.end(), {base.ior.real(), base.ior.imag(), base.reflectance, tolerance});
  add_film(key, base.film.get());
  if (base.measured) {
    key.insert(key.end(), base.measured->table().begin(), base.measured->table().end());
  }
  if (base.law) {
    const std::vector<double> sockets = base.law->key();
    key.insert(key.end(), sockets.begin(), sockets.end());
  }
  return known_or_made(
      key, [&] { return std::make_shared<RoughSurface>(base, set, ior_above, orders, pool, fineness, tolerance); });
}

}  // namespace lamina
