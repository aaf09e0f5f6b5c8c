// Slime: weights, stiffness and surface against the reference implementation; tangent planes across every border.

#include "pellicle/surface/quad/slime_model.h"

#include <gtest/gtest.h>

#include <numbers>

#include "pellicle/base/errors.h"
#include "pellicle/mesh/distance.h"
#include "pellicle/mesh/measure.h"
#include "quad_shapes.h"

namespace pellicle {
namespace {

using namespace quad_shapes;

SlimeModel model_of(const QuadMesh& mesh) {
  return {count(mesh), mesh.quads, {parameters_of(mesh.vertices), false}};
}

std::vector<Eigen::Vector2d> domain_points(const nlohmann::json& j) {
  std::vector<Eigen::Vector2d> points;
  for (const auto& p : j) points.emplace_back(p.at(0).get<double>(), p.at(1).get<double>());
  return points;
}

Eigen::MatrixXd matrix(const nlohmann::json& j) {
  Eigen::MatrixXd m(j.size(), j.at(0).size());
  for (std::size_t r = 0; r < j.size(); ++r) {
    for (std::size_t c = 0; c < j[r].size(); ++c) m(Eigen::Index(r), Eigen::Index(c)) = j[r][c].get<double>();
  }
  return m;
}

class SlimeValence : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(All, SlimeValence, testing::Values(3, 4, 5, 6, 7, 8));

TEST_P(SlimeValence, WeightsAreThoseOfTheReference) {
  const nlohmann::json j = golden("slime").at("basis").at(std::to_string(GetParam()));
  const SlimeBasis basis(GetParam());
  const SlimeWeights w = basis.at(domain_points(j.at("domain_points")));
  EXPECT_LE((w.x - matrix(j.at("weights"))).cwiseAbs().maxCoeff(), 1e-13);
  EXPECT_LE((w.u - matrix(j.at("weights_du"))).cwiseAbs().maxCoeff(), 1e-12);
  EXPECT_LE((w.v - matrix(j.at("weights_dv"))).cwiseAbs().maxCoeff(), 1e-12);
}

TEST_P(SlimeValence, StiffnessIsThatOfTheReference) {
  const nlohmann::json j = golden("slime").at("basis").at(std::to_string(GetParam()));
  const Eigen::MatrixXd K = SlimeBasis(GetParam()).stiffness();
  EXPECT_NEAR(K.trace(), j.at("stiffness_trace").get<double>(), 1e-10 * K.trace());
  if (!j.at("stiffness").is_null()) {
    EXPECT_LE((K - matrix(j.at("stiffness"))).cwiseAbs().maxCoeff(), 1e-11 * K.trace());
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(K);
  const int nullity = int((eigen.eigenvalues().array() < 1e-9 * K.trace()).count());
  EXPECT_EQ(nullity, GetParam() == 4 ? 3 : 1);
  EXPECT_GE(eigen.eigenvalues().minCoeff(), -1e-10);
}

TEST_P(SlimeValence, WeightsSumToOneAndDerivativesAgreeWithDifferences) {
  const SlimeBasis basis(GetParam());
  const double h = 1e-4;
  RandomEngine random(2);
  for (int trial = 0; trial < 5; ++trial) {
    const Eigen::Vector2d p = basis.corner(trial) * random.uniform(0, 0.6) + basis.corner(trial + 1) * 0.2;
    const Eigen::Vector2d u(h, 0), v(0, h);
    const SlimeWeights w = basis.at({p, p + u, p - u, p + v, p - v}, true);
    EXPECT_NEAR(w.x.row(0).sum(), 1, 1e-14);
    EXPECT_LE(((w.x.row(1) - w.x.row(2)) / (2 * h) - w.u.row(0)).norm(), 1e-6);
    EXPECT_LE(((w.x.row(3) - w.x.row(4)) / (2 * h) - w.v.row(0)).norm(), 1e-6);
    EXPECT_LE(((w.u.row(1) - w.u.row(2)) / (2 * h) - w.uu.row(0)).norm(), 1e-5);
    EXPECT_LE(((w.u.row(3) - w.u.row(4)) / (2 * h) - w.uv.row(0)).norm(), 1e-5);
    EXPECT_LE(((w.v.row(3) - w.v.row(4)) / (2 * h) - w.vv.row(0)).norm(), 1e-5);
  }
}

TEST(SlimeBasis, FourSidedPatchIsTheBiquadratic) {
  const SlimeBasis basis(4);
  const double s = 0.3, t = 0.85;  // from corner 0 to 1, from corner 0 to 3
  const Eigen::Vector2d p = (1 - s) * (1 - t) * basis.corner(0) + s * (1 - t) * basis.corner(1) +
                            s * t * basis.corner(2) + (1 - s) * t * basis.corner(3);
  const auto bezier = [](double x) { return std::array{(1 - x) * (1 - x), 2 * x * (1 - x), x * x}; };
  const auto a = bezier(s), b = bezier(t);
  // Sabin numbers on the 3 x 3 net: corners f_0..f_3, sides e_1..e_3, e_0
  const int net[3][3] = {{5, 2, 6}, {1, 0, 3}, {8, 4, 7}};
  const SlimeWeights w = basis.at({p});
  for (std::size_t j = 0; j < 3; ++j) {
    for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(w.x(0, net[j][i]), a[i] * b[j], 1e-14);
  }
}

TEST(SlimeBasis, ValencesWithoutPatchAreRefused) {
  EXPECT_THROW(SlimeBasis(2), BadData);
  EXPECT_THROW(SlimeBasis(13), BadData);
  EXPECT_NO_THROW(SlimeBasis(10));
}

TEST(SlimeModel, SurfaceIsThatOfTheReference) {
  const nlohmann::json j = golden("slime");
  const QuadMesh mesh = mesh_of(j);
  const SlimeModel model = model_of(mesh);
  const std::vector<Vec3> middle = model.limit_rows().apply(mesh.vertices);
  for (const auto& e : j.at("evaluation")) {
    const int v = e.at("vertex"), n = e.at("valence");
    const auto edge = e.at("ring_edge_neighbours").get<std::vector<int>>();
    const auto diagonal = e.at("ring_diagonals").get<std::vector<int>>();
    EXPECT_LE((middle[std::size_t(v)] - vec(e.at("S").at(0))).norm(), 1e-13);
    Eigen::MatrixX3d net(2 * n + 1, 3);
    const auto at = [&](int i) { return mesh.vertices[std::size_t(i)]; };
    net.row(0) = at(v);
    for (int i = 0; i < n; ++i) {
      const int a = edge[std::size_t(i)], b = edge[std::size_t((i + 1) % n)], d = diagonal[std::size_t(i)];
      net.row(1 + i) = (at(v) + at(a)) / 2;
      net.row(1 + n + i) = (at(v) + at(a) + at(d) + at(b)) / 4;
    }
    const SlimeWeights w = model.bases().at(n).at(domain_points(e.at("domain_points")));
    EXPECT_LE((w.x * net - matrix(e.at("S"))).norm(), 1e-12);
    EXPECT_LE((w.u * net - matrix(e.at("Su"))).norm(), 1e-11);
    EXPECT_LE((w.v * net - matrix(e.at("Sv"))).norm(), 1e-11);
  }
  double energy = 0;
  const PointRows rows = thin_plate_rows(model);
  for (std::size_t r = 0; r < rows.size(); ++r) energy += rows.apply(r, mesh.vertices).squaredNorm();
  EXPECT_NEAR(energy, j.at("energy_total").get<double>(), 1e-9 * energy);
}

// Every border is evaluated from both of its patches. The layout keeps one of the two, so the patches are taken apart:
// a model whose vertices are numbered backwards gives the borders to the other side.
TEST(SlimeModel, TangentPlanesAgreeAcrossEveryBorder) {
  RandomEngine random(11);
  for (const QuadMesh& mesh : {jittered(golden_mesh(), 0.05, random), jittered(drum(7), 0.1, random),
                               jittered(drum(8), 0.1, random), jittered(torus_mesh(5, 4, 2, 0.7), 0.2, random)}) {
    QuadMesh backwards = mesh;
    std::reverse(backwards.vertices.begin(), backwards.vertices.end());
    for (Quad& q : backwards.quads) {
      for (int& v : q) v = count(mesh) - 1 - v;
    }
    const auto by_node = [](const QuadMesh& m) {
      const SlimeModel model = model_of(m);
      const SampleLayout layout = model.layout(4);
      SurfaceSamples samples;
      model.evaluate(model.reference(), layout, false, samples);
      // triangles run over the quads in the same order in both models: corners of triangles match one to one
      std::vector<std::pair<Vec3, Vec3>> values;
      std::vector<int> owner;
      for (const auto& t : layout.triangles) {
        for (const int s : t) {
          values.emplace_back(samples.x[std::size_t(s)], samples.normal[std::size_t(s)]);
          owner.push_back(layout.patch_of[std::size_t(s)]);
        }
      }
      return std::pair(values, owner);
    };
    const auto [one, owner_one] = by_node(mesh);
    const auto [two, owner_two] = by_node(backwards);
    ASSERT_EQ(one.size(), two.size());
    int from_both_sides = 0;
    for (std::size_t i = 0; i < one.size(); ++i) {
      from_both_sides += owner_one[i] != count(mesh) - 1 - owner_two[i] ? 1 : 0;
      EXPECT_LE((one[i].first - two[i].first).norm(), 1e-13);
      EXPECT_LE((one[i].second - two[i].second).norm(), 1e-10);
    }
    EXPECT_GE(from_both_sides, 12 * 2 * 15);
  }
}

TEST(SlimeModel, SamplesAreOwnedOnceAndTheMeshIsClosed) {
  for (const QuadMesh& mesh : {golden_mesh(), cube_mesh(), torus_mesh(5, 4, 2, 0.7)}) {
    const SlimeModel model = model_of(mesh);
    for (int level = 0; level < 4; ++level) {
      const SampleLayout layout = model.layout(level);
      EXPECT_EQ(layout.triangles.size(), std::size_t(model.base_facets()) << (2 * level));
      EXPECT_EQ(layout.patches.size(), mesh.vertices.size());
      const MeshTopology t = pellicle::topology_of(pellicle::TriangleMesh{layout.reference, layout.triangles, {}});
      EXPECT_TRUE(t.closed && t.manifold && t.oriented) << t.first_fault;
      EXPECT_EQ(t.genus, model.topology().genus);
    }
  }
}

TEST(SlimeModel, NormalsAreOutwardAndMatchTheFacets) {
  const SlimeModel model = model_of(golden_mesh());
  const SampleLayout layout = model.layout(4);
  SurfaceSamples samples;
  model.evaluate(model.reference(), layout, false, samples);
  double worst = 1;
  for (const auto& t : layout.triangles) {
    const auto at = [&](int c) { return samples.x[std::size_t(t[std::size_t(c)])]; };
    const Vec3 facet = (at(1) - at(0)).cross(at(2) - at(0)).normalized();
    for (const int v : t) worst = std::min(worst, facet.dot(samples.normal[std::size_t(v)]));
  }
  EXPECT_GE(worst, 0.9);
  EXPECT_GT(volume_of({samples.x, layout.triangles, {}}), 0.0);
}

TEST(SlimeModel, StartIsNearlyTheUnitSphere) {
  const double limit[] = {0.056, 3.2e-3, 5.5e-4};
  for (int refinements = 0; refinements < 3; ++refinements) {
    const SlimeModel model = SlimeModel::start(refinements);
    EXPECT_EQ(model.vertex_count(), 2 + 6 * (1 << (2 * refinements)));
    const SampleLayout layout = model.layout(3);
    SurfaceSamples samples;
    model.evaluate(model.reference(), layout, false, samples);
    double worst = 0;
    for (const Vec3& x : samples.x) worst = std::max(worst, std::abs(x.norm() - 1));
    EXPECT_LE(worst, limit[refinements]);
  }
}

TEST(SlimeModel, RefineStaysNearTheSurfaceAndNearerEachTime) {
  RandomEngine random(13);
  const QuadMesh mesh = jittered(golden_mesh(), 0.05, random);
  SlimeModel model = model_of(mesh);
  Parameters parameters = parameters_of(mesh.vertices);
  double before = 0;
  for (int step = 0; step < 2; ++step) {
    const auto [fine, refined] = model.refine(parameters);
    const SampleLayout coarse_layout = model.layout(4), fine_layout = fine.layout(2);
    SurfaceSamples coarse, near;
    model.evaluate(parameters, coarse_layout, false, coarse);
    fine.evaluate(refined, fine_layout, false, near);
    const ClosestPoint surface({coarse.x, coarse_layout.triangles, {}});
    double worst = 0, square = 0;
    for (const Vec3& x : near.x) {
      const double distance = surface.query(x).distance;
      worst = std::max(worst, distance);
      square += distance * distance;
    }
    const double allowed = step == 0 ? 0.035 : 0.4 * before;
    EXPECT_LE(worst, allowed);
    EXPECT_LE(std::sqrt(square / double(near.x.size())), allowed / 3);
    before = worst;
    model = fine;
    parameters = refined;
  }
}

TEST(SlimeModel, UmbrellaVanishesWhereEachPointIsTheMeanOfItsNeighbours) {
  const QuadTopology t = quad_topology(20, torus_mesh(5, 4, 2, 0.7).quads);
  const PointRows rows = umbrella_rows(t);
  EXPECT_EQ(rows.size(), 20U);
  std::vector<Vec3> x(20, Vec3(1, 2, 3));
  for (const Vec3& r : rows.apply(x)) EXPECT_LE(r.norm(), 1e-14);
  x[7] += Vec3(1, 0, 0);
  EXPECT_NEAR(rows.apply(7, x).x(), 1, 1e-14);
  EXPECT_NEAR(rows.apply(std::size_t(t.rings[7].edge[0]), x).x(), -0.25, 1e-14);
}

}  // namespace
}  // namespace pellicle
