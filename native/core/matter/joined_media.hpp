// SPDX-License-Identifier: GPL-3.0-or-later
// The media of a stack as one graded medium.
#pragma once
#include "matter/graded_medium.hpp"
#include "matter/stack.hpp"

namespace lamina {

/// The media of a stack as one graded medium, with jumps between them, on the base if it is a Lambert surface. The
/// methods of the scattering equation take such a medium. Throws std::invalid_argument for stacks with boundaries,
/// metals or infinitely thick media, and for stacks without media. With `endless` the last medium may be infinitely
/// thick: of the result, only GradedMedium::at_depth is then meaningful.
GradedMedium joined_media(const Stack& stack, bool endless = false);

}  // namespace lamina
