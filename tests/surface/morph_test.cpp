// Paths between shapes: ends, linearity, the great circle, what they must not depend on.

#include "pellicle/surface/morph.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "pellicle/base/errors.h"
#include "shapes.h"
#include "spline_cases.h"

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
  double* block = result.parameters.data();
  for (const BlockKind kind : blocks_of(surface.model)) {
    Eigen::Map<Vec3> v(block);
    v = (kind == BlockKind::point ? f(v) : Vec3((kind == BlockKind::vector ? f.scale : 1.0) * (f.turn * v))).eval();
    block += 3;
  }
  return result;
}

/// The reference shape, everything moved by up to `amplitude`, somewhere and of some size.
Surface lumpy(const SurfaceModel& model, std::uint64_t seed, double amplitude = 0.3) {
  RandomEngine random(seed);
  Surface unit{model, affine_image(model, Vec3::Zero(), Mat3::Identity())};
  double* block = unit.parameters.data();
  for (const BlockKind kind : blocks_of(model)) {
    Eigen::Map<Vec3> v(block);
    v += shapes::random_vector(random, amplitude);
    if (kind == BlockKind::unit_normal) v.normalize();
    block += 3;
  }
  const double size = random.uniform(5, 20);
  return moved(unit, {size, Mat3::Identity(), shapes::random_vector(random, 60)});
}

Surface lumpy(std::uint64_t seed, StartSolid solid = StartSolid::icosahedron, double amplitude = 0.3) {
  return lumpy(NormalModel::start(solid, SubdivisionRule::smooth), seed, amplitude);
}

struct NamedModel {
  std::string name;
  SurfaceModel model;
};

void PrintTo(const NamedModel& model, std::ostream* out) {
  *out << model.name;
}

