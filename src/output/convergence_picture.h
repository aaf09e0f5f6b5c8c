#pragma once
/// How a fit went: the weighted energies, step by step, with the stages marked.

#include <string>
#include <vector>

#include "pellicle/job/segmentation.h"
#include "pellicle/picture/line_plot.h"

namespace pellicle {

/// A curve for each energy and one for their sum, over the steps of all stages, which are the spans. Curves break where
/// a stage begins: it weighs anew. A step's energies are those of its own targets, so that a curve may rise.
LinePlot convergence_of(const FitSummary& fit, const std::string& title);

/// A plot for each object, one below the other; of more than eight the first eight.
Canvas convergence_picture(const std::vector<ObjectResult>& objects, const std::string& name);

}  // namespace pellicle
