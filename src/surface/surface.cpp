#include "pellicle/surface/surface.h"

#include <algorithm>
#include <cmath>

namespace pellicle {

std::vector<BlockKind> blocks_of(const SurfaceModel& model) {
  return std::visit([](const auto& m) { return m.blocks(); }, model);
}

int control_point_count(const SurfaceModel& model) {
  return std::get<NormalModel>(model).vertex_count();
}

int degrees_of_freedom(const SurfaceModel& model) {
  return std::visit([](const auto& m) { return m.degrees_of_freedom(); }, model);
}

SampleLayout layout_of(const SurfaceModel& model, int level) {
  return std::visit([&](const auto& m) { return m.layout(level); }, model);
}

void evaluate(const SurfaceModel& model, const Parameters& parameters, const SampleLayout& layout, bool with_jacobian,
              SurfaceSamples& samples) {
  std::visit([&](const auto& m) { m.evaluate(parameters, layout, with_jacobian, samples); }, model);
}

void pull_back(const SurfaceModel& model, const Parameters& parameters, const SampleLayout& layout,
               const std::vector<Vec3>& dE_dx, std::vector<double>& gradient) {
  std::visit([&](const auto& m) { m.pull_back(parameters, layout, dE_dx, gradient); }, model);
}

Surface refine(const Surface& surface) {
  return std::visit(
      [&](const auto& m) {
        auto [model, parameters] = m.refine(surface.parameters);
        return Surface{std::move(model), std::move(parameters)};
      },
      surface.model);
}

TriangleMesh mesh_of(const SampleLayout& layout, const SurfaceSamples& samples) {
  return {samples.x, layout.triangles, samples.normal};
}

TriangleMesh tessellate(const Surface& surface, int level) {
  const SampleLayout layout = layout_of(surface.model, level);
  SurfaceSamples samples;
  evaluate(surface.model, surface.parameters, layout, false, samples);
  return mesh_of(layout, samples);
}

int tessellation_level(const Surface& surface, double edge_mm) {
  constexpr int probe = 3, highest = 7;
  const TriangleMesh mesh = tessellate(surface, probe);
  double sum = 0;
  for (const auto& t : mesh.triangles) {
    for (int i = 0; i < 3; ++i) sum += (mesh.vertices[t[i]] - mesh.vertices[t[(i + 1) % 3]]).squaredNorm();
  }
  const double edge = std::sqrt(sum / (3 * static_cast<double>(mesh.triangles.size())));
  const double level = probe + std::log2(edge / edge_mm);
  if (!(level > 0)) return 0;
  return static_cast<int>(std::min<double>(std::ceil(level), highest));
}

TriangleMesh control_mesh_of(const Surface& surface) {
  const auto& model = std::get<NormalModel>(surface.model);
  TriangleMesh mesh;
  mesh.triangles = model.triangles();
  for (int v = 0; v < model.vertex_count(); ++v) {
    mesh.vertices.emplace_back(&surface.parameters[6 * std::size_t(v)]);
    mesh.normals.emplace_back(&surface.parameters[6 * std::size_t(v) + 3]);
  }
  return mesh;
}

std::string model_name(const SurfaceModel& /*model*/) {
  return "normal";
}

}  // namespace pellicle
