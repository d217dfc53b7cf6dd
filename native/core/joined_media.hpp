// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "graded_medium.hpp"
#include "stack.hpp"

namespace lamina {

/// The media of a stack as one, with jumps between them, on its base if that is a Lambert surface: what the roads of
/// the scattering equation know. With `endless` the last medium may be without end: then GradedMedium::at_depth alone
/// tells what scatters. Throws std::invalid_argument for stacks with boundaries, metals, other media without end, or no
/// medium.
GradedMedium joined_media(const Stack& stack, bool endless = false);

/// A medium, and the surface below it, as a stack.
Stack stack_of(const GradedMedium& medium);

}  // namespace lamina
