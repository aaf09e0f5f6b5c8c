#include "pellicle/surface/surface.h"

#include <algorithm>
#include <cmath>

#include "pellicle/base/errors.h"

namespace pellicle {

std::vector<BlockKind> blocks_of(const SurfaceModel& model) {
  return std::visit([](const auto& m) { return m.blocks(); }, model);
}

int control_point_count(const SurfaceModel& model) {
  const std::vector<BlockKind> blocks = blocks_of(model);
  return static_cast<int>(std::count(blocks.begin(), blocks.end(), BlockKind::point));
}

int base_facets(const SurfaceModel& model) {
  return std::visit([](const auto& m) { return m.base_facets(); }, model);
}

SurfaceModel start_model(const ModelChoice& choice) {
  switch (choice.kind) {
    case ModelKind::normal:
      break;
  }
  return NormalModel::start(choice.solid, choice.rule);
}

Parameters affine_image(const SurfaceModel& model, const Vec3& centre, const Mat3& A) {
  Parameters result = std::visit([](const auto& m) { return m.reference(); }, model);
  if (result.empty()) throw BadData("control mesh (all): has no reference shape to map; start from a solid");
  const Mat3 of_normals = A.inverse().transpose();
  double* block = result.data();
  for (const BlockKind kind : blocks_of(model)) {
    Eigen::Map<Vec3> v(block);
    switch (kind) {
      case BlockKind::point:
        v = (centre + A * v).eval();
        break;
      case BlockKind::unit_normal:
        v = (of_normals * v).normalized().eval();
        break;
      case BlockKind::vector:
        v = (A * v).eval();
        break;
    }
    block += 3;
  }
  return result;
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
  return std::visit([&](const auto& m) { return m.control_mesh(surface.parameters); }, surface.model);
}

std::string model_name(const SurfaceModel& model) {
  return std::visit([](const auto& m) { return m.name(); }, model);
}

}  // namespace pellicle
