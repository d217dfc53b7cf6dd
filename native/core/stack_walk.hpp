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
class StackWalk : public Walk {
 public:
  double sample(Rng& rng, std::uint64_t& events) const override;

 protected:
  StackWalk(WalkStack stack, const WalkTarget& target);

  /// Lays the starts; derived classes call it when they are ready for it.
  void begin();

  /// Light as it goes on.
  struct Light {
    Ray ray;
    double weight;
  };

  /// Light comes to a medium's face along its ray, to the top when it runs down. Adds what leaves it for the exit
  /// and follows it through; false when it is lost. With `first` its power counts as scattered for certain, and as
  /// added already.
  virtual bool cross(std::size_t element, Light& light, bool first, double& score, Rng& rng,
                     std::uint64_t& events) const = 0;
  /// What leaves for the exit when light of unit power comes so: the same as `cross` adds for the first passage.
  virtual double leaving(std::size_t element, const Ray& in) const = 0;
  /// Share of the light that is taken to be scattered when it comes so.
  virtual double scattered_share(std::size_t element, const Ray& in) const = 0;

  const WalkStack& stack() const { return stack_; }
  bool is_flux() const { return target_.flux; }
  /// Ways out of an element: rays that leave its top and its bottom and end in the direction wanted.
  struct Exit {
    Ray up;
    Ray down;
    double up_share;
    double down_share;
  };
  const Exit& exit(std::size_t element) const { return exits_[element]; }

 private:
  using Element = WalkStack::Element;

  struct Start {
    std::size_t element;
    Ray in;
    double until;  ///< sum of powers up to this one
  };

  bool meet(std::size_t element, Light& light, bool first, double& score, Rng& rng, std::uint64_t& events) const;
  bool meet_smooth(std::size_t element, Light& light, Rng& rng) const;
  double surface_leaving(std::size_t element, const Ray& in) const;
  void add_start(std::size_t element, const Ray& in, double power);

  WalkStack stack_;
  WalkTarget target_;
  std::vector<Exit> exits_;
  std::vector<Start> starts_;
  double known_ = 0.0;  ///< what needs no walk
  double power_ = 0.0;  ///< of all starts
};

}  // namespace lamina
