// SPDX-License-Identifier: GPL-3.0-or-later
// The common part of all walks through a stack: boundaries, base, and the loop over elements.
#pragma once
#include <optional>
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
class StackWalk : public Walk {
 public:
  double sample(Rng& rng, std::uint64_t& events) const override;

 protected:
  StackWalk(WalkElements stack, const WalkTarget& target);

  /// Sets up the starts of walks; derived classes call it at the end of their constructors.
  void begin();
  /// Drops all walks, so that the closed-form part alone is the result. Samples then have no events.
  void take_no_walk() { starts_.clear(); }

  /// The specular paths from an element to the target direction: rays from its top and from its bottom, and their
  /// shares.
  struct Exit {
    Ray up;
    Ray down;
    double up_share;
    double down_share;
  };

  /// The light of a walk: its direction and weight.
  struct Light {
    Ray ray;
    double weight;
  };

  /// Follows light through a medium from the face where it arrives, and adds its next events to the score; false if the
  /// light is lost. With `first` the light is certain to scatter, and its first next event is already added.
  virtual bool cross(std::size_t element, const Exit& out, Light& light, bool first, double& score, Rng& rng,
                     std::uint64_t& events) const = 0;
  /// The next-event estimate for the first passage of light of unit power.
  virtual double leaving(std::size_t element, const Exit& out, const Ray& in) const = 0;
  /// The share of incoming light that counts as scattered.
  virtual double scattered_share(std::size_t element, const Ray& in) const = 0;

  const WalkElements& stack() const { return stack_; }
  bool is_flux() const { return target_.flux; }

 private:
  using Element = WalkElements::Element;

  struct Start {
    std::size_t element;
    Ray in;
    double arriving;
    double until;  ///< sum of powers up to this one
  };

  std::vector<Exit> exits_from(const WalkBeam& back) const;
  static void add_exit(Exit& sum, const Exit& more);
  bool sample_exits(std::vector<Exit>& beyond, Rng& rng) const;
  bool meet(std::size_t element, const Exit& out, Light& light, bool first, double& score, Rng& rng,
            std::uint64_t& events) const;
  double surface_leaving(std::size_t element, const Exit& out, const Ray& in) const;
  double first_leaving(std::size_t element, const Exit& out, const Ray& in) const;
  void add_start(std::size_t element, const Ray& in, double power);

  WalkElements stack_;
  WalkTarget target_;
  std::vector<Exit> exits_;         ///< to the target direction, by element
  std::vector<std::size_t> rough_;  ///< rough boundaries inside, from the target's side on
  bool ends_rough_ = false;         ///< true if the boundary before the target direction is rough
  std::vector<Start> starts_;
  double known_ = 0.0;  ///< closed-form part of the result
  double power_ = 0.0;  ///< total power of all starts
};

}  // namespace lamina
