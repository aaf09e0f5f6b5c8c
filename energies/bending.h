#pragma once
/// bending: E = r^2 / (4 pi) int |H - (H : B) B / (B : B)|^2, H the Hessian of x as a function on the model's reference
/// shape, B that shape's second fundamental form, r^2 = its area / (4 pi); mm^2.
///
/// The reference shape's own coordinates have Hessians along B, so E = 0 for every affine image of it, at every place;
/// E scales with size^2 and does not know the image. On the unit sphere B is the metric, what is left of H is its
/// trace-free part, and the null space are the ellipsoids with any affine parameterisation; by parts
/// E = 1/(8 pi) int Lap x . (Lap + 2) x: a harmonic of degree l counts l(l+1)(l(l+1)-2)/2. Where the reference is flat
/// the whole of H counts. Discretised by a least-squares quadric at each sample whose basis holds 1, x, y, z
/// exactly, so that the null space is exact on any mesh.

#include "pellicle/energies/rows.h"
#include "pellicle/surface/samples.h"

namespace pellicle {

/// Two or three vector rows per sample; weight 1.
/// \pre layout.reference is filled.
VectorRows bending_rows(const SampleLayout& layout);

}  // namespace pellicle
