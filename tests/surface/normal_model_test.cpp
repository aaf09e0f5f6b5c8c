#include "pellicle/surface/normal/normal_model.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <numbers>
#include <set>

#include "pellicle/base/errors.h"
#include "pellicle/mesh/measure.h"
#include "shapes.h"

namespace pellicle {
namespace {

using Triangles = std::vector<std::array<int, 3>>;

/// Every directed edge once, each with its reverse.
void expect_closed(const Triangles& triangles) {
  std::set<std::pair<int, int>> edges;
  for (const auto& t : triangles) {
    for (int i = 0; i < 3; ++i) ASSERT_TRUE(edges.emplace(t[i], t[(i + 1) % 3]).second);
  }
  for (const auto& [a, b] : edges) ASSERT_TRUE(edges.contains({b, a}));
}

TriangleMesh mesh_at(const NormalModel& model, const Parameters& parameters, int level) {
  return tessellate({model, parameters}, level);
}

/// Largest angle in degrees between a facet and the limit normals at its corners.
double largest_angle(const TriangleMesh& mesh) {
  double least = 1;
  for (const auto& [a, b, c] : mesh.triangles) {
    const Vec3& p = mesh.vertices[a];
    const Vec3 facet = (mesh.vertices[b] - p).cross(mesh.vertices[c] - p).normalized();
    for (const int v : {a, b, c}) least = std::min(least, facet.dot(mesh.normals[v]));
  }
  return std::acos(least) * 180 / std::numbers::pi;
}

TEST(NormalModel, StartSolidsAreInscribedAndOutward) {
  const std::map<StartSolid, std::pair<int, int>> expected{
      {StartSolid::tetrahedron, {4, 4}}, {StartSolid::octahedron, {6, 8}}, {StartSolid::icosahedron, {12, 20}}};
  for (const auto& [solid, counts] : expected) {
    const NormalModel model = NormalModel::start(solid, SubdivisionRule::smooth);
    EXPECT_EQ(model.vertex_count(), counts.first);
    EXPECT_EQ(static_cast<int>(model.triangles().size()), counts.second);
    EXPECT_EQ(model.parameter_count(), 6 * counts.first);
    EXPECT_EQ(model.degrees_of_freedom(), 5 * counts.first);
    ASSERT_EQ(static_cast<int>(model.blocks().size()), 2 * counts.first);
    EXPECT_EQ(model.blocks()[0], BlockKind::point);
    EXPECT_EQ(model.blocks()[1], BlockKind::unit_normal);
    for (const auto& [a, b, c] : model.triangles()) {
      const Parameters& p = model.reference();
      EXPECT_GT(shapes::point(p, a).dot(shapes::point(p, b).cross(shapes::point(p, c))), 0.3);
    }
  }
}

TEST(NormalModel, LayoutIsOneClosedMeshWithEachSampleOwnedOnce) {
  for (const StartSolid solid : shapes::kSolids) {
    const NormalModel model = NormalModel::start(solid, SubdivisionRule::smooth);
    for (int level = 0; level <= 7; ++level) {
      const SampleLayout layout = model.layout(level);
      const int expected = 2 + (model.vertex_count() - 2) * (1 << 2 * level);
      ASSERT_EQ(layout.sample_count(), expected);
      ASSERT_EQ(layout.triangles.size(), model.triangles().size() << 2 * level);
      if (level <= 5) expect_closed(layout.triangles);
      int next = 0;
      for (std::size_t f = 0; f < layout.patches.size(); ++f) {
        const SamplePatch& patch = layout.patches[f];
        ASSERT_EQ(patch.first_sample, next);
        ASSERT_EQ(patch.jacobian_offset, std::size_t(next) * 54);
        next += patch.sample_count;
        const auto [a, b, c] = model.triangles()[f];
        ASSERT_EQ(patch.blocks, (std::vector<int>{2 * a, 2 * a + 1, 2 * b, 2 * b + 1, 2 * c, 2 * c + 1}));
        for (int i = patch.first_sample; i < next; ++i) ASSERT_EQ(layout.patch_of[i], static_cast<int>(f));
      }
      ASSERT_EQ(next, layout.sample_count());
      const double volume = shapes::flat_volume({layout.reference, layout.triangles, {}});
      EXPECT_GT(volume, 0.5);
      EXPECT_LT(volume, 4 * std::numbers::pi / 3);
    }
    EXPECT_THROW(model.layout(8), UsageError);
    EXPECT_THROW(model.layout(-1), UsageError);
  }
}

TEST(NormalModel, AgreesWithTheIndependentImplementation) {
  const nlohmann::json golden = shapes::golden(), mesh = golden.at("mesh");
  const Triangles triangles = mesh.at("F");
  Parameters parameters(24);
  for (int v = 0; v < 4; ++v) {
    shapes::set(parameters, v, shapes::vector(mesh.at("P").at(v)), shapes::vector(mesh.at("N").at(v)));
  }
  const std::map<SubdivisionRule, std::string> names{{SubdivisionRule::smooth, "smooth"},
                                                     {SubdivisionRule::balanced, "balanced"},
                                                     {SubdivisionRule::published, "published"}};
  for (const auto& [rule, name] : names) {
    SCOPED_TRACE(name);
    const NormalModel model(4, triangles, rule, {});
    const nlohmann::json expected = mesh.at(name);
    const TriangleMesh have = mesh_at(model, parameters, 2);
    ASSERT_EQ(have.vertices.size(), expected.at("P2").size());
    std::set<std::size_t> met;
    for (std::size_t k = 0; k < have.vertices.size(); ++k) {
      for (std::size_t i = 0; i < have.vertices.size(); ++i) {
        if (!((have.vertices[i] - shapes::vector(expected.at("P2").at(k))).norm() <= 1e-12)) continue;
        EXPECT_LE((have.normals[i] - shapes::vector(expected.at("N2").at(k))).norm(), 1e-12);
        met.insert(i);
      }
    }
    EXPECT_EQ(met.size(), have.vertices.size());
    if (rule == SubdivisionRule::published) continue;
    for (int level = 0; level <= 6; ++level) {
      const double volume = expected.at("volume_flat_by_level").at(level);
      const double with_normals = expected.at("volume_arc_by_level").at(level);
      const TriangleMesh at_level = mesh_at(model, parameters, level);
      EXPECT_LE(std::abs(shapes::flat_volume(at_level) - volume), 1e-12 * volume);
      EXPECT_LE(std::abs(volume_with_normals(at_level) - with_normals), 1e-11 * with_normals);
    }
  }
}

TEST(NormalModel, SpheresAreExact) {
  RandomEngine random(31);
  std::vector<NormalModel> models;
  for (const SubdivisionRule rule : shapes::kRules) {
    for (const StartSolid solid : shapes::kSolids) models.push_back(NormalModel::start(solid, rule));
    for (int trial = 0; trial < 10; ++trial) models.push_back(shapes::random_inscribed(30, rule, random));
  }
  for (const NormalModel& model : models) {
    const Vec3 centre(10, -20, 30);
    const TriangleMesh mesh = mesh_at(model, affine_image(model, centre, 5 * Mat3::Identity()), 5);
    for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
      ASSERT_LE(std::abs((mesh.vertices[i] - centre).norm() - 5), 1e-12);
      ASSERT_LE((mesh.normals[i] - (mesh.vertices[i] - centre) / 5).norm(), 1e-8);  // slivers magnify rounding
    }
  }
}

TEST(NormalModel, VolumeOfSpheresConvergesAsGolden) {
  const nlohmann::json golden = shapes::golden().at("unit_sphere_relative_volume_error");
  const std::map<StartSolid, std::string> names{
      {StartSolid::tetrahedron, "tetra"}, {StartSolid::octahedron, "octa"}, {StartSolid::icosahedron, "icosa"}};
  for (const auto& [solid, name] : names) {
    const NormalModel model = NormalModel::start(solid, SubdivisionRule::balanced);
    for (const auto& row : golden.at(name)) {
      const TriangleMesh mesh = mesh_at(model, model.reference(), row.at(0));
      const double error = shapes::flat_volume(mesh) / (4 * std::numbers::pi / 3) - 1;
      EXPECT_LE(std::abs(error - row.at(3).get<double>()), 1e-12) << name << " " << row.at(0);
      const double corrected = volume_with_normals(mesh) / (4 * std::numbers::pi / 3) - 1;
      EXPECT_LE(std::abs(corrected - row.at(4).get<double>()), 1e-11) << name << " " << row.at(0);
    }
  }
}

TEST(NormalModel, FollowsSimilarities) {
  RandomEngine random(32);
  for (const SubdivisionRule rule : shapes::kRules) {
    for (int trial = 0; trial < 20; ++trial) {
      const NormalModel model = NormalModel::start(StartSolid::icosahedron, rule);
      const Parameters parameters = shapes::perturbed_sphere(model, 0.2, random);
      const double scale = std::exp(random.uniform(-3, 3));
      const Mat3 turn = Eigen::AngleAxisd(random.uniform(0, 3), shapes::random_unit(random)).toRotationMatrix();
      const Vec3 shift = shapes::random_vector(random, 3 * scale);
      Parameters moved(parameters.size());
      for (int v = 0; v < model.vertex_count(); ++v) {
        shapes::set(moved, v, scale * turn * shapes::point(parameters, v) + shift,
                    turn * shapes::normal(parameters, v));
      }
      const TriangleMesh one = mesh_at(model, parameters, 3), other = mesh_at(model, moved, 3);
      for (std::size_t i = 0; i < one.vertices.size(); ++i) {
        ASSERT_LE((other.vertices[i] - (scale * turn * one.vertices[i] + shift)).norm(), 1e-12 * scale);
        ASSERT_LE((other.normals[i] - turn * one.normals[i]).norm(), 1e-11);
      }
    }
  }
}

TEST(NormalModel, MirroredControlMeshesGiveTheMirroredSurface) {
  RandomEngine random(33);
  const NormalModel model = NormalModel::start(StartSolid::octahedron, SubdivisionRule::smooth);
  const Parameters parameters = shapes::perturbed_sphere(model, 0.2, random);
  const Vec3 mirror(-1, 1, 1);
  Parameters moved(parameters.size());
  for (int v = 0; v < model.vertex_count(); ++v) {
    shapes::set(moved, v, mirror.cwiseProduct(shapes::point(parameters, v)),
                mirror.cwiseProduct(shapes::normal(parameters, v)));
  }
  Triangles turned = model.triangles();
  for (auto& t : turned) std::swap(t[1], t[2]);
  const NormalModel mirrored(model.vertex_count(), turned, model.rule(), {});
  std::vector<Vec3> expected = mesh_at(model, parameters, 3).vertices;
  for (Vec3& x : expected) x = mirror.cwiseProduct(x);
  EXPECT_LE(shapes::farthest(expected, mesh_at(mirrored, moved, 3).vertices), 1e-13);
}

TEST(NormalModel, RefiningKeepsTheSurfaceExactlyForPerpendicularRules) {
  RandomEngine random(34);
  for (const SubdivisionRule rule : {SubdivisionRule::balanced, SubdivisionRule::published}) {
    const NormalModel model = NormalModel::start(StartSolid::octahedron, rule);
    const Parameters parameters = shapes::perturbed_sphere(model, 0.2, random);
    const auto [fine, fine_parameters] = model.refine(parameters);
    const auto [finer, finer_parameters] = fine.refine(fine_parameters);
    EXPECT_EQ(fine.vertex_count(), 18);
    EXPECT_EQ(finer.vertex_count(), 66);
    for (int v = 0; v < model.vertex_count(); ++v) {
      EXPECT_EQ(shapes::point(fine_parameters, v), shapes::point(parameters, v)) << "old vertices keep their numbers";
      EXPECT_EQ(shapes::normal(fine_parameters, v), shapes::normal(parameters, v));
    }
    const auto expected = mesh_at(model, parameters, 4).vertices;
    EXPECT_LE(shapes::farthest(expected, mesh_at(fine, fine_parameters, 3).vertices), 1e-12);
    EXPECT_LE(shapes::farthest(expected, mesh_at(finer, finer_parameters, 2).vertices), 1e-12);
  }
}

TEST(NormalModel, RefiningMovesTheSmoothSurfaceALittleAndSpheresNotAtAll) {
  RandomEngine random(35);
  for (const StartSolid solid : {StartSolid::tetrahedron, StartSolid::icosahedron}) {
    const NormalModel model = NormalModel::start(solid, SubdivisionRule::smooth);
    for (int trial = 0; trial < 5; ++trial) {
      const Parameters parameters = shapes::perturbed_sphere(model, 0.1, random);
      const auto [fine, fine_parameters] = model.refine(parameters);
      const double moved =
          shapes::farthest(mesh_at(model, parameters, 4).vertices, mesh_at(fine, fine_parameters, 3).vertices);
      EXPECT_LE(moved, 0.012);
      EXPECT_GE(moved, 1e-5) << "if this is exact, say so in docs/models.md";
    }
    const auto [fine, on_sphere] = model.refine(model.reference());
    for (std::size_t k = 0; k < on_sphere.size(); ++k) EXPECT_LE(std::abs(on_sphere[k] - fine.reference()[k]), 1e-14);
    for (const Vec3& x : fine.layout(4).reference) ASSERT_LE(std::abs(x.norm() - 1), 1e-15 * 4);
  }
}

TEST(NormalModel, NormalsOfTheSmoothRuleAreThoseOfTheLimit) {
  RandomEngine random(36);
  for (const auto& [solid, amplitude] : {std::pair{StartSolid::tetrahedron, 0.1}, {StartSolid::icosahedron, 0.2}}) {
    const NormalModel smooth = NormalModel::start(solid, SubdivisionRule::smooth);
    for (int trial = 0; trial < 5; ++trial) {
      const Parameters parameters = shapes::perturbed_sphere(smooth, amplitude, random);
      double previous = largest_angle(mesh_at(smooth, parameters, 3));
      for (int level = 4; level <= 7; ++level) {
        const double angle = largest_angle(mesh_at(smooth, parameters, level));
        EXPECT_LE(angle, 0.72 * previous) << "level " << level;
        previous = angle;
      }
      EXPECT_LE(previous, 4);
    }
  }
}

TEST(NormalModel, NormalsOfThePublishedRuleNeedNotBeThoseOfTheLimit) {
  RandomEngine random(36);
  const NormalModel published = NormalModel::start(StartSolid::icosahedron, SubdivisionRule::published);
  int growing = 0;
  for (int trial = 0; trial < 5; ++trial) {
    const Parameters parameters = shapes::perturbed_sphere(published, 0.2, random);
    const double coarse = largest_angle(mesh_at(published, parameters, 3));
    if (largest_angle(mesh_at(published, parameters, 6)) > coarse) ++growing;
  }
  EXPECT_GE(growing, 1) << "then the documentation is wrong about the published rule";
}

TEST(NormalModel, SamplesConvergeQuadratically) {
  RandomEngine random(37);
  const NormalModel model = NormalModel::start(StartSolid::icosahedron, SubdivisionRule::smooth);
  const Parameters parameters = shapes::perturbed_sphere(model, 0.05, random);
  std::vector<double> volume;
  for (int level = 2; level <= 7; ++level) volume.push_back(shapes::flat_volume(mesh_at(model, parameters, level)));
  for (std::size_t k = 2; k < volume.size(); ++k) {
    const double ratio = (volume[k - 1] - volume[k - 2]) / (volume[k] - volume[k - 1]);
    EXPECT_NEAR(ratio, 4, 0.4);
  }
}

TEST(NormalModel, AffineSphereHasTheEllipsoidsPointsAndNormals) {
  RandomEngine random(38);
  const NormalModel model = NormalModel::start(StartSolid::icosahedron, SubdivisionRule::smooth);
  Mat3 A;
  A << 3, 0.5, 0, 0, 2, 0.3, 0.1, 0, 1;
  const Vec3 centre(4, 5, 6);
  const Parameters parameters = affine_image(model, centre, A);
  const Mat3 Q = (A * A.transpose()).inverse();
  for (int v = 0; v < model.vertex_count(); ++v) {
    const Vec3 x = shapes::point(parameters, v) - centre;
    EXPECT_LE(std::abs(x.dot(Q * x) - 1), 1e-13);
    EXPECT_LE((shapes::normal(parameters, v) - (Q * x).normalized()).norm(), 1e-13);
  }
  const NormalModel bare(model.vertex_count(), model.triangles(), model.rule(), {});
  EXPECT_THROW(affine_image(bare, centre, A), BadData);
}

TEST(NormalModel, RefusesControlMeshesThatAreNoClosedSurface) {
  const Triangles tetra = NormalModel::start(StartSolid::tetrahedron, SubdivisionRule::smooth).triangles();
  Triangles open = tetra, turned = tetra, double_corner = tetra, far = tetra, twice = tetra, touching = tetra;
  open.pop_back();
  std::swap(turned[0][0], turned[0][1]);
  double_corner[2] = {0, 0, 1};
  far[1][2] = 4;
  twice.insert(twice.end(), tetra.begin(), tetra.end());
  for (auto t : tetra) {  // a second tetrahedron that shares vertex 0
    for (int& v : t) v = v == 0 ? 0 : v + 3;
    touching.push_back(t);
  }
  struct Case {
    int vertex_count;
    Triangles triangles;
    const char* message;
  };
  for (const auto& [count, triangles, message] :
       {Case{4, open, "open"}, Case{4, turned, "oriented manifold"}, Case{4, double_corner, "twice"},
        Case{4, far, "vertex 4 is not among the 4 points"}, Case{4, twice, "oriented manifold"},
        Case{7, touching, "two sheets touch"}, Case{5, tetra, "belongs to no triangle"}, Case{4, {}, "no triangles"},
        Case{0, {}, "no triangles"}}) {
    try {
      const NormalModel model(count, triangles, SubdivisionRule::smooth, {});
      ADD_FAILURE() << "accepted, expected: " << message;
    } catch (const BadData& error) {
      EXPECT_THAT(error.what(), testing::HasSubstr(message));
    }
  }
  EXPECT_THROW(NormalModel(4, tetra, SubdivisionRule::smooth, Parameters(23, 1.0)), BadData);
  EXPECT_THROW(NormalModel(4, tetra, SubdivisionRule::smooth, Parameters(24, 1.0)), BadData);
}

TEST(NormalModel, AcceptsOtherGenera) {
  Triangles torus;
  const int m = 4, n = 5;
  const auto at = [&](int i, int j) { return (i % m) * n + j % n; };
  for (int i = 0; i < m; ++i) {
    for (int j = 0; j < n; ++j) {
      torus.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      torus.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  }
  const NormalModel model(m * n, torus, SubdivisionRule::smooth, {});
  const SampleLayout layout = model.layout(3);
  EXPECT_EQ(layout.sample_count(), m * n * 64);
  EXPECT_TRUE(layout.reference.empty());
  expect_closed(layout.triangles);
  const Parameters parameters(model.parameter_count(), 0.5);
  EXPECT_TRUE(model.refine(parameters).first.reference().empty());
}

}  // namespace
}  // namespace pellicle
