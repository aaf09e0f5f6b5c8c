#include "pellicle/fit/scalars.h"

#include <memory>

#include "pellicle/energies/flux.h"
#include "pellicle/energies/inflation.h"
#include "pellicle/energies/volume.h"
#include "pellicle/mesh/measure.h"

namespace pellicle {

namespace {

double weight(const Stage& stage, const char* name) {
  const auto at = stage.energies.find(name);
  return at == stage.energies.end() ? 0.0 : at->second;
}

ScalarEnergy flux_energy(const ScalarInputs& in) {
  auto images = std::make_shared<std::array<Image<float>, 3>>(gradient_images(in.image));
  const double smoothing = in.stage.smoothing_mm.value_or(in.stage.smoothing * in.h);
  const double contrast = std::abs(in.state.levels.contrast());
  const double scale = weight(in.stage, "flux") * in.state.reading.sign * in.h * in.h *
                       std::max(smoothing, 0.5 * in.h) / (contrast * in.area);
  return {"flux", [images, scale](const auto& x, const auto& area, auto& dx, auto& da) {
            const std::array<CubicField, 3> fields{CubicField((*images)[0]), CubicField((*images)[1]),
                                                   CubicField((*images)[2])};
            return flux(fields, scale, x, area, dx, da);
          }};
}

ScalarEnergy region_energy(const ScalarInputs& in) {
  auto image = std::make_shared<Image<float>>(
      antiderivative(region_potential(in.image, in.state.levels.inside, in.state.levels.outside)));
  const double scale = weight(in.stage, "region") * in.h / in.area;
  const Vec3 axis = in.image.grid.direction.col(0);
  return {"region", [image, scale, axis](const auto& x, const auto& area, auto& dx, auto& da) {
            return region_integral(CubicField(*image), axis, scale, x, area, dx, da);
          }};
}

}  // namespace

std::vector<ScalarEnergy> scalar_energies(const ScalarInputs& in) {
  std::vector<ScalarEnergy> energies;
  const SampleLayout* layout = &in.geometry.layout;
  if (weight(in.stage, "flux") != 0.0) energies.push_back(flux_energy(in));
  if (weight(in.stage, "region") != 0.0 && in.stage.solver == Solver::gradient) energies.push_back(region_energy(in));
  if (in.stage.target_volume) {
    const double target = *in.stage.target_volume;
    SurfaceSamples samples;
    evaluate(in.state.surface.model, in.state.surface.parameters, *layout, false, samples);
    const double correction = volume_with_normals(mesh_of(*layout, samples)) / in.volume;
    const double w = weight(in.stage, "volume");
    energies.push_back({"volume", [=](const auto& x, const auto& area, auto& dx, auto&) {
                          return volume_prior(facet_volume(*layout, x), correction, target, w, area, dx);
                        }});
  }
  if (const double w = weight(in.stage, "inflation"); w != 0.0) {
    const double volume = in.volume, area = in.area, h = in.h;
    energies.push_back({"inflation", [=](const auto& x, const auto& area_vector, auto& dx, auto&) {
                          return inflation(facet_volume(*layout, x), volume, area, h, w, area_vector, dx);
                        }});
  }
  return energies;
}

}  // namespace pellicle
