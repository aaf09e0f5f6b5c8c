#include <gtest/gtest.h>

#include <cstring>

#include "jet_patch.h"
#include "pellicle/base/errors.h"
#include "pellicle/base/parallel.h"
#include "shapes.h"

namespace pellicle {
namespace {

using shapes::kNaN;

/// Values and Jacobians computed into memory that holds NaN before.
SurfaceSamples evaluated(const NormalModel& model, const Parameters& parameters, const SampleLayout& layout) {
  SurfaceSamples samples;
  samples.x.assign(layout.sample_count(), Vec3::Constant(kNaN));
  samples.normal = samples.x;
  samples.jacobian.assign(std::size_t(layout.sample_count()) * 54, kNaN);
  model.evaluate(parameters, layout, true, samples);
  return samples;
}

/// Compares all samples with dual numbers, and the adjoint of random cotangents with the Jacobian.
void expect_derivatives_right(const NormalModel& model, const Parameters& parameters, int level, RandomEngine& random) {
  const SampleLayout layout = model.layout(level);
  const SurfaceSamples samples = evaluated(model, parameters, layout);
  std::vector<Vec3> dE_dx(layout.sample_count());
  for (Vec3& v : dE_dx) v = shapes::random_vector(random, 1);
  std::vector<double> gradient(parameters.size(), 0.0), expected(parameters.size(), 0.0);
  model.pull_back(parameters, layout, dE_dx, gradient);

  std::vector<oracle::JetVertex> local;
  // near the kinks of the printed weights rounding is magnified from level to level
  const double tolerance = model.rule() == SubdivisionRule::published ? 1e-8 : 1e-11;
  double scale = 1;
  for (const SamplePatch& patch : layout.patches) {
    oracle::refine_patch(*layout.refinement, model.rule(), parameters, patch, local);
    for (int i = 0; i < patch.sample_count; ++i) {
      const int sample = patch.first_sample + i;
      const oracle::JetVertex& vertex = local[layout.owned_local[sample]];
      for (int r = 0; r < 3; ++r) {
        ASSERT_LE(std::abs(samples.x[sample][r] - vertex.p[r].a), 1e-12 * (1 + std::abs(vertex.p[r].a)));
        ASSERT_LE(std::abs(samples.normal[sample][r] - vertex.n[r].a), 1e-12);
        const double size = 1 + vertex.p[r].v.cwiseAbs().maxCoeff();
        scale = std::max(scale, size);
        for (int k = 0; k < 18; ++k) {
          const double have = samples.jacobian[patch.jacobian_offset + 54 * std::size_t(i) + 18 * r + k];
          ASSERT_LE(std::abs(have - vertex.p[r].v[k]), tolerance * size)
              << "rule " << static_cast<int>(model.rule()) << " sample " << sample << " column " << k;
          expected[3 * std::size_t(patch.blocks[k / 3]) + k % 3] += dE_dx[sample][r] * vertex.p[r].v[k];
        }
      }
    }
  }
  for (std::size_t k = 0; k < gradient.size(); ++k) {
    ASSERT_LE(std::abs(gradient[k] - expected[k]), tolerance * scale * std::sqrt(double(layout.sample_count())));
  }
}

TEST(NormalModelDerivatives, AgreeWithDualNumbersOnRandomShapes) {
  RandomEngine random(21);
  for (const SubdivisionRule rule : shapes::kRules) {
    for (const StartSolid solid : shapes::kSolids) {
      const NormalModel model = NormalModel::start(solid, rule);
      for (int level = 0; level <= 4; ++level) {
        expect_derivatives_right(model, shapes::perturbed_sphere(model, 0.2, random), level, random);
      }
    }
    const NormalModel irregular = shapes::random_inscribed(9, rule, random);
    expect_derivatives_right(irregular, shapes::perturbed_sphere(irregular, 0.05, random), 2, random);
  }
}

TEST(NormalModelDerivatives, NormalsNeedNotBeUnit) {
  RandomEngine random(22);
  const NormalModel model = NormalModel::start(StartSolid::octahedron, SubdivisionRule::smooth);
  Parameters parameters = shapes::perturbed_sphere(model, 0.1, random);
  for (int v = 0; v < model.vertex_count(); ++v) {
    shapes::set(parameters, v, shapes::point(parameters, v), random.uniform(0.8, 1.2) * shapes::normal(parameters, v));
  }
  const SampleLayout layout = model.layout(2);
  const SurfaceSamples samples = evaluated(model, parameters, layout);
  for (const Vec3& n : samples.normal) EXPECT_LE(std::abs(n.norm() - 1), 1e-14);
  // by differences: what counts is that the derivative belongs to the value
  std::vector<Vec3> dE_dx(layout.sample_count());
  for (Vec3& v : dE_dx) v = shapes::random_vector(random, 1);
  std::vector<double> gradient(parameters.size(), 0.0);
  model.pull_back(parameters, layout, dE_dx, gradient);
  const auto energy = [&](const Parameters& at) {
    SurfaceSamples there;
    model.evaluate(at, layout, false, there);
    double sum = 0;
    for (std::size_t i = 0; i < dE_dx.size(); ++i) sum += dE_dx[i].dot(there.x[i]);
    return sum;
  };
  for (std::size_t k = 0; k < parameters.size(); ++k) {
    const auto moved = [&](double by) {
      Parameters at = parameters;
      at[k] += by;
      return energy(at);
    };
    const double h = 1e-4;
    const double expected = (moved(-2 * h) - 8 * moved(-h) + 8 * moved(h) - moved(2 * h)) / (12 * h);
    EXPECT_LE(std::abs(gradient[k] - expected), 1e-8 * (1 + std::abs(expected)));
  }
}

TEST(NormalModelDerivatives, DegenerateControlMeshesGiveFiniteNumbers) {
  RandomEngine random(23);
  for (const SubdivisionRule rule : shapes::kRules) {
    const NormalModel model = NormalModel::start(StartSolid::octahedron, rule);
    const Parameters sphere = model.reference();
    std::vector<Parameters> cases(6, sphere);
    for (int v = 0; v < model.vertex_count(); ++v) {
      const Vec3 p = shapes::point(sphere, v);
      shapes::set(cases[0], v, Vec3(1, 2, 3), p);                                          // collapsed to a point
      shapes::set(cases[1], v, Vec3(p.x(), p.y(), 0), Vec3(0, 0, 1));                      // flat
      shapes::set(cases[2], v, p, -p);                                                     // turned inside out
      shapes::set(cases[3], v, Vec3(p.x(), 0, 0), p);                                      // a line
      shapes::set(cases[4], v, p, v % 2 == 0 ? Vec3(0, 0, 1) : Vec3(0, 0, -1));            // opposite normals
      shapes::set(cases[5], v, p, (shapes::point(sphere, (v + 2) % 6) - p).normalized());  // normals along edges
    }
    for (const Parameters& parameters : cases) {
      for (int level = 0; level <= 4; ++level) {
        const SampleLayout layout = model.layout(level);
        const SurfaceSamples samples = evaluated(model, parameters, layout);
        for (const Vec3& x : samples.x) ASSERT_TRUE(x.allFinite());
        for (const Vec3& n : samples.normal) ASSERT_LE(std::abs(n.norm() - 1), 1e-12);
        for (const double value : samples.jacobian) ASSERT_TRUE(std::isfinite(value));
        std::vector<double> gradient(parameters.size(), 0.0);
        model.pull_back(parameters, layout, samples.x, gradient);
        for (const double value : gradient) ASSERT_TRUE(std::isfinite(value));
      }
    }
  }
}

TEST(NormalModelDerivatives, PullBackAdds) {
  const NormalModel model = NormalModel::start(StartSolid::tetrahedron, SubdivisionRule::smooth);
  const SampleLayout layout = model.layout(2);
  const std::vector<Vec3> dE_dx(layout.sample_count(), Vec3(1, -2, 0.5));
  std::vector<double> once(model.parameter_count(), 0.0), onto(model.parameter_count(), 7.0);
  model.pull_back(model.reference(), layout, dE_dx, once);
  model.pull_back(model.reference(), layout, dE_dx, onto);
  for (std::size_t k = 0; k < once.size(); ++k) EXPECT_LE(std::abs(onto[k] - once[k] - 7), 1e-12);
}

TEST(NormalModelDerivatives, SameBytesForAnyNumberOfThreads) {
  RandomEngine random(24);
  const NormalModel model = NormalModel::start(StartSolid::icosahedron, SubdivisionRule::smooth);
  const Parameters parameters = shapes::perturbed_sphere(model, 0.2, random);
  const SampleLayout layout = model.layout(5);
  const auto run = [&](int threads) {
    const ThreadLimit limit(threads);
    const SurfaceSamples samples = evaluated(model, parameters, layout);
    std::vector<double> all(samples.jacobian);
    for (const Vec3& x : samples.x) all.insert(all.end(), x.begin(), x.end());
    for (const Vec3& n : samples.normal) all.insert(all.end(), n.begin(), n.end());
    std::vector<double> gradient(parameters.size(), 0.0);
    model.pull_back(parameters, layout, samples.x, gradient);
    all.insert(all.end(), gradient.begin(), gradient.end());
    return all;
  };
  const std::vector<double> one = run(1);
  for (const int threads : {2, 3, 0}) {
    const std::vector<double> other = run(threads);
    ASSERT_EQ(one.size(), other.size());
    EXPECT_EQ(std::memcmp(one.data(), other.data(), one.size() * sizeof(double)), 0) << threads;
  }
}

TEST(NormalModelDerivatives, RefusesSizesThatDoNotFit) {
  const NormalModel model = NormalModel::start(StartSolid::tetrahedron, SubdivisionRule::smooth);
  const NormalModel other = NormalModel::start(StartSolid::octahedron, SubdivisionRule::smooth);
  SurfaceSamples samples;
  std::vector<double> gradient(model.parameter_count());
  EXPECT_THROW(model.evaluate(Parameters(3), model.layout(1), false, samples), BadData);
  EXPECT_THROW(model.evaluate(model.reference(), other.layout(1), false, samples), BadData);
  EXPECT_THROW(model.evaluate(model.reference(), SampleLayout{}, false, samples), BadData);
  EXPECT_THROW(model.pull_back(model.reference(), model.layout(1), {}, gradient), BadData);
}

}  // namespace
}  // namespace pellicle
