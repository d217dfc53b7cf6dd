// SPDX-License-Identifier: GPL-3.0-or-later
// The media of a stack as one graded medium.
#pragma once
#include "matter/graded_medium.hpp"
#include "matter/stack.hpp"

namespace lamina {

/// The media of a stack as one, with jumps between them, on its base if that is a Lambert surface: what the roads of
/// the scattering equation know. Throws std::invalid_argument for stacks with boundaries, metals, media without end, or
/// no medium.
GradedMedium joined_media(const Stack& stack);

/// A medium, and the surface below it, as a stack.
Stack stack_of(const GradedMedium& medium);

}  // namespace lamina
