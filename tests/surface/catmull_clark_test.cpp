// Catmull-Clark: OpenSubdiv's weights against the reference implementation's values and against repeated refinement
// with this project's own masks; the plate against closed-form B-spline integrals.

#include "pellicle/surface/quad/catmull_clark_model.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <numbers>

#include "pellicle/base/errors.h"
#include "pellicle/mesh/measure.h"
#include "pellicle/mesh/quad/quad_subdivision.h"
#include "pellicle/surface/quad/internal/catmull_clark_limits.h"
#include "quad_shapes.h"

namespace pellicle {
namespace {

using namespace quad_shapes;

CatmullClarkModel model_of(const QuadMesh& mesh, Border border = Border::refused) {
  return {count(mesh), mesh.quads, {parameters_of(mesh.vertices), false}, border};
}

SurfaceSamples samples_of(const CatmullClarkModel& model, const Parameters& p, const SampleLayout& layout) {
  SurfaceSamples samples;
  model.evaluate(p, layout, true, samples);
  return samples;
}

Vec3 combine(const LimitWeights& w, const std::vector<double>& weight, std::size_t row, const QuadMesh& mesh) {
  Vec3 sum = Vec3::Zero();
  for (int k = w.start[row]; k < w.start[row + 1]; ++k) {
    sum += weight[std::size_t(k)] * mesh.vertices[std::size_t(w.index[std::size_t(k)])];
  }
  return sum;
}

TEST(CatmullClarkModel, WeightsGiveTheExactValuesOfTheReference) {
  const QuadMesh mesh = golden_mesh();
  const CatmullClarkLimits limits(quad_topology(count(mesh), mesh.quads), 6, LimitCap::gregory);
  const nlohmann::json expected = golden("catmull_clark").at("evaluation_exact");
  std::vector<QuadPlace> places;
  for (const auto& e : expected) places.push_back({e.at("face"), e.at("s"), e.at("t")});
  const LimitWeights w = limits.at(places, true);
  for (std::size_t r = 0; r < places.size(); ++r) {
    const auto near = [&](const std::vector<double>& weight, const char* key, double tolerance) {
      const Vec3 value = vec(expected[r].at(key));
      EXPECT_LE((combine(w, weight, r, mesh) - value).norm(), tolerance * (1 + value.norm())) << key << " at " << r;
    };
    near(w.x, "P", 1e-12);
    near(w.s, "Ps", 1e-12);
    near(w.t, "Pt", 1e-12);
    near(w.ss, "Pss", 1e-11);
    near(w.st, "Pst", 1e-11);
    near(w.tt, "Ptt", 1e-11);
  }
}

// Level-k samples are the limits of the vertices of the k times refined mesh; those come from masks alone.
TEST(CatmullClarkModel, SamplesAreTheLimitsOfTheRefinedMesh) {
  RandomEngine random(7);
  for (const QuadMesh& mesh : {golden_mesh(), jittered(drum(7), 0.1, random), torus_mesh(4, 3, 2, 0.7)}) {
    const CatmullClarkModel model = model_of(mesh);
    const int level = 3;
    const SampleLayout layout = model.layout(level);
    const SurfaceSamples samples = samples_of(model, parameters_of(mesh.vertices), layout);
    QuadMesh fine = mesh;
    for (int k = 0; k < level; ++k) {
      const QuadStep step = catmull_clark_step(quad_topology(count(fine), fine.quads));
      fine = {step.rows.apply(fine.vertices), step.quads};
    }
    ASSERT_EQ(fine.vertices.size(), samples.x.size());
    const LimitMasks masks = catmull_clark_limit(quad_topology(count(fine), fine.quads));
    const std::vector<Vec3> limit = masks.position.apply(fine.vertices);
    for (std::size_t i = 0; i < samples.x.size(); ++i) {
      std::size_t best = 0;
      for (std::size_t v = 1; v < limit.size(); ++v) {
        if ((limit[v] - samples.x[i]).squaredNorm() < (limit[best] - samples.x[i]).squaredNorm()) best = v;
      }
      EXPECT_LE((limit[best] - samples.x[i]).norm(), 1e-13);
      const Vec3 normal =
          masks.tangent_u.apply(best, fine.vertices).cross(masks.tangent_v.apply(best, fine.vertices)).normalized();
      EXPECT_LE((normal - samples.normal[i]).norm(), 1e-10);
    }
  }
}

TEST(CatmullClarkModel, RefineKeepsTheSurface) {
  RandomEngine random(3);
  const QuadMesh open = sheet(4, 3, random);
  for (const auto& [mesh, border] : {std::pair(golden_mesh(), Border::refused), std::pair(open, Border::allowed)}) {
    const CatmullClarkModel model = model_of(mesh, border);
    const auto [fine, parameters] = model.refine(parameters_of(mesh.vertices));
    const SurfaceSamples coarse = samples_of(model, parameters_of(mesh.vertices), model.layout(2));
    const SurfaceSamples refined = samples_of(fine, parameters, fine.layout(1));
    ASSERT_EQ(coarse.x.size(), refined.x.size());
    for (std::size_t i = 0; i < refined.x.size(); ++i) {
      double best = 1, turn = 1;
      for (std::size_t k = 0; k < coarse.x.size(); ++k) {
        const double distance = (coarse.x[k] - refined.x[i]).norm();
        if (distance < best) {
          best = distance;
          turn = (coarse.normal[k] - refined.normal[i]).norm();
        }
      }
      EXPECT_LE(best, 1e-12);
      EXPECT_LE(turn, 1e-9);
    }
  }
}

TEST(CatmullClarkModel, SamplesAreOwnedOnceAndTheMeshIsClosed) {
  for (const QuadMesh& mesh : {golden_mesh(), cube_mesh(), torus_mesh(5, 4, 2, 0.7)}) {
    const CatmullClarkModel model = model_of(mesh);
    for (int level = 0; level < 4; ++level) {
      const SampleLayout layout = model.layout(level);
      EXPECT_EQ(layout.triangles.size(), std::size_t(model.base_facets()) << (2 * level));
      EXPECT_EQ(layout.patches.size(), mesh.quads.size());
      const MeshTopology t = pellicle::topology_of(pellicle::TriangleMesh{layout.reference, layout.triangles, {}});
      EXPECT_TRUE(t.closed && t.manifold && t.oriented) << t.first_fault;
      EXPECT_EQ(t.genus, model.topology().genus);
      int at = 0;
      for (const SamplePatch& patch : layout.patches) {
        EXPECT_EQ(patch.first_sample, at);
        at += patch.sample_count;
      }
      EXPECT_EQ(at, layout.sample_count());
    }
  }
}

TEST(CatmullClarkModel, NormalsAreOutwardAndMatchTheFacets) {
  const CatmullClarkModel model = model_of(golden_mesh());
  const SampleLayout layout = model.layout(4);
  const SurfaceSamples samples = samples_of(model, model.reference(), layout);
  double worst = 1;
  for (const auto& t : layout.triangles) {
    const auto at = [&](int c) { return samples.x[std::size_t(t[std::size_t(c)])]; };
    const Vec3 facet = (at(1) - at(0)).cross(at(2) - at(0)).normalized();
    for (const int v : t) worst = std::min(worst, facet.dot(samples.normal[std::size_t(v)]));
  }
  EXPECT_GE(worst, 0.9);
  EXPECT_GT(volume_of({samples.x, layout.triangles, {}}), 0.0);
}

TEST(CatmullClarkModel, JacobianAndAdjointAreTheWeights) {
  RandomEngine random(5);
  const CatmullClarkModel model = model_of(golden_mesh());
  const SampleLayout layout = model.layout(2);
  const SurfaceSamples samples = samples_of(model, model.reference(), layout);
  Parameters moved = model.reference();
  std::vector<double> step(moved.size());
  for (std::size_t i = 0; i < step.size(); ++i) moved[i] += step[i] = random.uniform(-1, 1);
  const SurfaceSamples there = samples_of(model, moved, layout);
  std::vector<Vec3> bar(samples.x.size());
  for (Vec3& b : bar) b = Vec3(random.normal(), random.normal(), random.normal());
  std::vector<double> gradient(step.size(), 0.0);
  model.pull_back(moved, layout, bar, gradient);
  double by_samples = 0, by_parameters = 0;
  for (std::size_t i = 0; i < step.size(); ++i) by_parameters += gradient[i] * step[i];
  for (const SamplePatch& patch : layout.patches) {
    for (int k = 0; k < patch.sample_count; ++k) {
      const auto i = std::size_t(patch.first_sample + k);
      Vec3 change = Vec3::Zero();
      for (int row = 0; row < 3; ++row) {
        for (int c = 0; c < patch.columns(); ++c) {
          change[row] += samples.jacobian[patch.jacobian_offset + std::size_t((3 * k + row) * patch.columns() + c)] *
                         step[std::size_t(3 * patch.blocks[std::size_t(c / 3)] + c % 3)];
        }
      }
      EXPECT_LE((samples.x[i] + change - there.x[i]).norm(), 1e-12);
      by_samples += bar[i].dot(change);
    }
  }
  EXPECT_NEAR(by_samples, by_parameters, 1e-10 * std::abs(by_samples) + 1e-10);
}

TEST(CatmullClarkModel, StartIsNearlyTheUnitSphere) {
  const double limit[] = {0.021, 1.5e-3, 2.1e-4};
  for (int refinements = 0; refinements < 3; ++refinements) {
    const CatmullClarkModel model = CatmullClarkModel::start(refinements);
    EXPECT_EQ(model.vertex_count(), 2 + 6 * (1 << (2 * refinements)));
    const SampleLayout layout = model.layout(3);
    const SurfaceSamples samples = samples_of(model, model.reference(), layout);
    double worst = 0;
    for (std::size_t i = 0; i < samples.x.size(); ++i) {
      worst = std::max(worst, std::abs(samples.x[i].norm() - 1));
      EXPECT_LE(std::abs(layout.reference[i].norm() - 1), 1e-14);
      EXPECT_LE((layout.reference[i] - samples.x[i]).norm(), limit[refinements]);
    }
    EXPECT_LE(worst, limit[refinements]);
  }
}

TEST(CatmullClarkModel, OpenSheetReachesItsBorderCurve) {
  RandomEngine random(9);
  const QuadMesh mesh = sheet(5, 4, random);
  EXPECT_THROW(model_of(mesh), BadData);
  const CatmullClarkModel model = model_of(mesh, Border::allowed);
  EXPECT_FALSE(model.is_closed());
  const SampleLayout layout = model.layout(2);
  const SurfaceSamples samples = samples_of(model, model.reference(), layout);
  for (const Vec3& n : samples.normal) EXPECT_GT(n.z(), 0.0);
  double lowest = 1;
  for (const Vec3& x : samples.x) lowest = std::min(lowest, x.y());
  EXPECT_NEAR(lowest, 0.0, 1e-12);                             // the border curve runs along y = 0
  EXPECT_LE((samples.x[0] - mesh.vertices[0]).norm(), 1e-12);  // from corner to corner
}

TEST(CatmullClarkModel, LayoutRefusesWhatItCannot) {
  EXPECT_THROW(CatmullClarkModel::start().layout(-1), UsageError);
  EXPECT_THROW(CatmullClarkModel::start().layout(8), UsageError);
  EXPECT_THROW(CatmullClarkModel(8, cube_mesh().quads, {Parameters(23, 0.0), false}), BadData);
}

double energy(const PointRows& rows, const std::vector<Vec3>& x) {
  double sum = 0;
  for (std::size_t r = 0; r < rows.size(); ++r) sum += rows.apply(r, x).squaredNorm();
  return sum;
}

TEST(ThinPlate, EnergiesOfARegularTorus) {
  const nlohmann::json j = golden("catmull_clark").at("torus");
  const QuadMesh mesh = mesh_of(j);
  const CatmullClarkModel model = model_of(mesh);
  const double bending = j.at("energy_bending"), membrane = j.at("energy_membrane");
  EXPECT_NEAR(energy(thin_plate_rows(model, 0, 1), mesh.vertices), bending, 1e-11 * bending);
  EXPECT_NEAR(energy(thin_plate_rows(model, 1, 0), mesh.vertices), membrane, 1e-11 * membrane);
  EXPECT_NEAR(energy(thin_plate_rows(model, 2, 3), mesh.vertices), 2 * membrane + 3 * bending, 1e-10 * bending);
}

Eigen::Matrix4d gram(const char* key, double scale) {
  const nlohmann::json j = golden("catmull_clark").at("gram_1d").at(key);
  Eigen::Matrix4d m;
  for (int a = 0; a < 4; ++a) {
    for (int b = 0; b < 4; ++b) m(a, b) = j[std::size_t(a)][std::size_t(b)].get<double>() / scale;
  }
  return m;
}

// K of a regular torus, entry by entry, from the closed-form integrals of cubic B-spline pieces.
TEST(ThinPlate, StiffnessIsTheTensorProductOfGramMatrices) {
  constexpr int around = 6, across = 5;
  const QuadMesh mesh = torus_mesh(around, across, 2, 0.7);
  const PointRows rows = thin_plate_rows(model_of(mesh), 0.3, 1);
  Eigen::MatrixXd factor = Eigen::MatrixXd::Zero(Eigen::Index(rows.size()), around * across);
  for (std::size_t r = 0; r < rows.size(); ++r) {
    for (int k = rows.start[r]; k < rows.start[r + 1]; ++k) {
      factor(Eigen::Index(r), rows.index[std::size_t(k)]) += rows.weight[std::size_t(k)];
    }
  }
  const Eigen::Matrix4d g0 = gram("I00_times_5040", 5040), g1 = gram("I11_times_120", 120), g2 = gram("I22_times_6", 6);
  Eigen::MatrixXd expected = Eigen::MatrixXd::Zero(around * across, around * across);
  for (int i = 0; i < around; ++i) {
    for (int j = 0; j < across; ++j) {
      const auto at = [&](int a, int b) { return (i + a + around) % around * across + (j + b + across) % across; };
      for (int p = 0; p < 16; ++p) {
        for (int q = 0; q < 16; ++q) {
          const int a = p / 4, b = p % 4, c = q / 4, d = q % 4;
          expected(at(a - 1, b - 1), at(c - 1, d - 1)) += g2(a, c) * g0(b, d) + 2 * g1(a, c) * g1(b, d) +
                                                          g0(a, c) * g2(b, d) +
                                                          0.3 * (g1(a, c) * g0(b, d) + g0(a, c) * g1(b, d));
        }
      }
    }
  }
  EXPECT_LE((factor.transpose() * factor - expected).norm(), 1e-11 * expected.norm());
}

TEST(ThinPlate, IsFiniteAndBlindToTranslationAtExtraordinaryVertices) {
  const QuadMesh mesh = golden_mesh();
  const PointRows rows = thin_plate_rows(model_of(mesh), 1, 1);
  const double here = energy(rows, mesh.vertices);
  EXPECT_TRUE(std::isfinite(here) && here > 0);
  std::vector<Vec3> moved = mesh.vertices;
  for (Vec3& x : moved) x += Vec3(100, -50, 20);
  EXPECT_NEAR(energy(rows, moved), here, 1e-8 * here);
}

}  // namespace
}  // namespace pellicle
