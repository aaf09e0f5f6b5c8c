#include <ceres/jet.h>
#include <gtest/gtest.h>

#include "pellicle/surface/normal/internal/normal_edge_rule.h"
#include "shapes.h"

namespace pellicle {
namespace {

using shapes::kNaN;
using Jacobian = Eigen::Matrix<double, 6, 15>;  // (p, n) by (p0, n0, p1, n1, d)
using Jet15 = ceres::Jet<double, 15>;

/// An edge's inputs in the column order of `Jacobian`.
struct Edge {
  Vec3 p0, n0, p1, n1, d = Vec3::Zero();
  EdgeEnds ends() const { return {p0, n0, p1, n1, d}; }
};

Edge random_edge(RandomEngine& random) {
  return {shapes::random_vector(random, 2), shapes::random_unit(random), shapes::random_vector(random, 2),
          shapes::random_unit(random), shapes::random_vector(random, 1)};
}

/// Edges on which a naive rule divides by zero.
std::vector<std::pair<std::string, Edge>> degenerate_edges() {
  const Vec3 o(0, 0, 0), x(1, 0, 0), y(0, 1, 0), z(0, 0, 1), slanted = Vec3(1, 2, 0.5).normalized();
  return {{"both angles zero", {o, y, x, y, z}},
          {"both angles zero, twisted", {o, y, x, (y + z).normalized(), z}},
          {"first angle zero", {o, y, x, slanted, z}},
          {"second angle zero", {o, slanted, x, z, y}},
          {"first normal along the edge", {o, x, x, y, z}},
          {"first normal against the edge", {o, -x, x, y, z}},
          {"both normals along the edge", {o, x, x, x, z}},
          {"both normals out along the edge", {o, -x, x, x, z}},
          {"opposite normals", {o, y, x, -y, z}},
          {"opposite slanted normals", {o, slanted, x, -slanted, z}},
          {"coinciding ends", {x, y, x, z, z}},
          {"coinciding ends, same normal", {x, y, x, y, z}},
          {"zero normals", {o, o, x, o, z}},
          {"everything zero", {o, o, o, o, o}},
          {"opposite sines", {o, (y + x).normalized(), x, (y + x).normalized(), z}},
          {"direction along the mean normal", {o, y, x, y, y}},
          {"direction along the edge", {o, y, x, y, x}},
          {"no direction", {o, (y - x).normalized(), x, (y + x).normalized(), o}},
          {"nearly flat", {o, Vec3(-1e-90, 1, 0), x, Vec3(1e-90, 1, 0), z}},
          {"minute angles", {o, Vec3(-1e-170, 1, 0), x, Vec3(1e-170, 1, 0), z}},
          {"minute edge", {o, y, 1e-150 * x, slanted, 1e-150 * z}},
          {"huge edge", {o, y, 1e60 * x, slanted, 1e60 * z}},
          {"normals far too long", {o, 3 * slanted, x, 3 * y, z}},
          {"reversed normals", {o, -(y - x).normalized(), x, -(y + x).normalized(), z}}};
}

template <EdgeRule rule>
PointNormal<double> value(const Edge& edge) {
  return refine_edge<rule, double>(edge.p0, edge.n0, edge.p1, edge.n1, edge.d);
}

template <EdgeRule rule>
Jacobian by_jets(const Edge& edge) {
  Vector3<Jet15> in[5];
  const Vec3* const vectors[5] = {&edge.p0, &edge.n0, &edge.p1, &edge.n1, &edge.d};
  for (int k = 0; k < 15; ++k) in[k / 3][k % 3] = Jet15((*vectors[k / 3])[k % 3], k);
  const PointNormal<Jet15> out = refine_edge<rule, Jet15>(in[0], in[1], in[2], in[3], in[4]);
  Jacobian result;
  for (int r = 0; r < 3; ++r) {
    result.row(r) = out.p[r].v.transpose();
    result.row(r + 3) = out.n[r].v.transpose();
  }
  return result;
}

template <EdgeRule rule>
Jacobian by_forward(const Edge& edge) {
  PointNormal<double> value{Vec3::Constant(kNaN), Vec3::Constant(kNaN)};
  EdgeDerivative by;
  for (Mat3* m : {&by.p_e, &by.p_n0, &by.p_n1, &by.n_e, &by.n_n0, &by.n_n1, &by.n_d}) m->setConstant(kNaN);
  differentiate_edge<rule, true>(edge.ends(), value, by);
  const PointNormal<double> expected = refine_edge<rule, double>(edge.p0, edge.n0, edge.p1, edge.n1, edge.d);
  EXPECT_LE((value.p - expected.p).norm(), 1e-14 * (1 + expected.p.norm()));
  EXPECT_LE((value.n - expected.n).norm(), 1e-14);
  const Mat3 half = 0.5 * Mat3::Identity();
  Jacobian result;
  result << half - by.p_e, by.p_n0, half + by.p_e, by.p_n1, Mat3::Zero(),  //
      -by.n_e, by.n_n0, by.n_e, by.n_n1, by.n_d;
  return result;
}

template <EdgeRule rule>
Jacobian by_adjoint(const Edge& edge) {
  Jacobian result;
  for (int row = 0; row < 6; ++row) {
    Edge bar{Vec3::Zero(), Vec3::Zero(), Vec3::Zero(), Vec3::Zero(), Vec3::Zero()};
    const Vec3 bar_p = row < 3 ? Vec3(Vec3::Unit(row)) : Vec3(Vec3::Zero());
    const Vec3 bar_n = row < 3 ? Vec3(Vec3::Zero()) : Vec3(Vec3::Unit(row - 3));
    const EdgeCotangents bars{bar.p0, bar.n0, bar.p1, bar.n1, bar.d};
    if (row < 3) {
      pull_back_edge<rule, false>(edge.ends(), bar_p, Vec3::Constant(kNaN), bars);
    } else {
      pull_back_edge<rule, true>(edge.ends(), bar_p, bar_n, bars);
    }
    result.row(row) << bar.p0.transpose(), bar.n0.transpose(), bar.p1.transpose(), bar.n1.transpose(),
        bar.d.transpose();
  }
  return result;
}

template <EdgeRule rule>
Jacobian by_differences(const Edge& edge) {
  const double h = 2e-4;
  Jacobian result;
  for (int k = 0; k < 15; ++k) {
    const auto moved = [&](double by) {
      Edge other = edge;
      Vec3* const vectors[5] = {&other.p0, &other.n0, &other.p1, &other.n1, &other.d};
      (*vectors[k / 3])[k % 3] += by;
      const PointNormal<double> out = value<rule>(other);
      Eigen::Matrix<double, 6, 1> both;
      both << out.p, out.n;
      return both;
    };
    result.col(k) = (moved(-2 * h) - 8 * moved(-h) + 8 * moved(h) - moved(2 * h)) / (12 * h);
  }
  return result;
}

/// Calls `check.operator()<rule>()` for every rule.
template <class Check>
void for_every_rule(const Check& check) {
  check.template operator()<EdgeRule::convex>();
  check.template operator()<EdgeRule::convex_direction>();
  check.template operator()<EdgeRule::balanced>();
  check.template operator()<EdgeRule::published>();
}

void expect_golden(const nlohmann::json& expected, const PointNormal<double>& have, double tolerance) {
  EXPECT_LE((have.p - shapes::vector(expected.at("p"))).norm(), tolerance);
  EXPECT_LE((have.n - shapes::vector(expected.at("n"))).norm(), tolerance);
}

TEST(EdgeRule, AgreesWithTheIndependentImplementation) {
  const nlohmann::json golden = shapes::golden();
  int seen = 0;
  for (const auto& c : golden.at("edge")) {
    SCOPED_TRACE(c.at("name").get<std::string>());
    const Edge edge{shapes::vector(c.at("p0")), shapes::vector(c.at("n0")), shapes::vector(c.at("p1")),
                    shapes::vector(c.at("n1")), shapes::vector(c.at("d"))};
    expect_golden(c.at("balanced_perp"), value<EdgeRule::balanced>(edge), 1e-12);
    expect_golden(c.at("convex_perp"), value<EdgeRule::convex>(edge), 1e-12);
    expect_golden(c.at("convex_dir_a2"), value<EdgeRule::convex_direction>(edge), 1e-12);
    if (c.contains("published")) expect_golden(c.at("published"), value<EdgeRule::published>(edge), 1e-9);
    ++seen;
  }
  EXPECT_EQ(seen, 7);
}

TEST(EdgeRule, HandleFactorAndItsSlopeAgreeWithGolden) {
  using Jet1 = ceres::Jet<double, 1>;
  const auto golden = shapes::golden();
  for (const auto& row : golden.at("G")) {
    const Jet1 G = edge_detail::handle_factor<EdgeRule::convex, Jet1>(Jet1(row.at(0).get<double>(), 0));
    EXPECT_LE(std::abs(G.a - row.at(1).get<double>()), 1e-12 * std::abs(G.a));
    EXPECT_LE(std::abs(G.v[0] - row.at(2).get<double>()), 1e-11 * std::abs(G.v[0]));
  }
}

TEST(EdgeRule, DerivativesAgreeWithGolden) {
  const nlohmann::json golden = shapes::golden(), c = golden.at("edge").at(0), all = golden.at("edge_jacobian_case0");
  const Edge edge{shapes::vector(c.at("p0")), shapes::vector(c.at("n0")), shapes::vector(c.at("p1")),
                  shapes::vector(c.at("n1")), shapes::vector(c.at("d"))};
  const Jacobian convex = by_forward<EdgeRule::convex>(edge), direction = by_forward<EdgeRule::convex_direction>(edge);
  for (int r = 0; r < 6; ++r) {
    for (int k = 0; k < 12; ++k) {
      EXPECT_LE(std::abs(convex(r, k) - all.at("convex_perp_6x12").at(r).at(k).get<double>()), 1e-9);
    }
    for (int k = 0; k < 15; ++k) {
      EXPECT_LE(std::abs(direction(r, k) - all.at("convex_dir_a2_6x15_last3_are_d").at(r).at(k).get<double>()), 1e-9);
    }
  }
}

TEST(EdgeRule, ForwardAndAdjointAgreeWithDualNumbers) {
  RandomEngine random(11);
  for (int trial = 0; trial < 3000; ++trial) {
    const Edge edge = random_edge(random);
    for_every_rule([&]<EdgeRule rule>() {
      const Jacobian expected = by_jets<rule>(edge);
      // rounding of the inputs is magnified by the sensitivity once more
      const double sensitivity = expected.cwiseAbs().maxCoeff();
      const double tolerance = 1e-12 * (1 + sensitivity) + 1e-15 * sensitivity * sensitivity;
      EXPECT_LE((by_forward<rule>(edge) - expected).cwiseAbs().maxCoeff(), tolerance) << "trial " << trial;
      EXPECT_LE((by_adjoint<rule>(edge) - expected).cwiseAbs().maxCoeff(), tolerance) << "trial " << trial;
    });
  }
}

TEST(EdgeRule, DerivativesAgreeWithDifferences) {
  RandomEngine random(12);
  int tried = 0;
  while (tried < 500) {
    Edge edge = random_edge(random);
    edge.n1 = (edge.n0 + 0.6 * shapes::random_unit(random)).normalized();
    // away from the kinks of the printed weights and from nearly parallel m, t and d
    const Vec3 e = (edge.p1 - edge.p0).normalized();
    if ((edge.p1 - edge.p0).norm() < 0.5 || std::abs(edge.n0.dot(e)) < 0.1 || std::abs(edge.n1.dot(e)) < 0.1) continue;
    if (std::max(std::abs(edge.n0.dot(e)), std::abs(edge.n1.dot(e))) > 0.9) continue;
    edge.d = (edge.n0 + edge.n1).cross(e) + shapes::random_vector(random, 0.3);
    ++tried;
    for_every_rule([&]<EdgeRule rule>() {
      const Jacobian have = by_forward<rule>(edge);
      EXPECT_LE((have - by_differences<rule>(edge)).cwiseAbs().maxCoeff(), 1e-8 * (1 + have.cwiseAbs().maxCoeff()));
    });
  }
}

TEST(EdgeRule, DegenerateEdgesGiveFiniteValuesUnitNormalsAndFiniteDerivatives) {
  for (const auto& [name, edge] : degenerate_edges()) {
    SCOPED_TRACE(name);
    for_every_rule([&, &given = edge]<EdgeRule rule>() {
      SCOPED_TRACE(static_cast<int>(rule));
      const PointNormal<double> out = value<rule>(given);
      EXPECT_TRUE(out.p.allFinite());
      EXPECT_LE(std::abs(out.n.norm() - 1), 1e-12);
      const Jacobian forward = by_forward<rule>(given), adjoint = by_adjoint<rule>(given);
      EXPECT_TRUE(forward.allFinite());
      EXPECT_LE((forward - adjoint).cwiseAbs().maxCoeff(), 1e-11 * (1 + forward.cwiseAbs().maxCoeff()));
    });
  }
}

TEST(EdgeRule, FlatEdgeIsHalved) {
  const Edge edge{Vec3(1, 2, 3), Vec3(0, 0, 1), Vec3(4, 1, 3), Vec3(0, 0, 1), Vec3(0, 1, 0)};
  for_every_rule([&]<EdgeRule rule>() {
    const PointNormal<double> out = value<rule>(edge);
    EXPECT_LE((out.p - Vec3(2.5, 1.5, 3)).norm(), 1e-15);
    EXPECT_LE((out.n - Vec3(0, 0, 1)).norm(), 1e-15);
  });
}

TEST(EdgeRule, ArcsOfCirclesStayOnTheCircle) {
  for (double half = 0.01; half < 1.35; half += 0.05) {
    const Vec3 a(std::cos(half), -std::sin(half), 0), b(std::cos(half), std::sin(half), 0);
    const Edge edge{2 * a, a, 2 * b, b, Vec3(0.2, 0.1, 1)};
    for_every_rule([&]<EdgeRule rule>() {
      const PointNormal<double> out = value<rule>(edge);
      EXPECT_LE((out.p - Vec3(2, 0, 0)).norm(), 1e-14) << half;
      EXPECT_LE((out.n - Vec3(1, 0, 0)).norm(), 1e-14) << half;
    });
  }
}

TEST(EdgeRule, DoesNotKnowWhichEndIsFirst) {
  RandomEngine random(13);
  for (int trial = 0; trial < 300; ++trial) {
    const Edge edge = random_edge(random);
    const Edge turned{edge.p1, edge.n1, edge.p0, edge.n0, -edge.d};
    for_every_rule([&]<EdgeRule rule>() {
      const PointNormal<double> one = value<rule>(edge), other = value<rule>(turned);
      EXPECT_LE((one.p - other.p).norm(), 1e-13);
      EXPECT_LE((one.n - other.n).norm(), 1e-9);  // the direction may be ill-conditioned
    });
  }
}

TEST(EdgeRule, SmoothRulesHaveContinuousDerivatives) {
  // across s0 = 0, where the convex weight sets in, and across z = 0.04, where the handle factor is continued
  const auto jump = []<EdgeRule rule>(double angle) {
    const auto at = [&](double by) {
      const double a = angle + by;
      return by_forward<rule>({Vec3(0, 0, 0), Vec3(-std::sin(a), std::cos(a), 0.1).normalized(), Vec3(1, 0, 0),
                               Vec3(0.3, 1, 0).normalized(), Vec3(0.1, 0.2, 1)});
    };
    return (at(1e-7) - at(-1e-7)).cwiseAbs().maxCoeff();
  };
  for (const double angle : {0.0, std::acos(0.2), 1.3}) {
    EXPECT_LE(jump.operator()<EdgeRule::convex>(angle), 1e-4);
    EXPECT_LE(jump.operator()<EdgeRule::convex_direction>(angle), 1e-4);
    EXPECT_LE(jump.operator()<EdgeRule::balanced>(angle), 1e-4);
  }
  EXPECT_GE(jump.operator()<EdgeRule::published>(0.0), 0.1) << "the printed weights have a kink: the test can fail";
}

}  // namespace
}  // namespace pellicle
