// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <optional>
#include <vector>

#include "walk.hpp"
#include "walk_stack.hpp"

namespace lamina {

/// Random walk of light between the elements of a stack. What light does inside a medium is left to derived
/// classes; boundaries and the base are the same for all.
///
/// Next events: wherever light is scattered, what leaves without being scattered again is added in closed form along
/// the one direction wanted, through smooth boundaries and all their mirror images (WalkBeam); the walk then goes on
/// with light that is scattered again. All that is scattered where the beam from outside arrives is known
/// before any walk: a walk begins where the beam is first scattered.
///
/// Where the exit lies behind a rough boundary, the direction wanted is spread into a lobe within. Each walk then
/// samples a direction of that lobe, backwards, and adds what would leave along it.
class StackWalk : public Walk {
 public:
  double sample(Rng& rng, std::uint64_t& events) const override;

 protected:
  StackWalk(WalkStack stack, const WalkTarget& target);

  /// Lays the starts; derived classes call it when they are ready for it.
  void begin();
  /// No walk is to be taken: what is known before any walk is the value. A sample then has no events.
  void take_no_walk() { starts_.clear(); }

  /// Ways out of an element: rays that leave its top and its bottom and end in the direction wanted.
  struct Exit {
    Ray up;
    Ray down;
    double up_share;
    double down_share;
  };

  /// Light as it goes on.
  struct Light {
    Ray ray;
    double weight;
  };

  /// Light comes to a medium's face along its ray, to the top when it runs down. Adds what leaves it for the exit
  /// and follows it through; false when it is lost. With `first` its power counts as scattered for certain, and as
  /// added already.
  virtual bool cross(std::size_t element, const Exit& out, Light& light, bool first, double& score, Rng& rng,
                     std::uint64_t& events) const = 0;
  /// What leaves for the exit when light of unit power comes so: what `cross` would add for the first passage.
  virtual double leaving(std::size_t element, const Exit& out, const Ray& in) const = 0;
  /// Share of the light that is taken to be scattered when it comes so.
  virtual double scattered_share(std::size_t element, const Ray& in) const = 0;

  const WalkStack& stack() const { return stack_; }
  bool is_flux() const { return target_.flux; }

 private:
  using Element = WalkStack::Element;

  struct Start {
    std::size_t element;
    Ray in;
    double arriving;
    double until;  ///< sum of powers up to this one
  };

  std::vector<Exit> exits_from(const WalkBeam& back) const;
  double sample_exits(std::vector<Exit>& exits, Rng& rng) const;
  bool meet(std::size_t element, const Exit& out, Light& light, bool first, double& score, Rng& rng,
            std::uint64_t& events) const;
  double surface_leaving(std::size_t element, const Exit& out, const Ray& in) const;
  double first_leaving(std::size_t element, const Exit& out, const Ray& in) const;
  void add_start(std::size_t element, const Ray& in, double power);

  WalkStack stack_;
  WalkTarget target_;
  std::vector<Exit> exits_;                ///< in the direction wanted
  std::optional<std::size_t> rough_exit_;  ///< the element before it, if rough: the only one that sees it
  std::vector<Start> starts_;
  double known_ = 0.0;  ///< what needs no walk
  double power_ = 0.0;  ///< of all starts
};

}  // namespace lamina