std::vector<NamedModel> every_kind() {
  return {{"normal", NormalModel::start(StartSolid::icosahedron, SubdivisionRule::smooth)},
          {"spline", shapes::spline_sphere(6, 4)},
          {"torus", SplineModel({.topology = SplineTopology::torus, .m1 = 6, .m2 = 4})},
          {"cylinder", SplineModel({.topology = SplineTopology::cylinder, .m1 = 5, .m2 = 2})},
          {"catmull_clark", CatmullClarkModel::start()},
          {"slime", SlimeModel::start()}};
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

struct MorphCase {
  NamedModel of;
  MorphSpace space;
};

std::vector<MorphCase> every_case() {
  std::vector<MorphCase> cases;
  for (const NamedModel& model : every_kind()) {
    for (const MorphSpace space : {MorphSpace::plane, MorphSpace::sphere}) cases.push_back({model, space});
  }
  return cases;
}

class Morph : public testing::TestWithParam<MorphCase> {
 protected:
  Surface a_ = lumpy(GetParam().of.model, 1), b_ = lumpy(GetParam().of.model, 2);
  MorphPath path_ = path_of(a_, b_, GetParam().space);
};
INSTANTIATE_TEST_SUITE_P(Models, Morph, testing::ValuesIn(every_case()), [](const auto& test) {
  return test.param.of.name + (test.param.space == MorphSpace::plane ? "_plane" : "_sphere");
});

TEST_P(Morph, EndsAreTheShapesThemselvesAndThePathRunsIntoThem) {
  EXPECT_EQ(surface_at(path_, 0.0).parameters, a_.parameters);
  EXPECT_EQ(surface_at(path_, 1.0).parameters, b_.parameters);
  for (const double tau : {1e-12, -1e-12}) {
    EXPECT_LE(farthest_apart(surface_at(path_, tau).parameters, a_.parameters), 1e-9);
    EXPECT_LE(farthest_apart(surface_at(path_, 1.0 + tau).parameters, b_.parameters), 1e-9);
  }
}

TEST_P(Morph, RunsTheSameWayFromEitherEnd) {
  const MorphPath back = path_of(b_, a_, GetParam().space);
  for (const double tau : {-0.7, 0.2, 0.5, 0.9, 1.4}) {
    EXPECT_LE(farthest_apart(surface_at(path_, tau).parameters, surface_at(back, 1.0 - tau).parameters), 1e-11);
  }
}

TEST_P(Morph, GoesAlongWithSimilarities) {
  const Similarity f = some_similarity();
  const MorphPath there = path_of(moved(a_, f), moved(b_, f), GetParam().space);
  for (const double tau : {-0.5, 0.3, 0.5, 1.5}) {
    const Surface expected = moved(surface_at(path_, tau), f);
    EXPECT_LE(farthest_apart(surface_at(there, tau).parameters, expected.parameters), 1e-10);
  }
}

TEST_P(Morph, OfAShapeWithItselfStaysThere) {
  const MorphPath still = path_of(a_, a_, GetParam().space);
  EXPECT_EQ(still.moments.angle, 0.0);
  for (const double tau : {-3.0, 0.4, 2.0}) {
    EXPECT_LE(farthest_apart(surface_at(still, tau).parameters, a_.parameters), 1e-11);
  }
}

TEST(Normals, StayUnitAndTurnByEqualAngles) {
  const auto angle = [](const Vec3& n, const Vec3& m) { return std::atan2(n.cross(m).norm(), n.dot(m)); };
  const Surface a = lumpy(1), b = lumpy(2);
  for (const MorphSpace space : {MorphSpace::plane, MorphSpace::sphere}) {
    const MorphPath path = path_of(a, b, space);
    for (int v = 0; v < control_point_count(a.model); ++v) {
      const double whole = angle(normal(a.parameters, v), normal(b.parameters, v));
      for (const double tau : {-0.25, 0.25, 0.5, 1.25}) {
        const Vec3 n = normal(surface_at(path, tau).parameters, v);
        EXPECT_NEAR(n.norm(), 1.0, 1e-14);
        EXPECT_NEAR(angle(normal(a.parameters, v), n), std::abs(tau) * whole, 1e-12);
      }
    }
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

class HilbertSphereOf : public testing::TestWithParam<NamedModel> {};
INSTANTIATE_TEST_SUITE_P(Models, HilbertSphereOf, testing::ValuesIn(every_kind()),
                         [](const auto& test) { return test.param.name; });

TEST_P(HilbertSphereOf, PlaceIsLinearSizeGeometricAndTheNormalisedShapeOfNormOne) {
  const Surface a = lumpy(GetParam().model, 5), b = lumpy(GetParam().model, 6);
  const MorphPath path = path_of(a, b, MorphSpace::sphere);
  const ShapeMoments& m = path.moments;
  for (const double tau : {-1.0, 0.1, 0.5, 0.8, 2.0}) {
    const ShapeMoments now = shape_moments(path.model, path.measure, surface_at(path, tau).parameters, a.parameters);
    EXPECT_LE((now.mean_a - ((1.0 - tau) * m.mean_a + tau * m.mean_b)).norm(), 1e-11);
    EXPECT_NEAR(now.size_a / (std::pow(m.size_a, 1.0 - tau) * std::pow(m.size_b, tau)), 1.0, 1e-12);
  }
}

/// Those that are linear in their parameters; of the normal model see below.
std::vector<NamedModel> linear_kinds() {
  std::vector<NamedModel> kinds = every_kind();
  std::erase_if(kinds, [](const NamedModel& m) { return m.name == "normal"; });
  return kinds;
}

class HilbertSphereOfLinear : public testing::TestWithParam<NamedModel> {};
INSTANTIATE_TEST_SUITE_P(Models, HilbertSphereOfLinear, testing::ValuesIn(linear_kinds()),
                         [](const auto& test) { return test.param.name; });

TEST_P(HilbertSphereOfLinear, StepsAreEqualAnglesOfOneGreatCircle) {
  const Surface a = lumpy(GetParam().model, 7), b = lumpy(GetParam().model, 8);
  const MorphPath path = path_of(a, b, MorphSpace::sphere);
  const double step = path.moments.angle / 4.0;
  EXPECT_GE(step, 0.02);
  for (int k = -2; k < 6; ++k) {
    const Surface one = surface_at(path, k / 4.0), next = surface_at(path, (k + 1) / 4.0);
    EXPECT_NEAR(shape_moments(path.model, path.measure, one.parameters, next.parameters).angle, step, 1e-10) << k;
    EXPECT_NEAR(shape_moments(path.model, path.measure, a.parameters, one.parameters).angle, std::abs(k) * step, 1e-10);
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

TEST(ShapeMoments, OfASplineAreThoseOfItsParameterSquare) {
  // By sums over a fine grid of (u, v): the pole's crowded samples count as the paper's Eq. (16) has it.
  const SplineModel model = shapes::spline_sphere(5, 3);
  const Surface a = lumpy(model, 20), b = lumpy(model, 21);
  const ShapeMoments m = path_of(a, b, MorphSpace::plane).moments;
  constexpr int n = 400;
  Vec3 mean = Vec3::Zero();
  double square = 0.0, product = 0.0;
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i < n; ++i) {
      const double u = (i + 0.5) / n, v = (j + 0.5) / n;
      const Vec3 x = model.at(a.parameters, u, v).x, y = model.at(b.parameters, u, v).x;
      mean += x / (n * n);
      square += (x - m.mean_a).squaredNorm() / (n * n);
      product += (x - m.mean_a).dot(y - m.mean_b) / (n * n);
    }
  }
  EXPECT_LE((mean - m.mean_a).norm(), 2e-4);
  EXPECT_NEAR(std::sqrt(square) / m.size_a, 1.0, 1e-5);
  EXPECT_NEAR(product / (m.size_a * m.size_b), std::cos(m.angle), 1e-5);
}

TEST(Matching, SplinesGetTheLargerNumberOfControlPointsEachWay) {
  const Surface a = lumpy(shapes::spline_sphere(8, 3), 22), b = lumpy(shapes::spline_sphere(5, 6), 23);
  const MatchedSurfaces matched = match_surfaces(a, b);
  EXPECT_TRUE(matched.a_changed && matched.b_changed);
  for (const Surface* s : {&matched.a, &matched.b}) {
    const SplineSettings& settings = std::get<SplineModel>(s->model).settings();
    EXPECT_EQ(settings.m1, 8);
    EXPECT_EQ(settings.m2, 6);
  }
  // On the surface: the new control points lie where they say; poles and tangents are kept.
  const auto& old = std::get<SplineModel>(a.model);
  const auto& larger = std::get<SplineModel>(matched.a.model);
  for (int l = 1; l < 6; ++l) {
    for (int k = 0; k < 8; ++k) {
      const Vec3 expected = old.at(a.parameters, k / 8.0, l / 6.0).x;
      EXPECT_LE((larger.at(matched.a.parameters, k / 8.0, l / 6.0).x - expected).norm(), 1e-11);
    }
  }
  EXPECT_TRUE(std::equal(a.parameters.begin(), a.parameters.begin() + 18, matched.a.parameters.begin()));
  const MatchedSurfaces same = match_surfaces(a, a);
  EXPECT_FALSE(same.a_changed || same.b_changed);
}

TEST(Matching, QuadModelsRefineExactlyOrRefuse) {
  const Surface a = lumpy(CatmullClarkModel::start(), 24), b = lumpy(CatmullClarkModel::start(1), 25);
  const MatchedSurfaces matched = match_surfaces(a, b);
  EXPECT_TRUE(matched.a_changed);
  EXPECT_EQ(control_point_count(matched.a.model), 26);
  EXPECT_NEAR(volume(matched.a) / volume(refine(a)), 1.0, 1e-12);
  EXPECT_THROW(match_surfaces(a, lumpy(SlimeModel::start(), 26)), UsageError);
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
  EXPECT_NE(message(a, published).find("`rule`"), std::string::npos);
  EXPECT_NE(message(a, lumpy(13, StartSolid::octahedron)).find("`start`"), std::string::npos);
  EXPECT_NE(message(lumpy(13, StartSolid::octahedron), a).find("6 control points, B a"), std::string::npos);
  const Surface sphere = lumpy(shapes::spline_sphere(5, 3), 14);
  const Surface keys = lumpy(shapes::spline_sphere(5, 3, SplineGenerator::keys), 15);
  const Surface torus = lumpy(SplineModel({.topology = SplineTopology::torus, .m1 = 6, .m2 = 4}), 16);
  EXPECT_NE(message(a, sphere).find("of one kind"), std::string::npos);
  EXPECT_NE(message(sphere, keys).find("of one kind"), std::string::npos);
  EXPECT_NE(message(sphere, torus).find("'spline-torus'"), std::string::npos);
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
