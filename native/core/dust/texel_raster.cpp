// SPDX-License-Identifier: GPL-3.0-or-later
#include "dust/texel_raster.hpp"

#include <algorithm>
#include <cmath>

namespace lamina {

namespace {

/// The range [first, last) of texels in [least, most) whose centres lie in [low, high].
void centres_between(double low, double high, int least, int most, int& first, int& last) {
  first = static_cast<int>(std::clamp(std::ceil(low - 0.5), static_cast<double>(least), static_cast<double>(most)));
  last =
      static_cast<int>(std::clamp(std::floor(high - 0.5) + 1.0, static_cast<double>(least), static_cast<double>(most)));
}

}  // namespace

void raster_texels(const double* uvs, std::size_t triangles, const TexelRows& image, std::int32_t* triangle,
                   float* weights) {
  std::fill_n(triangle, static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.rows), -1);
  for (std::size_t t = 0; t < triangles; ++t) {
    double x[3];
    double y[3];
    for (std::size_t k = 0; k < 3; ++k) {
      x[k] = uvs[6 * t + 2 * k] * image.width;
      y[k] = uvs[6 * t + 2 * k + 1] * image.height;
    }
    const double area = (x[1] - x[0]) * (y[2] - y[0]) - (x[2] - x[0]) * (y[1] - y[0]);
    if (area == 0.0) {
      continue;
    }
    int first_column = 0;
    int last_column = 0;
    int first_row = 0;
    int last_row = 0;
    centres_between(std::min({x[0], x[1], x[2]}), std::max({x[0], x[1], x[2]}), 0, image.width, first_column,
                    last_column);
    centres_between(std::min({y[0], y[1], y[2]}), std::max({y[0], y[1], y[2]}), image.first_row,
                    image.first_row + image.rows, first_row, last_row);
    for (int row = first_row; row < last_row; ++row) {
      for (int column = first_column; column < last_column; ++column) {
        const double px = column + 0.5 - x[0];
        const double py = row + 0.5 - y[0];
        const double second = (px * (y[2] - y[0]) - py * (x[2] - x[0])) / area;
        const double third = (py * (x[1] - x[0]) - px * (y[1] - y[0])) / area;
        const std::size_t texel =
            static_cast<std::size_t>(row - image.first_row) * static_cast<std::size_t>(image.width) +
            static_cast<std::size_t>(column);
        // An edge belongs to both neighbours, so that no texel between them is missed.
        if (second < 0.0 || third < 0.0 || second + third > 1.0 || triangle[texel] >= 0) {
          continue;
        }
        triangle[texel] = static_cast<std::int32_t>(t);
        weights[2 * texel] = static_cast<float>(second);
        weights[2 * texel + 1] = static_cast<float>(third);
      }
    }
  }
}

}  // namespace lamina
