// SPDX-License-Identifier: GPL-3.0-or-later
// Rasterises a UV map: the triangle and the barycentric weights of each texel.
#pragma once
#include <cstddef>
#include <cstdint>

namespace lamina {

/// Rows [first_row, first_row + rows) of an image.
struct TexelRows {
  int width, height, first_row, rows;
};

/// Finds the triangle of a UV map that covers the centre of each texel in the rows of `image`. `uvs` holds u v of the
/// three corners of each triangle, u to the right and v up over [0, 1]; rows of texels start at the bottom. Writes the
/// triangle's number to `triangle` (the lowest where several overlap, -1 where there is none), and the weights of its
/// second and third corner to `weights`, two per texel. Parts of triangles outside [0, 1] are ignored.
void raster_texels(const double* uvs, std::size_t triangles, const TexelRows& image, std::int32_t* triangle,
                   float* weights);

}  // namespace lamina
