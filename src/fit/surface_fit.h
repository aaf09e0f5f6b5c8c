#pragma once
/// A fit that one can hold: one object in one image, from hypotheses to a judged surface, step by step.

#include <string>
#include <vector>

#include "pellicle/base/observer.h"
#include "pellicle/fit/judgement.h"
#include "pellicle/fit/options.h"
#include "pellicle/fit/stage.h"

namespace pellicle {

/// Values go in and out: a candidate moves, a request asks, an outcome and a judgement answer. Between the calls the
/// session keeps what depends on the image and the control meshes alone, so that a stage that is run again is cheap.
class SurfaceFit {
 public:
  /// \param image whole volume, LPS mm; must outlive the fit.
  /// \param points expert points; empty: none.
  /// \throws SettingError for options and points that break a rule.
  SurfaceFit(const Image<float>& image, ExpertPoints points, FitOptions options, Observer observer = {});

  /// The hypotheses about what a seed means, none of them advanced yet. \param name_prefix of their names.
  /// \throws UsageError for a seed that is an open surface; BadData for an image without contrast; Interrupted.
  std::vector<Candidate> propose(const Seed& seed, const std::string& name_prefix = {});
  /// The second line: ranges of intensities similar to the seed's. Empty where the settings or the seed leave no room
  /// for them.
  std::vector<Candidate> propose_similar(const Seed& seed, const std::string& name_prefix = {});

  /// Moves the candidate by one stage. \throws Interrupted.
  StageOutcome advance(Candidate& candidate, const StageRequest& request);

  Judgement judge(const Candidate& candidate);

  /// Advances an attempt to where candidates are compared, and judges it.
  void try_out(Attempt& attempt);
  /// From now on the surface is drawn to these points. \throws SettingError for weights that break a rule.
  void set_points(ExpertPoints points);

  const FitOptions& options() const { return options_; }
  /// The plan of this fit from a start of that kind.
  FitPlan plan(StartKind start) const { return plan_for(options_, start, !points_.points.empty()); }

 private:
  StageContext context() { return {image_, points_, geometry_, observer_}; }

  const Image<float>& image_;
  ExpertPoints points_;
  FitOptions options_;
  Observer observer_;
  GeometryCache geometry_;
};

}  // namespace pellicle
