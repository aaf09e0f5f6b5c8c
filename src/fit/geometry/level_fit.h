#pragma once
/// One model of fixed size, fitted to geometry. For this folder's sources only.

#include <memory>
#include <vector>

#include "pellicle/base/observer.h"
#include "pellicle/energies/springs.h"
#include "pellicle/fit/geometry/point_fit_types.h"
#include "pellicle/mesh/points/point_tree.h"
#include "pellicle/solve/step_solver.h"

namespace pellicle {

/// Bending over the samples of a coarser layout, enough to see every motion of the control points.
struct CoarseBending {
  VectorRows rows;
  std::vector<int> samples;  ///< of the finer layout, those that the rows use; empty: all
};
CoarseBending coarse_bending(const SurfaceModel& model, const SampleLayout& layout);

/// Weight of bending at smoothness 1. A harmonic of degree l bends with l^4/2 (energies/bending.h); the finest that n
/// control points show has l^2 = n/4. There bending counts a hundredth of what the data do.
double bending_weight(const SurfaceModel& model);

/// The place on the surface of every sample.
std::vector<Vec3> targets_at(const SampleLayout& layout, const SphereMap& map, const Mat3& map_from_reference);
/// The reference shape laid over the targets by the least-squares affine map; vertices of a normal-subdivision surface,
/// which lie on it, are put on their targets.
Parameters start_at_targets(const SurfaceModel& model, const SampleLayout& layout, const std::vector<Vec3>& targets);

class LevelFit {
 public:
  LevelFit(const Surface& start, const GeometryData& data, const PointFitSettings& settings, bool hold_out,
           const Observer& observer);

  const SampleLayout& layout() const { return layout_; }
  /// Least squares to one place a sample.
  void to_targets(const std::vector<Vec3>& targets);
  /// Springs, attached anew in each step until the residual stops falling. Where a step would make the surface cut
  /// itself it is held back, and patches that fold again and again become stiffer until they do so no longer.
  void springs();
  /// Steps in which points beyond settings.largest_residual count more and more; keeps the least largest residual.
  void bound_residuals();
  PointFit result(double seconds) const;

 private:
  void choose_points();
  void choose(const Vec3& x);
  void take_cloud();
  /// A surface that was laid out has its limbs; one from voxels must grow into them, and far points pull it there.
  bool grows() const { return anchors_.empty() && !rim_; }
  std::vector<double> weights_of(const std::vector<Attachment>& at) const;
  double rms_of(const std::vector<Attachment>& at, const std::vector<double>& given) const;
  void set_bending(double factor);
  StepOutcome solve(std::vector<NamedRows> rows);
  void step();
  /// Where the surface cuts itself.
  struct Cuts {
    int pairs = 0;              ///< of facets
    std::vector<int> blocks;    ///< that reach these facets, ascending
    std::vector<bool> patches;  ///< whether each has such facets
  };
  Cuts cuts_of(const Parameters& parameters) const;
  void hold_back(const Parameters& before);
  bool stiffen_folds();

  const GeometryData& data_;
  const PointFitSettings& settings_;
  const Observer& observer_;
  bool hold_out_;
  Surface surface_;
  SampleLayout layout_, fine_;  ///< of the springs; finer, to look for cuts
  std::vector<Vec3> anchors_;   ///< where samples are drawn along the surface; empty: where they are
  CoarseBending bending_;
  StepSolver solver_;
  std::unique_ptr<ClosestPoint> data_surface_;
  std::unique_ptr<PointTree> cloud_;      ///< chosen points with weight, where they alone are the data
  double reach_ = 0.0;                    ///< mm; what is further from them is beyond them
  std::unique_ptr<RimLocator> rim_;       ///< of open data
  std::vector<std::vector<int>> border_;  ///< samples on the border of an open surface
  std::vector<Vec3> data_normals_, chosen_, chosen_normal_, held_out_;
  std::vector<double> given_weight_, held_out_weight_;
  std::vector<double> emphasis_;  ///< one per chosen point, >= 1 (bound_residuals); empty: 1 each
  double total_weight_ = 0.0;
  double deviation_ = 1e-4;         ///< least robust deviation, of the diameter
  std::vector<double> stiffening_;  ///< one per patch, >= 1, times the bending there
  std::vector<bool> folding_;       ///< patches that the last step folded
  int steps_ = 0, iterations_ = 0;
  bool cut_ = false;  ///< it cuts itself already
  std::string reason_ = "as started";
};

}  // namespace pellicle
