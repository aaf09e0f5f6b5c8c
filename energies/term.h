#pragma once
/// Terms: what an energy may see of one step of a fit, and all that it may answer.
///
/// A term (EnergyTerm of energy_kind.h) is a small object that a stage makes anew for each of its energies and asks
/// once per step. It keeps what it has to remember from step to step itself.

#include <functional>
#include <optional>
#include <variant>
#include <vector>

#include "pellicle/energies/point_targets.h"
#include "pellicle/energies/reading.h"
#include "pellicle/energies/rows.h"
#include "pellicle/energies/sample_view.h"

namespace pellicle {

/// What is known of an object that is one of many of its kind. Nothing by default.
struct OneOfMany {
  const Image<float>* territory = nullptr;       ///< above 1/2 where the object may be; profiles end there
  double radius = 0.0;                           ///< mm, of a typical object; 0: unknown
  const std::vector<double>* typical = nullptr;  ///< mm from the centroid, of a typical object, one per sample
};

/// The beginning of a step.
struct StepView {
  SampleView surface;
  const Reading& hypothesis;            ///< how the image is read
  const Levels& levels;                 ///< as estimated so far
  const Image<float>* image = nullptr;  ///< the working image: binned and smoothed for this stage; null: none
  int image_version = 0;                ///< another number, another image
  double first_contrast = 0.0;          ///< of the levels when the stage began
  double blur_mm = 0.0;                 ///< standard deviation of the image's blur; 0: not measured yet
  double weight = 1.0;                  ///< of this energy
  double h = 1.0;                       ///< mm, cube root of the voxel volume of the working image
  double smoothing_mm = 0.0;            ///< of the working image
  double reach_mm = 0.0;                ///< how far the first search of the stage looks along the normals
  int step = 0, steps = 1;              ///< of the stage: this one, counted from 0, and at most so many
  double delay = 1.0;      ///< by how much slower a surface with mass and damping follows (solve/dynamics.h)
  bool continued = false;  ///< the surface rested on this image before: no wide search first
  int detail = 0;          ///< refinements of the control mesh so far
  const ExpertPoints* points = nullptr;
  std::optional<double> target_volume = {};  ///< mm^3
  OneOfMany one_of_many = {};
};

/// What a term learned about the image, and how far it has come.
struct Findings {
  std::optional<Levels> levels = {};   ///< the new estimate
  std::optional<double> blur_mm = {};  ///< measured
  bool searching = false;              ///< the stage must not end yet, even when the surface rests
};

/// Value in mm^2 of the samples and their area vectors (energies/geometry.h); adds its derivatives.
using ScalarValue = std::function<double(const std::vector<Vec3>& x, const std::vector<Vec3>& area_vector,
                                         std::vector<Vec3>& dE_dx, std::vector<Vec3>& dE_da)>;

/// Rows and values are weighted already; targets are weighted by the fit, which may leave some out first.
struct TermOutput {
  std::variant<std::monostate, NormalTargets, PointTargets, ScalarRows, ScalarValue> pull = {};  ///< monostate: no pull
  Findings found = {};
};

}  // namespace pellicle
