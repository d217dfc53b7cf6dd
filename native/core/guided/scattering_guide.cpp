// SPDX-License-Identifier: GPL-3.0-or-later
#include "guided/scattering_guide.hpp"

#include "guided/reflection_by_height.hpp"
#include "matter/single_scattering_shape.hpp"

namespace lamina {
namespace {

constexpr double kLeastCosine = 1e-6;  // replaces 0, by which shapes would divide

/// Azimuth orders are summed until none of an order's values exceeds this, relative to .05 + albedo.
constexpr double kUnseen = 5e-4;

double cosine_at(double y) { return std::max(kLeastCosine, 1.0 - y * y); }

}  // namespace

/// The directions of the tables.
struct ScatteringGuide::Grid {
  Eigen::VectorXd mu = Eigen::VectorXd(kPoints);
  std::array<double, kPoints> angle;

  Grid() {
    for (std::size_t k = 0; k < kPoints; ++k) {
      const double x = static_cast<double>(k) / static_cast<double>(kCells);
      mu[static_cast<Eigen::Index>(k)] = cosine_at(x);
      angle[k] = 2.0 * std::asin(x);
    }
  }
};

ScatteringGuide::ScatteringGuide(const GradedMedium& medium) : heights_(medium), ground_(medium.ground()) {
  tabulate(medium);
  tabulate_bins(medium);
}

void ScatteringGuide::tabulate(const GradedMedium& medium) {
  const Grid grid;
  const ReflectionByHeight reflection(medium, heights_.above_zero(), guide_nodes(medium), grid.mu);
  constexpr std::size_t kPairs = kPoints * kPoints;
  smooth_.assign(heights_.size() * kPairs * kPoints, 0.0F);
  one_side_.assign(kPairs * kPoints, Column::Zero());
  repeated_ = one_side_;

  // Sum azimuth orders until the contribution of one is negligible for a guide
  for (int m = 0; m < reflection.orders(); ++m) {
    if (add_order(reflection, grid, m) < kUnseen) {
      break;
    }
  }

  // Clear negative values that truncation left in the terms
  for (std::vector<Column>* table : {&one_side_, &repeated_}) {
    for (Column& column : *table) {
      column = column.max(0.0F);
    }
  }

  // Copy the first section above height 0, where S / shape is 0 / 0
  std::copy_n(smooth_.begin() + kPairs * kPoints, kPairs * kPoints, smooth_.begin());
}

/// Adds azimuth order m to the tables. Returns the largest absolute value of its smooth part, relative to .05 + albedo.
double ScatteringGuide::add_order(const ReflectionByHeight& reflection, const Grid& grid, int m) {
  const Eigen::VectorXd& mu = grid.mu;
  const Directions& directions = reflection.directions();
  const Eigen::Index n = directions.nodes;
  const Eigen::Index points = kPoints;
  const Eigen::VectorXd share = 0.5 * directions.weight.cwiseQuotient(directions.mu.head(n));
  const std::vector<Eigen::MatrixXd> s = reflection.order(m);
  std::array<float, kPoints> wave;
  for (std::size_t z = 0; z < kPoints; ++z) {
    wave[z] = static_cast<float>((m == 0 ? 1.0 : 2.0) * std::cos(m * grid.angle[z]));
  }
  double largest = 0.0;
  for (std::size_t j = 1; j < heights_.size(); ++j) {
    // Integrate Sk and SkS over the nodes' directions
    const double t = heights_[j];
    const TruncatedMedium seen = reflection.medium(t, 1.0);
    const PhaseKernel phase(seen, m, directions.mu);
    const double albedo = seen.albedo * seen.tau;
    const Eigen::MatrixXd& all = s[j - 1];
    const Eigen::MatrixXd shared = share.asDiagonal() * all.topRightCorner(n, points);
    const Eigen::MatrixXd one = albedo * phase.transmit.bottomLeftCorner(points, n) * shared;
    const Eigen::MatrixXd both = shared.transpose() * (albedo * phase.reflect.topLeftCorner(n, n)) * shared;
    for (Eigen::Index b = 0; b < points; ++b) {
      for (Eigen::Index a = 0; a < points; ++a) {
        // Split off the ground and single scattering, and divide by the shape of single scattering
        const double shape = single_reflection(mu[a], mu[b], t);
        const double seen_ground =
            m == 0 ? 4.0 * mu[a] * mu[b] * ground_ * std::exp(-t * (1.0 / mu[a] + 1.0 / mu[b])) : 0.0;
        const double rest = (all(n + a, n + b) - seen_ground) / (4.0 * mu[a] * mu[b] * shape) -
                            0.25 * albedo * phase.reflect(n + a, n + b);
        largest = std::max(largest, std::abs(rest) / (0.05 + albedo));

        // Add the order's wave to all azimuths
        const auto pair = static_cast<std::size_t>(a * points + b);
        const auto repeated = static_cast<float>(one(a, b) + one(b, a) + both(a, b));
        float* value = &smooth_[(j * kPoints * kPoints + static_cast<std::size_t>(b * points + a)) * kPoints];
        const auto row = static_cast<Eigen::Index>(j);
        for (std::size_t z = 0; z < kPoints; ++z) {
          value[z] += wave[z] * static_cast<float>(rest);
          one_side_[pair * kPoints + z][row] += wave[z] * static_cast<float>(one(a, b));
          repeated_[pair * kPoints + z][row] += wave[z] * repeated;
        }
      }
    }
  }
  return largest;
}

/// Bins of directions for sampling S / mu, uniform in sqrt(1 - mu) and in tan(dphi / 4), which needs no sine or cosine.
/// Each bin gets a number of equally likely slots in proportion to its mass, at least one.
void ScatteringGuide::tabulate_bins(const GradedMedium& medium) {
  const std::size_t heights = heights_.size();
  slots_.resize(heights * kPoints * kSlots);
  counts_.resize(heights * kPoints * kBins);

  // Compute the centre and the relative solid angle of each bin
  using Values = Eigen::Array<float, static_cast<int>(kBins), 1>;
  Values x;
  Values y;
  Values mu;
  Values size;
  for (std::size_t bin = 0; bin < kBins; ++bin) {
    const auto k = static_cast<Eigen::Index>(bin);
    const double r = (static_cast<double>(bin / kAzimuths) + 0.5) / static_cast<double>(kCells);
    const double quarter = (static_cast<double>(bin % kAzimuths) + 0.5) / static_cast<double>(kAzimuths);
    const double phi = 4.0 * std::atan(quarter);
    const double cosine = 1.0 - r * r;
    const double sine = std::sqrt(1.0 - cosine * cosine);
    x[k] = static_cast<float>(sine * std::cos(phi));
    y[k] = static_cast<float>(sine * std::sin(phi));
    mu[k] = static_cast<float>(cosine);
    size[k] = static_cast<float>(r / (1.0 + quarter * quarter));
  }
  for (std::size_t j = 0; j < heights; ++j) {
    const double t = heights_[std::max<std::size_t>(j, 1)];
    const LocalScattering scattering = medium.at(t);
    for (std::size_t point = 0; point < kPoints; ++point) {
      // Integrate S / mu over the bins
      const double mu_b = cosine_at(static_cast<double>(point) / static_cast<double>(kCells));
      const SlabRay b{std::sqrt(1.0 - mu_b * mu_b), 0.0, mu_b};
      const Section section(*this, std::min(j, heights - 2), j == heights - 1 ? 1.0 : 0.0, t, b, scattering, 0.5, 0.5);
      Values mass = section(x, y, mu) * size;
      if (!(mass.sum() > 0.0F)) {
        mass = size;  // no light at all: uniform
      }

      // Give each bin one slot and a share of the others, at most 255 in all; spread the slots that rounding leaves
      const double whole = static_cast<double>(mass.sum());
      std::uint8_t* count = &counts_[(j * kPoints + point) * kBins];
      double carried = 0.0;
      std::size_t used = 0;
      for (std::size_t bin = 0; bin < kBins; ++bin) {
        carried +=
            static_cast<double>(mass[static_cast<Eigen::Index>(bin)]) / whole * static_cast<double>(kSlots - kBins);
        const double taken = std::min(std::floor(carried), 200.0);
        count[bin] = static_cast<std::uint8_t>(1.0 + taken);
        carried -= taken;
        used += count[bin];
      }
      for (std::size_t bin = 0; used < kSlots; bin = (bin + 1) % kBins) {
        if (count[bin] < 255) {
          ++count[bin];
          ++used;
        }
      }

      // List the bin of each slot
      std::uint8_t* slot = &slots_[(j * kPoints + point) * kSlots];
      for (std::size_t bin = 0; bin < kBins; ++bin) {
        slot = std::fill_n(slot, count[bin], static_cast<std::uint8_t>(bin));
      }
    }
  }
}

ScatteringGuide::Terms::Terms(const ScatteringGuide& guide, const SlabRay& a, const SlabRay& b) : guide_(guide) {
  const Place p = Place::of_cosine(a.mu);
  const Place q = Place::of_cosine(b.mu);
  const Place z = Place::between(a, b);
  for (std::size_t k = 0; k < 8; ++k) {
    const std::size_t i = k & 1U;
    const std::size_t o = (k >> 1U) & 1U;
    const std::size_t w = k >> 2U;
    weights_[k] = (i != 0 ? p.fraction : 1.0F - p.fraction) * (o != 0 ? q.fraction : 1.0F - q.fraction) *
                  (w != 0 ? z.fraction : 1.0F - z.fraction);
    corners_[k] = ((p.cell + i) * kPoints + q.cell + o) * kPoints + z.cell + w;
    turned_[k] = ((q.cell + o) * kPoints + p.cell + i) * kPoints + z.cell + w;
  }
}

double ScatteringGuide::value(std::size_t j, double up, double t, const SlabRay& a, const SlabRay& b,
                              const LocalScattering& scattering) const {
  const Place p = Place::of_cosine(a.mu);
  const Place q = Place::of_cosine(b.mu);
  const Place z = Place::between(a, b);
  const auto high = static_cast<float>(up);
  float smooth = 0.0F;
  for (std::size_t k = 0; k < 8; ++k) {
    const std::size_t i = k & 1U;
    const std::size_t o = (k >> 1U) & 1U;
    const std::size_t w = k >> 2U;
    const float* row = &smooth_[(((j + w) * kPoints + q.cell + o) * kPoints + p.cell + i) * kPoints + z.cell];
    smooth += (i != 0 ? p.fraction : 1.0F - p.fraction) * (o != 0 ? q.fraction : 1.0F - q.fraction) *
              (w != 0 ? high : 1.0F - high) * (row[0] + z.fraction * (row[1] - row[0]));
  }
  const double once = 0.25 * scattering.evaluate(turned_back(a, b));
  return 4.0 * a.mu * b.mu * single_reflection(a.mu, b.mu, t) *
         (once + std::max(static_cast<double>(smooth), -0.5 * once));
}

ScatteringGuide::Section::Section(const ScatteringGuide& guide, std::size_t j, double up, double t, const SlabRay& b,
                                  const LocalScattering& scattering, double u, double v)
    : b_(b), t_(t), scattering_(scattering), ground_(static_cast<float>(guide.ground_)) {
  const Place q = Place::of_cosine(b.mu);
  const double length = std::sqrt(b.x * b.x + b.y * b.y);
  cosine_ = static_cast<float>(length > 0.0 ? b.x / length : 1.0);
  sine_ = static_cast<float>(length > 0.0 ? b.y / length : 0.0);
  const std::size_t near = (j + (u < up ? 1 : 0)) * kPoints + q.cell + (v < static_cast<double>(q.fraction) ? 1 : 0);
  if (!guide.slots_.empty()) {
    slots_ = &guide.slots_[near * kSlots];
    counts_ = &guide.counts_[near * kBins];
  }
  constexpr std::size_t kPairs = kPoints * kPoints;
  const auto high = static_cast<float>(up);
  const float* low_low = &guide.smooth_[(j * kPoints + q.cell) * kPairs];
  const float* low_high = low_low + kPairs;
  const float* high_low = low_low + kPoints * kPairs;
  const float* high_high = high_low + kPairs;
  const float w0 = (1.0F - high) * (1.0F - q.fraction);
  const float w1 = (1.0F - high) * q.fraction;
  const float w2 = high * (1.0F - q.fraction);
  const float w3 = high * q.fraction;
  for (std::size_t k = 0; k < kPairs; ++k) {
    values_[k] = w0 * low_low[k] + w1 * low_high[k] + w2 * high_low[k] + w3 * high_high[k];
  }
}

SlabRay ScatteringGuide::Section::draw(double u, double v, double w) const {
  const std::size_t bin = slots_[static_cast<std::size_t>(u * static_cast<double>(kSlots))];
  const double root = (static_cast<double>(bin / kAzimuths) + v) / static_cast<double>(kCells);
  // The bins cover half the circle of azimuths; the last number also chooses the half.
  const double way = 2.0 * w - 1.0;
  const double quarter = (static_cast<double>(bin % kAzimuths) + std::abs(way)) / static_cast<double>(kAzimuths);
  const double scale = 1.0 / (1.0 + quarter * quarter);
  const double half_cosine = (1.0 - quarter * quarter) * scale;
  const double half_sine = 2.0 * quarter * scale;
  const double mu = 1.0 - root * root;
  const double sine = root * std::sqrt(1.0 + mu);
  const double x = sine * (1.0 - 2.0 * half_sine * half_sine);
  const double side = std::copysign(2.0 * sine * half_sine * half_cosine, way);
  const auto c = static_cast<double>(cosine_);
  const auto s = static_cast<double>(sine_);
  return {x * c - side * s, x * s + side * c, mu};
}

}  // namespace lamina
