// Paths between shapes: ends, linearity, the great circle, what they must not depend on.

#include "pellicle/surface/morph.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "pellicle/base/errors.h"
#include "shapes.h"

namespace pellicle {
namespace {

using shapes::normal;
using shapes::point;

/// x -> scale turn x + shift.
struct Similarity {
  double scale = 1.0;
  Mat3 turn = Mat3::Identity();
  Vec3 shift = Vec3::Zero();
  Vec3 operator()(const Vec3& x) const { return scale * (turn * x) + shift; }
};

Similarity some_similarity() {
  return {3.7, Eigen::AngleAxisd(0.8, Vec3(1, -2, 0.5).normalized()).toRotationMatrix(), Vec3(120, -80, 45)};
}

Surface moved(const Surface& surface, const Similarity& f) {
  Surface result = surface;
  for (int v = 0; v < control_point_count(surface.model); ++v) {
    shapes::set(result.parameters, v, f(point(surface.parameters, v)), f.turn * normal(surface.parameters, v));
  }
  return result;
}

Surface lumpy(std::uint64_t seed, StartSolid solid = StartSolid::icosahedron, double amplitude = 0.3) {
  RandomEngine random(seed);
  const NormalModel model = NormalModel::start(solid, SubdivisionRule::smooth);
  const Surface unit{model, shapes::perturbed_sphere(model, amplitude, random)};
  return moved(unit, {random.uniform(5, 20), Mat3::Identity(), shapes::random_vector(random, 60)});
}

Surface ball(double radius, const Vec3& centre = Vec3::Zero()) {
  const NormalModel model = NormalModel::start(StartSolid::icosahedron, SubdivisionRule::smooth);
  return moved({model, model.reference()}, {radius, Mat3::Identity(), centre});
}

MorphPath path_of(const Surface& a, const Surface& b, MorphSpace space) {
  return morph_path(match_surfaces(a, b), space);
}

double volume(const Surface& surface) {
  return shapes::flat_volume(tessellate(surface, 3));
}

double farthest_apart(const Parameters& a, const Parameters& b) {
  double worst = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) worst = std::max(worst, std::abs(a[i] - b[i]));
  return worst;
}

class Morph : public testing::TestWithParam<MorphSpace> {
 protected:
  Surface a_ = lumpy(1), b_ = lumpy(2);
  MorphPath path_ = path_of(a_, b_, GetParam());
};
INSTANTIATE_TEST_SUITE_P(Spaces, Morph, testing::Values(MorphSpace::plane, MorphSpace::sphere),
                         [](const auto& test) { return test.param == MorphSpace::plane ? "plane" : "sphere"; });

TEST_P(Morph, EndsAreTheShapesThemselvesAndThePathRunsIntoThem) {
  EXPECT_EQ(surface_at(path_, 0.0).parameters, a_.parameters);
  EXPECT_EQ(surface_at(path_, 1.0).parameters, b_.parameters);
  for (const double tau : {1e-12, -1e-12}) {
    EXPECT_LE(farthest_apart(surface_at(path_, tau).parameters, a_.parameters), 1e-9);
    EXPECT_LE(farthest_apart(surface_at(path_, 1.0 + tau).parameters, b_.parameters), 1e-9);
  }
}

TEST_P(Morph, RunsTheSameWayFromEitherEnd) {
  const MorphPath back = path_of(b_, a_, GetParam());
  for (const double tau : {-0.7, 0.2, 0.5, 0.9, 1.4}) {
    EXPECT_LE(farthest_apart(surface_at(path_, tau).parameters, surface_at(back, 1.0 - tau).parameters), 1e-11);
  }
}

TEST_P(Morph, GoesAlongWithSimilarities) {
  const Similarity f = some_similarity();
  const MorphPath there = path_of(moved(a_, f), moved(b_, f), GetParam());
  for (const double tau : {-0.5, 0.3, 0.5, 1.5}) {
    const Surface expected = moved(surface_at(path_, tau), f);
    EXPECT_LE(farthest_apart(surface_at(there, tau).parameters, expected.parameters), 1e-10);
  }
}

TEST_P(Morph, NormalsStayUnitAndTurnByEqualAngles) {
  const auto angle = [](const Vec3& n, const Vec3& m) { return std::atan2(n.cross(m).norm(), n.dot(m)); };
  for (int v = 0; v < control_point_count(a_.model); ++v) {
    const double whole = angle(normal(a_.parameters, v), normal(b_.parameters, v));
    for (const double tau : {-0.25, 0.25, 0.5, 1.25}) {
      const Vec3 n = normal(surface_at(path_, tau).parameters, v);
      EXPECT_NEAR(n.norm(), 1.0, 1e-14);
      EXPECT_NEAR(angle(normal(a_.parameters, v), n), std::abs(tau) * whole, 1e-12);
    }
  }
}

TEST_P(Morph, OfAShapeWithItselfStaysThere) {
  const MorphPath still = path_of(a_, a_, GetParam());
  EXPECT_EQ(still.moments.angle, 0.0);
  for (const double tau : {-3.0, 0.4, 2.0}) {
    EXPECT_LE(farthest_apart(surface_at(still, tau).parameters, a_.parameters), 1e-11);
  }
}

TEST(HilbertPlane, PathIsLinearInTheControlPointsAlsoBeyondItsEnds) {
  const Surface a = lumpy(3), b = lumpy(4);
  const MorphPath path = path_of(a, b, MorphSpace::plane);
  for (const double tau : {-2.0, 0.25, 0.5, 3.0}) {
    const Surface s = surface_at(path, tau);
    for (int v = 0; v < 12; ++v) {
      const Vec3 expected = (1.0 - tau) * point(a.parameters, v) + tau * point(b.parameters, v);
      EXPECT_LE((point(s.parameters, v) - expected).norm(), 1e-12);
    }
  }
}

TEST(HilbertSphere, PlaceIsLinearSizeGeometricAndTheNormalisedShapeOfNormOne) {
  const Surface a = lumpy(5), b = lumpy(6);
  const MorphPath path = path_of(a, b, MorphSpace::sphere);
  const ShapeMoments& m = path.moments;
  for (const double tau : {-1.0, 0.1, 0.5, 0.8, 2.0}) {
    const ShapeMoments now = shape_moments(path.model, path.measure, surface_at(path, tau).parameters, a.parameters);
    EXPECT_LE((now.mean_a - ((1.0 - tau) * m.mean_a + tau * m.mean_b)).norm(), 1e-11);
    EXPECT_NEAR(now.size_a / (std::pow(m.size_a, 1.0 - tau) * std::pow(m.size_b, tau)), 1.0, 1e-12);
  }
}

TEST(HilbertSphere, StepsAreNearlyEqualAnglesOfOneGreatCircle) {
  // Exact for models that are linear in their parameters; points and normals apart bend the path of this one a little.
  const Surface a = lumpy(7, StartSolid::icosahedron, 0.15), b = lumpy(8, StartSolid::icosahedron, 0.15);
  const MorphPath path = path_of(a, b, MorphSpace::sphere);
  const auto at = [&path](double tau) { return surface_at(path, tau).parameters; };
  const auto angle = [&path](const Parameters& p, const Parameters& q) {
    return shape_moments(path.model, path.measure, p, q).angle;
  };
  const double whole = path.moments.angle;
  EXPECT_GE(whole, 0.1);
  double sum = 0.0;
  for (int k = -2; k < 6; ++k) {
    const double step = angle(at(k / 4.0), at((k + 1) / 4.0));
    EXPECT_NEAR(step / (whole / 4.0), 1.0, 0.02) << k;
    if (k >= 0 && k < 4) sum += step;
  }
  EXPECT_NEAR(sum / whole, 1.0, 5e-3) << "the way is the shortest one";
  EXPECT_NEAR(angle(at(-0.5), at(1.5)) / (2.0 * whole), 1.0, 0.02);
}

TEST(HilbertSphere, BetweenSimilarShapesThereAreOnlySimilarShapes) {
  const Surface a = lumpy(9);
  const MorphPath path = path_of(a, moved(a, {8.0, Mat3::Identity(), Vec3(10, 20, 30)}), MorphSpace::sphere);
  EXPECT_LE(path.moments.angle, 1e-7);
  const Surface middle = surface_at(path, 0.5);
  EXPECT_NEAR(volume(middle) / volume(a), std::pow(8.0, 1.5), 1e-9) << "the half-way size is the geometric mean";
}

TEST(ShapeMoments, OfSpheresAndTheirRotationsAreKnown) {
  const Surface a = ball(5.0, Vec3(1, 2, 3));
  for (const double phi : {0.2, 1.0, 2.5}) {
    const Mat3 turn = Eigen::AngleAxisd(phi, Vec3(1, 2, -1).normalized()).toRotationMatrix();
    const Surface b = moved(ball(7.0), {1.0, turn, Vec3(-4, 0, 0)});
    const MorphPath path = path_of(a, b, MorphSpace::sphere);
    EXPECT_LE((path.moments.mean_a - Vec3(1, 2, 3)).norm(), 1e-9);
    EXPECT_LE((path.moments.mean_b - Vec3(-4, 0, 0)).norm(), 1e-9);
    EXPECT_NEAR(path.moments.size_a, 5.0, 1e-9);
    EXPECT_NEAR(path.moments.size_b, 7.0, 1e-9);
    // The mean of n . R n over the sphere is a third of the trace.
    EXPECT_NEAR(std::cos(path.moments.angle), (1.0 + 2.0 * std::cos(phi)) / 3.0, 1e-9);
  }
}

TEST(Matching, TheCoarserShapeIsRefined) {
  const Surface a = lumpy(10, StartSolid::tetrahedron, 0.1);
  const Surface b = refine(refine(lumpy(11, StartSolid::tetrahedron, 0.1)));
  const MatchedSurfaces matched = match_surfaces(a, b);
  EXPECT_TRUE(matched.a_changed);
  EXPECT_FALSE(matched.b_changed);
  EXPECT_EQ(control_point_count(matched.a.model), 34);
  EXPECT_EQ(matched.b.parameters, b.parameters);
  EXPECT_EQ(control_mesh_of(matched.a).triangles, control_mesh_of(b).triangles);
  const MatchedSurfaces other = match_surfaces(b, a);
  EXPECT_TRUE(other.b_changed);
  EXPECT_EQ(other.b.parameters, matched.a.parameters);
}

TEST(Matching, OtherKindsAreRefused) {
  const auto message = [](const Surface& a, const Surface& b) -> std::string {
    try {
      match_surfaces(a, b);
    } catch (const UsageError& error) {
      return error.what();
    }
    return "accepted";
  };
  const Surface a = lumpy(12);
  Surface published = a;
  const NormalModel& model = std::get<NormalModel>(a.model);
  published.model = NormalModel(12, model.triangles(), SubdivisionRule::published, model.reference());
  EXPECT_NE(message(a, published).find("--rule"), std::string::npos);
  EXPECT_NE(message(a, lumpy(13, StartSolid::octahedron)).find("--start"), std::string::npos);
  EXPECT_NE(message(lumpy(13, StartSolid::octahedron), a).find("6 control points, B a"), std::string::npos);
}

TEST(Degenerate, OppositeNormalsTurnSomewhereAndPointsAreNoShape) {
  Surface a = ball(5.0), b = ball(5.0);
  shapes::set(b.parameters, 3, point(b.parameters, 3), -normal(b.parameters, 3));
  const MorphPath path = path_of(a, b, MorphSpace::plane), back = path_of(b, a, MorphSpace::plane);
  for (const double tau : {0.25, 0.5, 0.75, 1.5}) {
    const Vec3 n = normal(surface_at(path, tau).parameters, 3);
    EXPECT_NEAR(n.norm(), 1.0, 1e-12);
    EXPECT_LE((n - normal(surface_at(back, 1.0 - tau).parameters, 3)).norm(), 1e-12);
    EXPECT_NEAR(n.dot(normal(a.parameters, 3)), std::cos(tau * std::numbers::pi), 1e-12);
  }
  for (int v = 0; v < 12; ++v) shapes::set(b.parameters, v, Vec3(1, 1, 1), normal(b.parameters, v));
  EXPECT_THROW(path_of(a, b, MorphSpace::sphere), BadData);
}

}  // namespace
}  // namespace pellicle
