// SPDX-License-Identifier: GPL-3.0-or-later
// Texels of an image that a mesh covers through its UV map, with their places on the surface.
#pragma once
#include <cstddef>
#include <cstdint>

namespace lamina {

/// Rows [first_row, first_row + rows) of an image.
struct TexelRows {
  int width, height, first_row, rows;
};

/// Which triangle of a UV map covers the centre of each texel: `uvs` holds u v of the three corners of each
/// triangle, u to the right and v up over [0, 1]; texels run in rows from the bottom. Writes the triangle's number
/// into `triangle`, the lowest where several overlap and -1 where none is, and the weights of its second and third
/// corner into `weights`, two a texel. What lies outside [0, 1] is left out. Only the texels of `image`'s rows are
/// written.
void raster_texels(const double* uvs, std::size_t triangles, const TexelRows& image, std::int32_t* triangle,
                   float* weights);

}  // namespace lamina
