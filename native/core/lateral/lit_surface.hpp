// SPDX-License-Identifier: GPL-3.0-or-later
// Light of a pencil beam that a surface spreads and that no medium scatters.
#pragma once
#include <functional>
#include <vector>

#include "lateral/azimuth_rule.hpp"
#include "operators/directions.hpp"

namespace lamina {

/// The point of a surface that a beam along the normal illuminates: of a base, or of a rough boundary. Light from this
/// point crosses the media on its way to a face without scattering. Smooth boundaries transmit the light, or reflect it
/// back to a Lambert base, which reflects it again. In a discretised stack the light travels in discrete directions and
/// leaves in sharp rings; the exact flux density is smooth. The difference of `at` and `discretised` corrects the
/// discretisation.
class LitSurface {
 public:
  /// One medium, or the boundary behind it, on the way from the surface to the face.
  struct Part {
    double ior = 1.0;          ///< refractive index of the medium, or behind the boundary
    double thickness = 0.0;    ///< of a medium, mm; 0 for a boundary
    double extinction = 0.0;   ///< of a medium, 1/mm
    Eigen::VectorXd passed{};  ///< of a rough boundary, the last part: the share that passes, by live node
  };
  /// How the surface spreads light of unit flux.
  struct Spread {
    Eigen::VectorXd discrete;            ///< flux along each live node
    std::function<double(double)> lobe;  ///< flux by the cosine, of a lobe
    Eigen::VectorXd matte;               ///< flux by the cosine over the cosine, by live node, of all other light
    double returned = 0.0;               ///< flux, of light that comes back to the surface: of a Lambert base
    /// By live node, the share of light that comes back to a rough boundary and leaves there; empty: light leaves at
    /// the end of the parts.
    Eigen::VectorXd echoed{};
  };
  /// `beam`: unscattered flux of the beam at the surface. `parts`: from the surface to the face. `directions`: the
  /// discrete directions beside the surface.
  LitSurface(const Directions& directions, double beam, Spread spread, std::vector<Part> parts);

  /// The flux in the discretised stack at the lateral frequency q, 1/mm.
  double discretised(double q, const AzimuthRule& azimuths) const;
  /// The flux at the lateral frequency q, 1/mm, by fine quadratures over the exact directions.
  double at(double q) const;

 private:
  struct Share {
    double flux;
    double aside;  ///< lateral displacement, mm
  };
  /// The shares of light in one direction that leave, and that return to the surface.
  struct Ray {
    std::vector<Share> leaving;
    std::vector<Share> returning;  ///< one entry per boundary
  };
  Ray ray(double mu) const;
  double aside(double mu) const;
  /// The flux that leaves after any number of reflections, at one frequency. Of the light from the surface, `leaving`
  /// is the share that leaves, and `returning` the share that returns there.
  double exchanged(double leaving, double returning) const;

  double ior_;
  Eigen::VectorXd nodes_;
  double beam_;
  Spread spread_;
  std::vector<Part> parts_;
  std::vector<double> critical_;  // cosines beside the surface, ascending from 0 to 1; integrands are smooth in between
  struct Discrete {
    double weight;
    Ray ray;
  };
  std::vector<Discrete> discrete_;
  double scale_ = 1.0;  // of `at`
};

}  // namespace lamina
