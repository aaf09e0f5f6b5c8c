#pragma once
/// Synthetic volumes with exact truth. Depends on base, image and mesh only: an oracle without any code of the
/// surface models that it judges. World is LPS mm; the centre of the volume lies at the world's origin.

#include <cstdint>
#include <string>
#include <vector>

#include "pellicle/base/random.h"
#include "pellicle/image/image.h"
#include "pellicle/mesh/triangle_mesh.h"
#include "pellicle/synthetic/degrade.h"
#include "pellicle/synthetic/shapes.h"

namespace pellicle {

enum class PhantomFill { solid, shell };

struct PhantomSettings {
  std::string shape = "sphere";      ///< see shape_names()
  Index3 size{96, 96, 96};           ///< voxels
  Vec3 spacing{1, 1, 1};             ///< mm
  Vec3 direction_degrees{0, 0, 0};   ///< turns the grid (not the object): about x, then y, then z, fixed world axes
  std::vector<double> radius{20.0};  ///< mm; one scale, three half axes, or MAJOR and MINOR (see make_shape)
  double blob_amplitude = 0.35;      ///< blob: largest deviation from its mean radius, relative, in (0, 0.6]
  Vec3 center{0, 0, 0};              ///< of the object, world mm; may leave the object partly outside the volume
  PhantomFill fill = PhantomFill::solid;
  /// Shell: a membrane centred on the surface has the inside intensity, both sides of it the outside one, like a
  /// stained cell membrane. The truth stays the solid that the mid-surface bounds. 0: three mean voxels, at most 0.6
  /// of the inner radius.
  double shell_thickness_mm = 0.0;
  double inside = 100.0, outside = 20.0;  ///< intensities
  double blur_mm = 1.0;                   ///< standard deviation of the Gaussian, isotropic in mm
  PhantomNoise noise = PhantomNoise::gaussian;
  /// |inside - outside| / standard deviation. Rician: of each of the two channels. Poisson: at the brighter level;
  /// the variance is proportional to the intensity.
  double snr = 5.0;
  double bias = 0.0;  ///< smooth multiplicative field that runs from 1 - bias to 1 + bias over the volume, in [0, 1)
  std::uint64_t seed = 1;

  /// \throws SettingError with the key, its value and the rule.
  void validate() const;
};

/// A start sphere for a fit, world mm.
struct SeedDraw {
  Vec3 center{0, 0, 0};
  double radius = 0.0;
};

struct Phantom {
  PhantomSettings settings;
  Image<float> image;
  Image<std::uint8_t> truth;   ///< 1 where the voxel centre lies inside the exact solid
  TriangleMesh truth_surface;  ///< vertices on the exact surface (to rounding), exact normals; closed, outward
  Body body;                   ///< the exact solid itself
  double exact_volume_ml = 0.0;
  double inner_radius = 0.0;  ///< shortest half-axis: radius of the largest inscribed ball, mm
  /// The centroid, when it lies at least half the inner radius deep, else the deepest point (centre of the largest
  /// inscribed ball). Dumbbell: the middle of the neck, which is just deep enough; tube and bean: on their middle;
  /// torus: a point of the circle inside its tube.
  Vec3 natural_center{0, 0, 0};
  double shell_thickness_mm = 0.0;  ///< as used; 0 for a solid
  std::vector<SeedDraw> seeds;      ///< eight draws that belong to settings.seed
};

/// The grid of a phantom: its middle lies at the world's origin.
ImageGrid phantom_grid(const PhantomSettings& settings);

/// Each voxel is the mean, over its own box, of the object convolved with the Gaussian, times the bias field, plus
/// noise. The blur is that of the continuous object: thin slices and wide ones see the same object. Same bytes for
/// any number of threads.
/// \throws UsageError: see validate(), and when no voxel centre lies inside the object.
Phantom make_phantom(const PhantomSettings& settings);

/// Start spheres: centres uniform in the ball of 0.4 inner radii about the natural centre (and inside the object and
/// the volume), radii uniform in [0.25, 1.2] inner radii.
std::vector<SeedDraw> draw_seeds(const Phantom& phantom, int count, RandomEngine& random);

/// The `STEM_truth.json` of `pellicle phantom`: shape, exact volume, centres, inner radius, seeds, every setting.
std::string truth_json(const Phantom& phantom);

/// "solid", "shell"; "none", "gaussian", "rician", "poisson".
std::string name_of(PhantomFill fill);
std::string name_of(PhantomNoise noise);

}  // namespace pellicle
