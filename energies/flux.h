#pragma once
/// flux: outward flux of the gradient of the smoothed image (Vasilevskiy, Siddiqi 2002), least where the surface runs
/// along the strongest edges; mm^2.
///
/// E = p h^2 s/(c A0) sum_i grad(G_s * I)(x_i) . a_i, p = +1 for a bright object (the gradient points inward), -1 for
/// a dark one, c the contrast, s the smoothing scale, A0 the area at the start: about -0.4 h^2 along an ideal step
/// edge whatever intensity unit, size and spacing.

#include <array>
#include <memory>

#include "pellicle/energies/term.h"
#include "pellicle/image/scalar_field.h"

namespace pellicle {

/// \param gradient the three components of the gradient image (world axes, intensity per mm), each C1-sampled.
/// Adds derivatives by x and by the area vectors; returns the energy. `scale` = weight p h^2 s/(c A0).
double flux(const std::array<CubicField, 3>& gradient, double scale, const std::vector<Vec3>& x,
            const std::vector<Vec3>& area_vector, std::vector<Vec3>& dE_dx, std::vector<Vec3>& dE_da);

/// The same flux pre-integrated (divergence theorem; Schmitter, Garcia-Amorena, Unser 2017, Eq. (20)): with e the
/// world direction of the first index axis and g = flux_antiderivative(image),
///   sum_i grad I(x_i) . a_i  =  sum_i g(x_i) e . a_i   (region_integral of region.h)
/// up to discretisation, on surfaces inside the volume. g is the antiderivative of the Laplacian along that axis:
/// dI/de, plus the running integral of the second differences across it. Intensity per mm.
Image<float> flux_antiderivative(const Image<float>& image);

/// Central differences of an image in intensity per mm along the world axes, one image per component.
std::array<Image<float>, 3> gradient_images(const Image<float>& image);

/// Its gradient images are kept as long as the working image stays the same.
struct FluxTerm {
  TermOutput operator()(const StepView& step);

  std::shared_ptr<const std::array<Image<float>, 3>> gradient = {};
  int version = -1;
};

}  // namespace pellicle
