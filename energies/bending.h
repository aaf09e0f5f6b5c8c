#pragma once
/// bending: E = 1/(4 pi) int_{S^2} |trace-free Hessian of x|^2, x the surface as a function on the unit sphere; mm^2.
///
/// On the sphere a function has a vanishing trace-free Hessian exactly when it is a constant plus a linear function, so
/// E = 0 for every ellipsoid at every place, with any affine parameterisation; E scales with size^2 and does not
/// know the image. By parts E = 1/(8 pi) int Lap x . (Lap + 2) x: a harmonic of degree l counts l(l+1)(l(l+1)-2)/2.
/// Discretised by a least-squares quadric at each sample whose basis holds 1, x, y, z exactly, so that the null space
/// is exact on any mesh.

#include "pellicle/energies/rows.h"
#include "pellicle/surface/samples.h"

namespace pellicle {

/// Two vector rows a sample; weight 1. \pre layout.on_unit_sphere is filled.
VectorRows bending_rows(const SampleLayout& layout);

}  // namespace pellicle
