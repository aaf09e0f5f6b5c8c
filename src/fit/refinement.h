#pragma once
/// How far a chosen candidate is refined. Samples and expert points that are left out of a fit say it: more control
/// points, more or less smoothness, or no image at all are kept only where they predict what was left out better.

#include <optional>

#include "pellicle/fit/surface_fit.h"

namespace pellicle {

/// The best of what was tried so far, and the stage that led to it.
struct Refined {
  Candidate candidate;
  StageOutcome outcome;
  Stage stage;
};

/// Runs the stages after the point of comparison, each with samples left out, until finer control meshes predict these
/// no better, what is left is noise, or the error target is met. None: no stage measures anything.
std::optional<Refined> choose_detail(SurfaceFit& fit, Attempt& attempt);

/// Runs the stage again with more, then with less bending, as long as that predicts better.
void choose_smoothness(SurfaceFit& fit, Attempt& attempt, Refined& best);

/// Runs the stage from the start without the image; kept where expert points that were left out are predicted better
/// so (the image shows edges of another polarity, or of another object).
void choose_image_or_points(SurfaceFit& fit, Attempt& attempt, Refined& best);

/// All three in turn, then the chosen stage with all samples; judges the attempt again.
void refine_by_prediction(SurfaceFit& fit, Attempt& attempt);

}  // namespace pellicle
