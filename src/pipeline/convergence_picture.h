#pragma once
/// How a fit went: the weighted energies, step by step, with the stages marked.

#include <filesystem>
#include <string>
#include <vector>

#include "pellicle/pipeline/line_plot.h"
#include "pellicle/pipeline/segment.h"

namespace pellicle {

/// A curve an energy and one for their sum, over the steps of all stages, which are the spans. Curves break where a
/// stage begins: it weighs anew. A step's energies are those of its own targets, so that a curve may rise.
LinePlot convergence_of(const FitSummary& fit, const std::string& title);

/// A plot an object, one below the other; of more than eight the first eight. \throws CannotCreate, IoError.
void write_convergence_picture(const std::filesystem::path& path, const std::vector<ObjectResult>& objects,
                               const std::string& name);

}  // namespace pellicle
