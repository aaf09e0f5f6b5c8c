#include "pellicle/surface/spline/spline_model.h"

#include <gtest/gtest.h>

#include <map>
#include <numbers>
#include <set>

#include "pellicle/base/constants.h"
#include "pellicle/base/errors.h"
#include "pellicle/surface/surface.h"
#include "spline_cases.h"

namespace pellicle {
namespace {

using shapes::all_splines;
using shapes::block;
using shapes::perturbed;
using shapes::spline_sphere;

SurfaceSamples samples_of(const SplineModel& model, const Parameters& parameters, const SampleLayout& layout,
                          bool with_jacobian = false) {
  SurfaceSamples samples;
  model.evaluate(parameters, layout, with_jacobian, samples);
  return samples;
}

Mat3 skewed() {
  Mat3 A;
  A << 2, 0.3, -0.4, 0.1, 1.2, 0.5, -0.2, 0.3, 0.7;
  return A;
}

Parameters mapped(const SplineModel& model, const Parameters& parameters, const Vec3& centre, const Mat3& A) {
  Parameters result;
  const std::vector<BlockKind> kinds = model.blocks();
  for (std::size_t b = 0; b < kinds.size(); ++b) {
    const Vec3 x = A * block(parameters, static_cast<int>(b)) + (kinds[b] == BlockKind::point ? centre : Vec3::Zero());
    result.insert(result.end(), x.begin(), x.end());
  }
  return result;
}

/// Sides of every edge: 2 and opposite on closed meshes. Returns V - E + F.
int euler_number(const SampleLayout& layout, bool closed) {
  std::map<std::pair<int, int>, int> edges;
  std::set<int> used;
  for (const auto& t : layout.triangles) {
    for (int i = 0; i < 3; ++i) {
      used.insert(t[i]);
      EXPECT_TRUE(edges.emplace(std::pair(t[i], t[(i + 1) % 3]), 0).second) << "two triangles on one side of an edge";
    }
  }
  int undirected = 0;
  for (const auto& [edge, unused] : edges) {
    const bool both = edges.contains({edge.second, edge.first});
    EXPECT_TRUE(both || !closed) << "open edge";
    undirected += both ? 1 : 2;
  }
  EXPECT_EQ(static_cast<int>(used.size()), layout.sample_count());
  return layout.sample_count() - undirected / 2 + static_cast<int>(layout.triangles.size());
}

TEST(SplineModel, GoldenSphere) {
  for (const char* size : {"5x3", "6x4"}) {
    const nlohmann::json golden = shapes::spline_golden("exp_sphere").at(size);
    const SplineModel model = spline_sphere(size[0] - '0', size[2] - '0');
    const Parameters sphere = shapes::in_block_order(golden.at("sphere_parameters"));
    ASSERT_EQ(sphere.size(), model.reference().size());
    for (std::size_t i = 0; i < sphere.size(); ++i) EXPECT_NEAR(model.reference()[i], sphere[i], 1e-14);
    const Parameters parameters = shapes::in_block_order(golden.at("parameters"));
    for (std::size_t i = 0; i < golden.at("u").size(); ++i) {
      const SplinePoint at = model.at(parameters, golden.at("u").at(i), golden.at("v").at(i));
      EXPECT_LE((at.x - shapes::vector(golden.at("S").at(i))).norm(), 1e-14);
      EXPECT_LE((at.x_u - shapes::vector(golden.at("Su").at(i))).norm(), 1e-13);
      EXPECT_LE((at.x_v - shapes::vector(golden.at("Sv").at(i))).norm(), 1e-13);
    }
  }
}

TEST(SplineModel, SphereIsExact) {
  for (const auto& [m1, m2] : {std::pair{4, 2}, {5, 3}, {6, 4}, {10, 6}, {4, 7}, {12, 12}, {4, 40}}) {
    const SplineModel model = spline_sphere(m1, m2);
    const SampleLayout layout = model.layout(2);
    const SurfaceSamples samples = samples_of(model, model.reference(), layout);
    for (int i = 0; i < layout.sample_count(); ++i) {
      EXPECT_LE((samples.x[i] - layout.reference[i]).norm(), 1e-14) << m1 << "x" << m2;
      EXPECT_LE((samples.normal[i] - layout.reference[i]).norm(), 1e-12) << m1 << "x" << m2;
    }
  }
}

TEST(SplineModel, TorusIsExact) {
  for (const double ratio : {0.2, 0.4, 0.9}) {
    const SplineModel model({.topology = SplineTopology::torus, .m1 = 7, .m2 = 4, .reference_ratio = ratio});
    const SampleLayout layout = model.layout(2);
    const SurfaceSamples samples = samples_of(model, model.reference(), layout);
    for (int i = 0; i < layout.sample_count(); ++i) {
      const Vec3& x = samples.x[i];
      EXPECT_LE((x - layout.reference[i]).norm(), 1e-14);
      const Vec3 core = Vec3(x.x(), x.y(), 0).normalized();
      EXPECT_NEAR((x - core).norm(), ratio, 1e-14);
      EXPECT_LE((samples.normal[i] - (x - core) / ratio).norm(), 1e-13);
    }
  }
}

TEST(SplineModel, OpenShapesAreExact) {
  for (const SplineTopology topology : {SplineTopology::cylinder, SplineTopology::rectangle}) {
    const SplineModel model({.topology = topology, .m1 = 4, .m2 = 3});
    const SampleLayout layout = model.layout(2);
    const SurfaceSamples samples = samples_of(model, model.reference(), layout);
    for (int i = 0; i < layout.sample_count(); ++i) {
      const Vec3& x = samples.x[i];
      EXPECT_LE((x - layout.reference[i]).norm(), 1e-14);
      const Vec3 normal = topology == SplineTopology::cylinder ? Vec3(x.x(), x.y(), 0) : Vec3::UnitZ();
      EXPECT_LE((samples.normal[i] - normal).norm(), 1e-13);
      EXPECT_LE(std::max(std::abs(x.x()), std::abs(x.z())), 1.0 + 1e-14);
    }
  }
}

TEST(SplineModel, FollowsAffineMaps) {
  RandomEngine random(11);
  const Vec3 centre(30, -20, 7);
  for (const SplineModel& model : all_splines()) {
    const Parameters parameters = perturbed(model, 0.1, random);
    const SampleLayout layout = model.layout(1);
    const SurfaceSamples before = samples_of(model, parameters, layout);
    const SurfaceSamples after = samples_of(model, mapped(model, parameters, centre, skewed()), layout);
    const Mat3 of_normals = skewed().inverse().transpose();
    for (int i = 0; i < layout.sample_count(); ++i) {
      EXPECT_LE((after.x[i] - centre - skewed() * before.x[i]).norm(), 1e-13);
      EXPECT_LE((after.normal[i] - (of_normals * before.normal[i]).normalized()).norm(), 1e-10);
    }
  }
}

TEST(SplineModel, PassesThroughItsControlPoints) {
  RandomEngine random(12);
  for (const SplineModel& model : all_splines()) {
    const Parameters parameters = perturbed(model, 0.2, random);
    const std::vector<Vec3> grid = model.control_grid(parameters);
    const auto [topology, m1, m2, generator, ratio] = model.settings();
    for (int l = 0; l <= m2; ++l) {
      for (int k = 0; k <= m1; ++k) {
        const Vec3& c = grid[model.along_u().row(k) + model.along_u().rows() * model.along_v().row(l)];
        EXPECT_LE((model.at(parameters, double(k) / m1, double(l) / m2).x - c).norm(), 1e-14);
      }
    }
    const TriangleMesh control = model.control_mesh(parameters);
    SampleLayout as_layout;
    as_layout.triangles = control.triangles;
    as_layout.patch_of.resize(control.vertices.size());
    const int euler = topology == SplineTopology::sphere ? 2 : topology == SplineTopology::rectangle ? 1 : 0;
    EXPECT_EQ(euler_number(as_layout, model.is_closed()), euler);
    if (model.is_closed()) {
      EXPECT_GT(shapes::flat_volume(control), 0.0);
    }
  }
}

TEST(SplineModel, JacobianAndPullBackMatchDifferences) {
  RandomEngine random(13);
  for (const SplineModel& model : all_splines()) {
    Parameters parameters = perturbed(model, 0.1, random);
    const SampleLayout layout = model.layout(1);
    const SurfaceSamples samples = samples_of(model, parameters, layout, true);
    std::vector<Vec3> bar(layout.patch_of.size());
    for (Vec3& b : bar) b = shapes::random_vector(random, 1.0);
    std::vector<double> gradient(parameters.size(), 0.0);
    model.pull_back(parameters, layout, bar, gradient);
    for (std::size_t p = 0; p < parameters.size(); ++p) {
      const double kept = parameters[p];
      parameters[p] = kept + 0.5;  // linear: any step is exact
      const std::vector<Vec3> moved = samples_of(model, parameters, layout).x;
      parameters[p] = kept;
      double sum = 0;
      for (const SamplePatch& patch : layout.patches) {
        const auto at = std::find(patch.blocks.begin(), patch.blocks.end(), static_cast<int>(p / 3));
        for (int k = 0; k < patch.sample_count; ++k) {
          const int i = patch.first_sample + k;
          const Vec3 slope = (moved[i] - samples.x[i]) / 0.5;
          sum += slope.dot(bar[i]);
          Vec3 derivative = Vec3::Zero();
          for (int axis = 0; axis < 3 && at != patch.blocks.end(); ++axis) {
            derivative[axis] = samples.jacobian[patch.jacobian_offset + (3 * k + axis) * std::size_t(patch.columns()) +
                                                3 * (at - patch.blocks.begin()) + p % 3];
          }
          ASSERT_LE((derivative - slope).norm(), 1e-13);
        }
      }
      EXPECT_NEAR(gradient[p], sum, 1e-11);
    }
  }
}

TEST(SplineModel, SamplesAreThoseOfThePointEvaluation) {
  RandomEngine random(14);
  const SplineModel model = spline_sphere(6, 4);
  const Parameters parameters = perturbed(model, 0.2, random);
  const SampleLayout layout = model.layout(2);
  const SurfaceSamples samples = samples_of(model, parameters, layout);
  for (int i = 0; i < layout.sample_count(); ++i) {
    const Vec3& d = layout.reference[i];
    double u = std::atan2(d.y(), d.x()) / (2 * kPi);
    u -= std::floor(u);
    const SplinePoint at = model.at(parameters, u, std::acos(std::clamp(d.z(), -1.0, 1.0)) / kPi);
    EXPECT_LE((samples.x[i] - at.x).norm(), 1e-13);
    if (std::abs(d.z()) < 0.999) {
      EXPECT_LE((samples.normal[i] + at.x_u.cross(at.x_v).normalized()).norm(), 1e-11);
    }
  }
}

TEST(SplineModel, DerivativesOfThePointEvaluation) {
  RandomEngine random(15);
  for (const SplineModel& model : all_splines()) {
    const Parameters parameters = perturbed(model, 0.2, random);
    for (int trial = 0; trial < 20; ++trial) {
      const double u = random.uniform(0.01, 0.99), v = random.uniform(0.01, 0.99), h = 1e-6;
      const SplinePoint at = model.at(parameters, u, v);
      const Vec3 by_u = (model.at(parameters, u + h, v).x - model.at(parameters, u - h, v).x) / (2 * h);
      const Vec3 by_v = (model.at(parameters, u, v + h).x - model.at(parameters, u, v - h).x) / (2 * h);
      EXPECT_LE((by_u - at.x_u).norm(), 1e-4);  // sigma_uu jumps at knots
      EXPECT_LE((by_v - at.x_v).norm(), 1e-4);
    }
  }
}

TEST(SplineModel, PolesAreSmooth) {
  RandomEngine random(16);
  for (const auto& [m1, m2] : {std::pair{4, 2}, {5, 3}, {7, 2}, {10, 6}}) {
    const SplineModel model = spline_sphere(m1, m2);
    const Parameters parameters = perturbed(model, 0.2, random);
    for (const bool north : {true, false}) {
      const Vec3 t1 = block(parameters, north ? 2 : 4), t2 = block(parameters, north ? 3 : 5);
      const Vec3 pole_normal = (north ? 1.0 : -1.0) * t1.cross(t2).normalized();
      double previous = 1;
      for (const double away : {1e-3, 1e-4, 1e-5}) {
        double worst = 0;
        for (double u = 0.0; u < 1.0; u += 0.037) {
          const SplinePoint at = model.at(parameters, u, north ? away : 1 - away);
          worst = std::max(worst, (pole_normal + at.x_u.cross(at.x_v).normalized()).norm());
          const SplinePoint pole = model.at(parameters, u, north ? 0 : 1);
          EXPECT_LE((pole.x - block(parameters, north ? 0 : 1)).norm(), 1e-14);
          EXPECT_LE(pole.x_u.norm(), 1e-13);
          EXPECT_LE((pole.x_v - t1 * std::cos(2 * kPi * u) - t2 * std::sin(2 * kPi * u)).norm(), 1e-13);
        }
        EXPECT_LE(worst, 100 * away) << m1 << "x" << m2;
        EXPECT_LE(worst, 0.12 * previous) << "first order";
        previous = worst;
      }
    }
    const SampleLayout layout = model.layout(0);
    const SurfaceSamples samples = samples_of(model, parameters, layout);
    int poles = 0;
    for (int i = 0; i < layout.sample_count(); ++i) {
      if (std::abs(layout.reference[i].z()) != 1.0) continue;
      const bool north = layout.reference[i].z() > 0;
      const Vec3 normal = block(parameters, north ? 2 : 4).cross(block(parameters, north ? 3 : 5)).normalized();
      EXPECT_LE((samples.normal[i] - (north ? normal : -normal)).norm(), 1e-14);
      EXPECT_LE((samples.x[i] - block(parameters, north ? 0 : 1)).norm(), 1e-14);
      ++poles;
    }
    EXPECT_EQ(poles, 2);
  }
}

TEST(SplineModel, LayoutsAreClosedOutwardAndOfTheRightGenus) {
  for (const SplineModel& model : all_splines()) {
    const auto topology = model.settings().topology;
    const int euler = topology == SplineTopology::sphere ? 2 : topology == SplineTopology::rectangle ? 1 : 0;
    for (int level = 0; level <= 3; ++level) {
      const SampleLayout layout = model.layout(level);
      EXPECT_EQ(static_cast<int>(layout.triangles.size()), model.base_facets() << (2 * level));
      EXPECT_EQ(euler_number(layout, model.is_closed()), euler);
      EXPECT_EQ(layout.level, level);
      int next = 0;
      for (std::size_t p = 0; p < layout.patches.size(); ++p) {
        const SamplePatch& patch = layout.patches[p];
        EXPECT_EQ(patch.first_sample, next);
        for (int k = 0; k < patch.sample_count; ++k) EXPECT_EQ(layout.patch_of[next + k], static_cast<int>(p));
        EXPECT_TRUE(std::is_sorted(patch.blocks.begin(), patch.blocks.end()));
        next += patch.sample_count;
      }
      EXPECT_EQ(next, layout.sample_count());
      const SurfaceSamples samples = samples_of(model, model.reference(), layout);
      const TriangleMesh mesh = mesh_of(layout, samples);
      if (model.is_closed()) {
        EXPECT_GT(shapes::flat_volume(mesh), 0.0);
      }
      for (const auto& [a, b, c] : mesh.triangles) {
        const Vec3 facet = (mesh.vertices[b] - mesh.vertices[a]).cross(mesh.vertices[c] - mesh.vertices[a]);
        EXPECT_GT(facet.dot(mesh.normals[a] + mesh.normals[b] + mesh.normals[c]), 0.0);
      }
      if (level == 0) continue;
      std::set<std::array<double, 3>> places;  // levels nest
      for (const Vec3& r : layout.reference) places.insert({r.x(), r.y(), r.z()});
      for (const Vec3& r : model.layout(level - 1).reference) EXPECT_TRUE(places.contains({r.x(), r.y(), r.z()}));
    }
  }
}

TEST(SplineModel, SphereSamplesAreEvenlySpread) {
  for (const auto& [m1, m2] : {std::pair{4, 2}, {10, 6}, {24, 16}}) {
    const SplineModel model = spline_sphere(m1, m2);
    const SampleLayout layout = model.layout(2);
    double least = 1e9, most = 0;
    for (const auto& [a, b, c] : layout.triangles) {
      const auto& r = layout.reference;
      const double area = (r[b] - r[a]).cross(r[c] - r[a]).norm();
      least = std::min(least, area);
      most = std::max(most, area);
    }
    EXPECT_LE(most, 2.2 * least) << m1 << "x" << m2;
    const double net = 2.0 * m1 * (m2 - 1);
    EXPECT_LE(std::abs(std::log2(model.base_facets() / net)), model.base_facets() == 20 ? 1.4 : 1.0);
  }
}

TEST(SplineModel, SphereLayoutTouchesEveryBlock) {
  for (const SplineModel& model : all_splines()) {
    std::set<int> blocks;
    for (const SamplePatch& patch : model.layout(1).patches) blocks.insert(patch.blocks.begin(), patch.blocks.end());
    EXPECT_EQ(blocks.size(), model.blocks().size());
  }
}

TEST(SplineRefine, IsExactForEllipsoidsAndTori) {
  for (const SplineModel& model : {spline_sphere(4, 2), spline_sphere(6, 4), start_spline(SplineTopology::torus)}) {
    const Parameters coarse = mapped(model, model.reference(), Vec3(1, 2, 3), skewed());
    const auto [fine, parameters] = model.refine(coarse);
    const Parameters expected = mapped(fine, fine.reference(), Vec3(1, 2, 3), skewed());
    ASSERT_EQ(parameters.size(), expected.size());
    for (std::size_t i = 0; i < expected.size(); ++i) EXPECT_NEAR(parameters[i], expected[i], 1e-13);
  }
}

TEST(SplineRefine, ClimbsTheLadder) {
  SplineModel model = start_spline(SplineTopology::sphere);
  Parameters parameters = model.reference();
  const std::vector<std::pair<int, int>> ladder{{4, 2}, {6, 4}, {10, 6}, {16, 10}, {24, 16}, {36, 24}};
  for (std::size_t rung = 0; rung < ladder.size(); ++rung) {
    EXPECT_EQ(model.settings().m1, ladder[rung].first);
    EXPECT_EQ(model.settings().m2, ladder[rung].second);
    EXPECT_EQ(model.refinements(), static_cast<int>(rung));
    std::tie(model, parameters) = model.refine(parameters);
  }
  EXPECT_EQ(spline_sphere(5, 2).refinements(), 0);
  EXPECT_EQ(spline_sphere(10, 7).refinements(), 2);
  EXPECT_EQ(spline_sphere(200, 100).refinements(), 9);
}

TEST(SplineRefine, KeepsControlPointsPolesAndOpenBorders) {
  RandomEngine random(17);
  for (const SplineModel& model : all_splines()) {
    const Parameters before = perturbed(model, 0.2, random);
    const auto [fine, after] = model.refine(before);
    EXPECT_EQ(fine.settings().topology, model.settings().topology);
    EXPECT_EQ(fine.settings().generator, model.settings().generator);
    const auto [topology, m1, m2, generator, ratio] = fine.settings();
    for (int l = 0; l <= m2; ++l) {
      for (int k = 0; k <= m1; ++k) {
        const double u = double(k) / m1, v = double(l) / m2;
        const SplinePoint a = model.at(before, u, v), b = fine.at(after, u, v);
        EXPECT_LE((a.x - b.x).norm(), 1e-13);
        // Keys' generator keeps a pole's slopes at the old knots only: it does not reproduce cos and sin
        const bool exact = topology != SplineTopology::sphere || generator == SplineGenerator::exponential;
        const bool border = topology != SplineTopology::torus && exact && (l == 0 || l == m2);
        if (border) {
          EXPECT_LE((a.x_v - b.x_v).norm(), 1e-12);
        }
        if (topology == SplineTopology::rectangle && (k == 0 || k == m1)) {
          EXPECT_LE((a.x_u - b.x_u).norm(), 1e-12);
        }
      }
    }
  }
}

/// Bumps on the sphere, as a smooth function of the direction.
Vec3 bumpy(const Vec3& d) {
  return (1 + 0.1 * std::sin(2 * d.x() + 1) * std::cos(3 * d.y()) + 0.1 * std::sin(2 * d.z())) * d;
}

Parameters sampled(const SplineModel& model, Vec3 (*shape)(const Vec3&)) {
  Parameters result = model.reference();
  const double h = 1e-5;
  for (std::size_t b = 0; b < result.size() / 3; ++b) {
    Eigen::Map<Vec3> x(&result[3 * b]);
    if (model.blocks()[b] == BlockKind::point) {
      x = shape(Vec3(x).normalized()).eval();
    } else {  // tangents are pi times the derivative along them
      const Vec3 pole(0, 0, b < 4 ? 1 : -1), w = Vec3(x).normalized();
      x = kPi * (shape((pole + h * w).normalized()) - shape((pole - h * w).normalized())) / (2 * h);
    }
  }
  return result;
}

double distance(const SplineModel& a, const Parameters& pa, const SplineModel& b, const Parameters& pb) {
  double worst = 0;
  for (double v = 0.013; v < 1; v += 0.0131) {
    for (double u = 0.007; u < 1; u += 0.0097) worst = std::max(worst, (a.at(pa, u, v).x - b.at(pb, u, v).x).norm());
  }
  return worst;
}

TEST(SplineRefine, ErrorFallsWithTheThirdPower) {
  double previous = 0;
  for (const int m : {32, 64}) {
    const SplineModel model = spline_sphere(m, m / 2);
    const Parameters parameters = sampled(model, bumpy);
    const auto [fine, refined] = model.refine(parameters);
    const double moved = distance(model, parameters, fine, refined);
    EXPECT_GT(moved, 0);
    if (previous > 0) {
      EXPECT_GE(std::log2(previous / moved), 2.7) << m;
    }
    previous = moved;
  }
  EXPECT_LE(previous, 1.2e-4);
}

TEST(SplinePoles, AreExactForEllipsoids) {
  RandomEngine random(18);
  for (const auto& [m1, m2] : {std::pair{4, 2}, {7, 5}}) {
    const SplineModel model = spline_sphere(m1, m2);
    const Parameters ellipsoid = mapped(model, model.reference(), Vec3(1, 2, 3), skewed());
    for (const Vec3& axis : {Vec3(1, 0, 0), Vec3(0, 0, 1), Vec3(0, 0, -2), Vec3(0.3, 0.1, -0.9), Vec3(1e-9, 0, 1)}) {
      const Parameters placed = place_poles(model, ellipsoid, axis);
      EXPECT_LE((block(placed, 0) - Vec3(1, 2, 3) - skewed() * axis.normalized()).norm(), 1e-13);
      EXPECT_LE((block(placed, 1) - Vec3(1, 2, 3) + skewed() * axis.normalized()).norm(), 1e-13);
      const bool between = axis.head<2>().norm() < 1e-8 && axis.x() != 0;  // derivatives are those of the pole itself
      const SurfaceSamples samples = samples_of(model, placed, model.layout(2));
      for (std::size_t i = 0; i < samples.x.size(); ++i) {
        const Vec3 on_sphere = skewed().inverse() * (samples.x[i] - Vec3(1, 2, 3));
        EXPECT_NEAR(on_sphere.norm(), 1.0, between ? 1e-8 : 1e-12);
        EXPECT_LE((samples.normal[i] - (skewed().inverse().transpose() * on_sphere).normalized()).norm(),
                  between ? 1e-8 : 1e-11);
      }
    }
  }
}

TEST(SplinePoles, FollowOtherSurfacesEverMoreClosely) {
  double previous = 0;
  for (const int m : {12, 24}) {
    const SplineModel model = spline_sphere(m, m / 2);
    const Parameters parameters = sampled(model, bumpy);
    const Parameters placed = place_poles(model, parameters, Vec3(1, 0.2, 0.1));
    const Mat3 turn = Eigen::Quaterniond::FromTwoVectors(Vec3::UnitZ(), Vec3(1, 0.2, 0.1)).toRotationMatrix();
    const SampleLayout layout = model.layout(1);
    const SurfaceSamples samples = samples_of(model, placed, layout);
    double worst = 0;
    for (int i = 0; i < layout.sample_count(); ++i) {
      worst = std::max(worst, (samples.x[i] - bumpy(turn * layout.reference[i])).norm());
    }
    if (previous > 0) {
      EXPECT_LE(worst, previous / 5);
    }
    previous = worst;
  }
  EXPECT_LE(previous, 4e-3);
}

TEST(SplinePoles, RefusesWhatHasNone) {
  const SplineModel torus = start_spline(SplineTopology::torus);
  EXPECT_THROW(place_poles(torus, torus.reference(), Vec3(1, 0, 0)), UsageError);
  const SplineModel sphere = start_spline(SplineTopology::sphere);
  EXPECT_THROW(place_poles(sphere, sphere.reference(), Vec3(0, 0, 0)), UsageError);
}

TEST(SplineModel, CountsItsFreedom) {
  for (const auto& [m1, m2, dof] : {std::array{4, 2, 30}, {4, 4, 54}, {6, 4, 72}, {8, 8, 186}, {12, 12, 414}}) {
    EXPECT_EQ(spline_sphere(m1, m2).degrees_of_freedom(), dof);
  }
  EXPECT_EQ(start_spline(SplineTopology::torus).degrees_of_freedom(), 72);
  EXPECT_EQ(start_spline(SplineTopology::cylinder).degrees_of_freedom(), 3 * 4 * 4);
  EXPECT_EQ(start_spline(SplineTopology::rectangle).degrees_of_freedom(), 3 * 4 * 4);
  EXPECT_EQ(start_spline(SplineTopology::sphere).name(), "spline");
  EXPECT_EQ(start_spline(SplineTopology::torus).name(), "spline-torus");
}

TEST(SplineModel, RefusesSizesThatDoNotWork) {
  const auto make = [](SplineTopology topology, int m1, int m2) {
    return SplineModel({.topology = topology, .m1 = m1, .m2 = m2});
  };
  EXPECT_THROW(make(SplineTopology::sphere, 3, 2), UsageError);
  EXPECT_THROW(make(SplineTopology::sphere, 4, 1), UsageError);
  EXPECT_THROW(make(SplineTopology::torus, 6, 3), UsageError);
  EXPECT_THROW(make(SplineTopology::cylinder, 4, 0), UsageError);
  EXPECT_THROW(make(SplineTopology::rectangle, 0, 1), UsageError);
  EXPECT_THROW(make(SplineTopology::sphere, 2000000000, 2000000000), UsageError);
  EXPECT_THROW(SplineModel({.topology = SplineTopology::torus, .m1 = 6, .m2 = 4, .reference_ratio = shapes::kNaN}),
               UsageError);
  const SplineModel model = spline_sphere(4, 2);
  EXPECT_THROW(model.layout(8), UsageError);
  EXPECT_THROW(model.layout(-1), UsageError);
  EXPECT_THROW(model.control_grid(Parameters(3)), BadData);
  EXPECT_THROW(samples_of(model, Parameters(3), model.layout(0)), BadData);
}

}  // namespace
}  // namespace pellicle
