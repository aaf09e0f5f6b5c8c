#pragma once
/// tension: E = 1/(8 pi) int |grad x|^2 over the reference shape, mm^2: a membrane. A sphere of radius R has E = R^2; E
/// is least, for a given surface, when samples are spread conformally; it pulls the surface together, so its weight is
/// kept small.

#include "pellicle/energies/rows.h"
#include "pellicle/surface/samples.h"

namespace pellicle {

/// Two vector rows a facet of the reference shape (linear finite elements): second order in the facet size for any
/// angles.
VectorRows tension_rows(const SampleLayout& layout);

}  // namespace pellicle
