// SPDX-License-Identifier: GPL-3.0-or-later
// The 3D scattering function of a plane stack, for one beam.
#pragma once
#include <array>
#include <memory>
#include <optional>
#include <vector>

#include "lateral/beam_paths.hpp"
#include "lateral/lateral_stack.hpp"
#include "lateral/resolved_beam.hpp"
#include "lateral/spectrum.hpp"

namespace lamina {

/// The light that leaves one face of a stack by distance r from the point of entry, for a pencil beam of unit flux. For
/// an oblique beam, the mean over azimuths about the point of entry.
struct LeavingLight {
  double flux = 0.0;                      ///< total flux
  double at_entry = 0.0;                  ///< flux at r = 0, reflected specularly or transmitted unscattered
  double direct = 0.0;                    ///< flux that neither media nor facets have scattered, at r = 0 and in rings
  std::vector<Ring> rings;                ///< unscattered light of an oblique beam
  std::optional<OnceScatteredBeam> once;  ///< single scattering that is singular near the beam
  std::optional<FluxByDistance> oblique;  ///< single scattering of an oblique beam
  Spectrum rest;
  double distance = 0.0;         ///< integral of the flux density times r over the surface, mm
  double square_distance = 0.0;  ///< integral of the flux density times r^2, mm^2

  double at(double q) const;
  double inside(double r) const;
  /// Flux density without light at r = 0 and in rings, 1/mm^2.
  double density(double r) const;
};

/// Tolerances and first resolution of a searchlight.
struct SearchlightQuality {
  double resolution = 4e-6;  ///< largest change of a flux when directions are refined
  /// Largest relative interpolation error of spectra over frequency: low frequencies, which determine the tail of a
  /// profile, and high ones.
  std::array<double, 2> interpolation{2e-7, 2e-5};
  int nodes = 12;
  int nodes_with_boundary = 8;  ///< smaller, because the range of total reflection adds nodes
  Eigen::Index azimuths = 12;
  int intervals = 16;  ///< first number of intervals between the frequencies of a piece
  int forward = 8;     ///< nodes of each range of denser directions for high frequencies; 0: none

  static SearchlightQuality preview() { return {2e-4, {1e-5, 1e-3}, 8, 6, 6, 8, 0}; }
};

/// The 3D scattering function of a plane stack for one beam. Each call of advance() solves one batch of lateral
/// frequencies.
class Searchlight {
 public:
  /// For a beam from above; `mu` is its cosine in air.
  Searchlight(MeasuredStack measured, double mu, const SearchlightQuality& quality);

  bool done() const { return done_; }
  /// The completed share of the work, 0 to 1; never falls.
  double progress() const { return progress_; }
  /// Solves the next batch. Throws std::runtime_error, with the numbers, if the finest directions do not resolve the
  /// stack.
  void advance(ThreadPool& pool);

  const LeavingLight& reflected() const { return faces_[0]; }
  const LeavingLight& transmitted() const { return faces_[1]; }
  int nodes() const { return resolution_.nodes; }
  std::size_t frequencies() const;

 private:
  using Faces = ResolvedBeam::Faces;
  /// A piece of the spectra of both faces, while its frequencies are solved.
  struct Piece {
    double low;  // in s
    double high;
    int intervals = 0;
    std::array<std::vector<double>, 2> rest;  // by face and node
    double frequency(const FrequencyScale& scale, int node) const {
      return scale.frequency(SpectrumPiece::node(low, high, node, intervals));
    }
  };
  struct Wanted {
    std::size_t piece;
    int node;
  };

  void choose_resolution();
  void choose_scale();
  AzimuthRule azimuths_for(double q) const;
  bool refine(ThreadPool& pool);
  Faces rest_at(double q) const;
  double forward_share(double q) const;
  void resolve_forward(ThreadPool& pool);
  void refine_piece(std::size_t number);
  bool is_resolved(std::size_t number) const;
  void finish();
  void add_moments(std::size_t face);

  MeasuredStack measured_;
  double mu_;
  SearchlightQuality quality_;
  LateralResolution resolution_;
  FrequencyScale scale_;
  double decay_ = 1.0;       // decay rate of lateral light, 1/mm: the nearest singularity of the spectra
  double extinction_ = 1.0;  // least extinction of a scattering medium, 1/mm
  bool spreads_ = false;     // true if the mean distances are infinite
  bool runs_along_ = false;  // true if light travels along a clear layer and mean squares are infinite
  bool sharp_ = false;       // true if a phase function has a sharp peak
  std::unique_ptr<ResolvedBeam> beam_;
  std::unique_ptr<ResolvedBeam> forward_;  // with more directions, for high frequencies; may be empty
  double forward_from_ = 0.0;              // above this frequency, 1/mm, `forward_` has a share in the spectrum
  double forward_only_ = 0.0;              // above this frequency the spectrum is that of `forward_`
  std::array<LeavingLight, 2> faces_;
  std::array<Piece, 2> pieces_{};  // of low and of high frequencies
  std::vector<double> small_;      // frequencies near 0
  std::array<std::vector<double>, 2> small_rest_;
  bool small_solved_ = false;
  std::vector<Wanted> waiting_;
  double progress_ = 0.0;
  bool done_ = false;
};

}  // namespace lamina
