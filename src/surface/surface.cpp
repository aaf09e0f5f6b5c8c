#include "pellicle/surface/surface.h"

#include <Eigen/SVD>
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
    case ModelKind::spline:
      return start_spline(SplineTopology::sphere);
    case ModelKind::spline_torus:
      return start_spline(SplineTopology::torus);
    case ModelKind::spline_cylinder:
      return start_spline(SplineTopology::cylinder);
    case ModelKind::spline_rectangle:
      return start_spline(SplineTopology::rectangle);
    case ModelKind::catmull_clark:
      return CatmullClarkModel::start();
    case ModelKind::slime:
      return SlimeModel::start();
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

namespace {

/// Axes of the ellipsoid before the map, longest first (columns), and their lengths after it.
Eigen::JacobiSVD<Mat3> axes_of(const Mat3& shape) {
  return Eigen::JacobiSVD<Mat3>(shape, Eigen::ComputeFullU | Eigen::ComputeFullV);
}

/// Least rotation that takes the axis z to one of the directions +-d.
Mat3 turned_to(const Vec3& d) {
  return Eigen::Quaterniond::FromTwoVectors(Vec3::UnitZ(), d.z() < 0.0 ? Vec3(-d) : d).toRotationMatrix();
}

template <class Model>
Mat3 posed(const Model& /*without axes*/, const Mat3& shape) {
  return shape;
}

Mat3 posed(const SplineModel& model, const Mat3& shape) {
  const auto axes = axes_of(shape);
  const Vec3& lengths = axes.singularValues();
  const SplineSettings& settings = model.settings();
  if (settings.topology == SplineTopology::sphere) {
    constexpr double kRound = 1.0 + 1e-9;  // a ball has no longest axis
    return lengths[0] <= kRound * lengths[2] ? shape : Mat3(shape * turned_to(axes.matrixV().col(0)));
  }
  if (settings.topology != SplineTopology::torus) return shape;
  // A solid torus of radii 1, r has <x^2> = <y^2> = 1/2 + 3 r^2/8 and <z^2> = r^2/4; a ball a^2/5.
  const double r2 = settings.reference_ratio * settings.reference_ratio;
  const double across = std::sqrt(5.0 * (0.5 + 0.375 * r2)), along = std::sqrt(1.25 * r2);
  return shape * turned_to(axes.matrixV().col(2)) * Vec3(1.0 / across, 1.0 / across, 1.0 / along).asDiagonal();
}

}  // namespace

Parameters on_ellipsoid(const SurfaceModel& model, const Vec3& centre, const Mat3& shape) {
  return affine_image(model, centre, std::visit([&](const auto& m) { return posed(m, shape); }, model));
}

void place_on(const SurfaceModel& model, const SampleLayout& layout, const SampleTargets& targets,
              Parameters& parameters) {
  std::visit(
      [&](const auto& m) {
        if constexpr (requires { m.place_on(layout, targets, parameters); }) m.place_on(layout, targets, parameters);
      },
      model);
}

double bending_scale(const SurfaceModel& model) {
  return std::visit(
      []<class Model>(const Model& /*any*/) {
        if constexpr (requires { Model::kBendingScale; }) {
          return Model::kBendingScale;
        } else {
          return 1.0;
        }
      },
      model);
}

int refinements_of(const SurfaceModel& model) {
  return std::visit([](const auto& m) { return m.refinements(); }, model);
}

bool is_closed(const SurfaceModel& model) {
  return std::visit([](const auto& m) { return m.is_closed(); }, model);
}

int degrees_of_freedom(const SurfaceModel& model) {
  return std::visit([](const auto& m) { return m.degrees_of_freedom(); }, model);
}

SampleLayout layout_of(const SurfaceModel& model, int level) {
  return std::visit([&](const auto& m) { return m.layout(level); }, model);
}

namespace {

int variant_of(const NormalModel& model) {
  return static_cast<int>(model.rule());
}

int variant_of(const SplineModel& model) {
  return static_cast<int>(model.settings().generator);
}

template <class Model>
int variant_of(const Model& /*of one kind*/) {
  return 0;
}

}  // namespace

LayoutKey layout_key(const SurfaceModel& model, int level) {
  Parameters reference = std::visit([](const auto& m) { return m.reference(); }, model);
  const Parameters somewhere = reference.empty() ? Parameters(3 * blocks_of(model).size()) : reference;
  return {model.index(), std::visit([](const auto& m) { return variant_of(m); }, model), level,
          control_mesh_of({model, somewhere}).triangles, std::move(reference)};
}

SampleLayout knot_layout_of(const SurfaceModel& model, int level) {
  if (const auto* spline = std::get_if<SplineModel>(&model)) return spline->knot_layout(level);
  return layout_of(model, level);
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

namespace {

NormalModel resting(const NormalModel& model, const Parameters& shape) {
  return {model.vertex_count(), model.triangles(), model.rule(), shape};
}

SplineModel resting(const SplineModel& model, const Parameters& /*shape*/) {
  return model;
}

CatmullClarkModel resting(const CatmullClarkModel& model, const Parameters& shape) {
  const Border border = model.is_closed() ? Border::refused : Border::allowed;
  return {model.vertex_count(), model.topology().quads, {shape, false}, border};
}

SlimeModel resting(const SlimeModel& model, const Parameters& shape) {
  return {model.vertex_count(), model.topology().quads, {shape, false}};
}

}  // namespace

Surface at_rest(const Surface& surface) {
  return {std::visit([&](const auto& m) -> SurfaceModel { return resting(m, surface.parameters); }, surface.model),
          surface.parameters};
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

int viewing_level(const Surface& surface) {
  const TriangleMesh control = control_mesh_of(surface);
  double extent = 0.0;
  for (const auto& vertex : control.vertices) extent = std::max(extent, (vertex - control.vertices.front()).norm());
  return std::clamp(tessellation_level(surface, extent / 100.0), 2, 6);
}

TriangleMesh control_mesh_of(const Surface& surface) {
  return std::visit([&](const auto& m) { return m.control_mesh(surface.parameters); }, surface.model);
}

std::string model_name(const SurfaceModel& model) {
  return std::visit([](const auto& m) { return m.name(); }, model);
}

}  // namespace pellicle
