// SPDX-License-Identifier: GPL-3.0-or-later
// The 3D scattering function of a plane stack, for one beam.
#pragma once
#include <array>
#include <memory>
#include <optional>
#include <vector>

#include "lateral/beam_paths.hpp"
#include "lateral/lateral_stack.hpp"
#include "lateral/spectrum.hpp"

namespace lamina {

/// The light that leaves one face of a stack, for a pencil beam of unit flux at r = 0, as a function of the distance.
/// For a beam at a slant, in the mean over azimuths about the point of entry.
struct LeavingLight {
  double flux = 0.0;                      ///< all
  double at_entry = 0.0;                  ///< at r = 0: mirrored, or straight through
  double direct = 0.0;                    ///< all that no medium has scattered: at r = 0 and in rings
  std::vector<Ring> rings;                ///< unscattered light of a beam at a slant
  std::optional<OnceScatteredBeam> once;  ///< what is singular near the beam
  Spectrum rest;
  double distance = 0.0;         ///< integral of the flux density times r, mm
  double square_distance = 0.0;  ///< times r^2, mm^2

  double at(double q) const;
  double inside(double r) const;
  /// Without the parts at r = 0 and in rings.
  double density(double r) const;
};

/// How good a searchlight is meant to be.
struct SearchlightQuality {
  double resolution = 4e-6;  ///< largest change of a flux by finer directions
  /// Of spectra over frequencies, relative: low ones, of which the tail of a profile is made, and high ones.
  std::array<double, 2> interpolation{2e-7, 2e-5};
  int nodes = 12;
  int nodes_with_boundary = 8;  ///< the range of total reflection has nodes of its own
  Eigen::Index azimuths = 12;
  int intervals = 16;  ///< between frequencies of a piece, at first

  static SearchlightQuality preview() { return {2e-4, {1e-5, 1e-3}, 8, 6, 6, 8}; }
};

/// The 3D scattering function of a plane stack, for one beam: solved at lateral frequencies, one batch with each call
/// of advance, until done.
class Searchlight {
 public:
  /// The beam comes from above; mu is its cosine in air.
  Searchlight(MeasuredStack measured, double mu, const SearchlightQuality& quality);

  bool done() const { return done_; }
  /// The share of the work that is done, 0 to 1, never falling.
  double progress() const { return progress_; }
  /// Throws std::runtime_error, with the numbers, where the finest directions do not resolve the stack.
  void advance(ThreadPool& pool);

  const LeavingLight& reflected() const { return faces_[0]; }
  const LeavingLight& transmitted() const { return faces_[1]; }
  int nodes() const { return resolution_.nodes; }
  std::size_t frequencies() const;

 private:
  using Faces = std::array<double, 2>;
  /// A piece of both faces' spectra, while its frequencies are solved.
  struct Piece {
    double low;  // in s
    double high;
    int intervals = 0;
    std::array<std::vector<double>, 2> rest;  // by node
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
  void prepare(ThreadPool& pool);
  bool refine(ThreadPool& pool);
  Faces rest_at(double q) const;
  void refine_piece(std::size_t number);
  bool is_resolved(std::size_t number) const;
  void finish();
  void add_moments(std::size_t face);

  MeasuredStack measured_;
  double mu_;
  SearchlightQuality quality_;
  LateralResolution resolution_;
  FrequencyScale scale_;
  double decay_ = 1.0;       // of light that spreads sideways, 1/mm: the nearest singularity of the spectra
  double extinction_ = 1.0;  // the least of a medium that scatters
  bool spreads_ = false;     // whether the mean distances are infinite
  bool runs_along_ = false;  // whether light runs along a clear layer, and mean squares are infinite
  bool sharp_ = false;       // whether a phase function has a peak
  std::unique_ptr<LateralStack> stack_;
  std::optional<ForwardPeaks> peaks_down_;
  std::optional<ForwardPeaks> peaks_back_;
  LateralFlux limit_;
  std::array<LeavingLight, 2> faces_;
  std::array<std::vector<OnceScatteredBeam>, 2> deeper_;  // by face
  std::array<Piece, 2> pieces_{};                         // of low and of high frequencies
  std::vector<double> small_;                             // frequencies near 0
  std::array<std::vector<double>, 2> small_rest_;
  bool small_solved_ = false;
  std::vector<Wanted> waiting_;
  double progress_ = 0.0;
  bool done_ = false;
};

}  // namespace lamina
