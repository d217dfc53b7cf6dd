// SPDX-License-Identifier: GPL-3.0-or-later
// The common part of all walks through a stack: boundaries, base, and the loop over elements.
#pragma once
#include <algorithm>
#include <vector>

#include "walks/walk.hpp"
#include "walks/walk_elements.hpp"

namespace lamina {

/// Random walk of light between the elements of a stack. Derived classes scatter light inside media; boundaries and the
/// base are the same for all.
///
/// Next-event estimation: at each scattering, the light that leaves towards the target direction without another
/// scattering is added in closed form, through smooth boundaries with all specular reflections (WalkBeam). The walk
/// continues with the light that is scattered again. The first scattering of the beam from outside is computed in
/// advance, and walks start there.
///
/// Behind a rough boundary the target direction becomes a lobe inside the stack. Each walk samples one direction of the
/// lobe, backwards, for its next events, and again behind each further rough boundary. Light that crosses such a
/// boundary towards the target was counted then, where the light was last scattered. The lobe's value for the
/// directions of the walk would be found by chance: next to a similar index a lobe is much narrower than its facets.
///
/// Behind narrow facets, walks also sample directions of the lobe about a known direction, and so on behind further
/// narrow facets: paths from the target, traced backwards. Every scattering is connected with each of them. A path of
/// light is thus found in several ways, which differ in the scattering where both parts meet. The balance heuristic
/// (Veach and Guibas 1995) combines all ways. Its densities are relative to n^2 times the projected solid angle, which
/// smooth boundaries and mirrors conserve; then facets have the same density, their value, in both directions.
class StackWalk : public Walk {
 public:
  double sample(Rng& rng, std::uint64_t& events) const override;

 protected:
  StackWalk(WalkElements stack, const WalkTarget& target);

  /// Sets up the starts of walks; derived classes call it at the end of their constructors.
  void begin();
  /// Drops all walks, so that the closed-form part alone is the result. Samples then have no events.
  void take_no_walk() { starts_.clear(); }

  /// A path from an element to the target direction. It leaves the element's top if the ray goes up, else the bottom.
  struct Exit {
    Ray ray;
    double share;
    /// With the value of a connection as factor: the sum of the densities of the ways that meet at a later scattering,
    /// relative to the density of this connection. 0 for known paths.
    double later = 0.0;

    bool is_known() const { return later == 0.0; }
    bool is_up() const { return ray.z > 0.0; }
    /// `scattered`, the value of a connection, times the balance heuristic's weight, for light without earlier
    /// scattering by narrow facets.
    double weighed(double scattered) const { return scattered / (1.0 + scattered * later); }
  };
  using Exits = std::vector<Exit>;

  /// The light of a walk.
  struct Light {
    Ray ray;
    double weight;
    double earlier = 0.0;  ///< as Exit::later, for the ways that meet at an earlier scattering; only if has_lobes()
  };

  /// Follows light through a medium from the face where it arrives, and adds its next events to the score; false if the
  /// light is lost. With `first` the light is certain to scatter, and its first next event is already added.
  virtual bool cross(std::size_t element, const Exits& out, Light& light, bool first, double& score, Rng& rng,
                     std::uint64_t& events) const = 0;
  /// The next-event estimate for the first passage of light of unit power.
  virtual double leaving(std::size_t element, const Exits& out, const Ray& in) const = 0;
  /// The share of incoming light that counts as scattered.
  virtual double scattered_share(std::size_t element, const Ray& in) const = 0;

  const WalkElements& stack() const { return stack_; }
  bool is_flux() const { return target_.flux; }
  /// Light::earlier of light that was scattered with this density, at any scattering but narrow facets.
  static double earlier(double density) { return 1.0 / std::max(density, kLeastDensity); }
  /// True if rough boundaries make sampled paths to the target.
  bool has_lobes() const { return has_rough_ && !target_.flux; }

 private:
  using Element = WalkElements::Element;

  static constexpr double kLeastDensity = 1e-30;  // replaces a density that rounding has made 0

  struct Start {
    std::size_t element;
    Ray in;
    double arriving;
    double until;  ///< sum of powers up to this one
  };

  static void add_exits(std::vector<Exits>& sum, const WalkBeam& back, const Exit& like);
  bool sample_boundaries(std::vector<Exits>& exits, Rng& rng) const;
  void sample_lobes(std::vector<Exits>& exits, Rng& rng) const;
  /// Adds the path before `out`, whose last scattering at this element came from the direction `before`, and so on.
  void follow_back(std::size_t element, Exit out, ScatteringSurface::Outcome before, std::vector<Exits>& exits,
                   Rng& rng) const;
  bool is_sampled(std::size_t element, const Exit& out, bool reflected) const;
  bool is_sampled_through(std::size_t element, const Exit& out) const;
  bool target_is_above() const { return target_.path == Path::kReflect; }
  bool meet(std::size_t element, const Exits& out, Light& light, bool first, double& score, Rng& rng,
            std::uint64_t& events) const;
  double surface_leaving(std::size_t element, const Exits& out, const Ray& in) const;
  bool is_narrow(std::size_t element) const;
  double met_leaving(std::size_t element, const Exits& out, const Light& light) const;
  double first_leaving(std::size_t element, const Exits& out, const Ray& in) const;
  void add_start(std::size_t element, const Ray& in, double power);

  WalkElements stack_;
  WalkTarget target_;
  std::vector<Exits> exits_;        ///< to the target direction, by element
  std::vector<std::size_t> rough_;  ///< rough boundaries inside, from the target's side on
  bool ends_rough_ = false;         ///< true if the boundary before the target direction is rough
  bool has_rough_ = false;
  std::vector<Start> starts_;
  double known_ = 0.0;  ///< closed-form part of the result
  double power_ = 0.0;  ///< total power of all starts
};

}  // namespace lamina
