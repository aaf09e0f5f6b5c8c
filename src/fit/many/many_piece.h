#pragma once
/// What one fit among many sees: its start, its territory, its piece of the image (fit/many.h).

#include <optional>
#include <utility>
#include <vector>

#include "pellicle/fit/many/many_types.h"
#include "pellicle/fit/stage.h"
#include "pellicle/seed/territories.h"

namespace pellicle {

/// The start of one fit.
struct ManyStart {
  std::size_t source = 0;  ///< number of the seed
  Vec3 position{0, 0, 0};  ///< whose territory it is, LPS mm
  double response = 0.0;
  std::optional<double> radius = {};    ///< mm, as the user said
  std::optional<Surface> surface = {};  ///< already near
};

/// What all fits share.
struct ManyScene {
  const Image<float>& image;  ///< smoothed for the image forces
  const ManySettings& settings;
  const BlobField& field;
  double radius;  ///< typical, mm
  Image<std::int32_t> territories;
  SurfaceModel model;
  int detail;
  std::vector<Stage> stages;
};

/// Which intensities a fit works on: variance-stabilised ones, or the image's own.
enum class Intensities { stabilised, original };

/// One object's territory: 1 inside, 0 elsewhere, and the box of what lies near the seed.
struct Territory {
  Image<float> own;
  Vec3 low{0, 0, 0}, high{0, 0, 0};
  Vec3 centre{0, 0, 0};  ///< centroid of what lies within 0.8 typical radii of the seed
  double radius = 0.0;   ///< of the ball of that volume
};

/// The model of every object and its refinements: `--detail`, or about 26 control points.
std::pair<SurfaceModel, int> model_of_many(const FitOptions& settings);

Territory territory_of(const ManyScene& scene, std::size_t object, const ManyStart& start);

/// The piece of the image that one fit sees.
Image<float> piece_of(const ManyScene& scene, const Territory& territory, Intensities intensities);

/// As fits see it: voxels of a 16th of the radius at least, smoothed. Once for all, since pieces overlap.
Image<float> smoothed_for_many(Image<float> image, const FitOptions& settings, double radius);

/// The surface that a fit begins with: as given, or a ball in the territory.
Candidate start_of(const ManyScene& scene, const ManyStart& start, const Territory& territory);

/// Typical radius of seeds that were given, mm.
double typical_radius_of_seeds(const std::vector<Seed>& seeds);

Vec3 middle_of(const Seed& seed);

/// Balls that are not in the object of an earlier one: half a radius from it, or a radius without a valley between.
std::vector<bool> without_repeats(const std::vector<Seed>& seeds, const Image<float>& response, double radius);

}  // namespace pellicle
