#include "pellicle/surface/spline/spline_volume.h"

#include <gtest/gtest.h>

#include <numbers>

#include "pellicle/base/constants.h"
#include "pellicle/base/errors.h"
#include "pellicle/surface/surface.h"
#include "spline_cases.h"

namespace pellicle {
namespace {

std::vector<SplineModel> closed_splines() {
  std::vector<SplineModel> result = shapes::all_splines();
  std::erase_if(result, [](const SplineModel& m) { return !m.is_closed(); });
  result.push_back(shapes::spline_sphere(8, 8));
  return result;
}

double norm(const std::vector<double>& x) {
  return Eigen::Map<const Eigen::VectorXd>(x.data(), static_cast<Eigen::Index>(x.size())).norm();
}

double difference(std::vector<double> a, const std::vector<double>& b) {
  for (std::size_t i = 0; i < a.size(); ++i) a[i] -= b[i];
  return norm(a);
}

TEST(SplineVolume, GoldenValuesAndGradients) {
  for (const char* size : {"5x3", "6x4"}) {
    const nlohmann::json golden = shapes::spline_golden("exp_sphere").at(size);
    const SplineModel model = shapes::spline_sphere(size[0] - '0', size[2] - '0');
    const Parameters parameters = shapes::in_block_order(golden.at("parameters"));
    const double expected = golden.at("volume").get<double>();
    const std::vector<double> slope = shapes::in_block_order(golden.at("volume_gradient"));
    std::vector<double> gradient(parameters.size(), 0.0), by_form(parameters.size(), 0.0);
    EXPECT_NEAR(SplineVolume(model, 10).value_and_gradient(parameters, gradient), expected, 1e-12);
    EXPECT_NEAR(SplineVolumeForm(model).value_and_gradient(parameters, by_form), expected, 1e-12);
    EXPECT_NEAR(SplineVolume(model).value(parameters), expected, 1e-8 * expected);
    EXPECT_LE(difference(gradient, slope), 1e-11 * norm(slope));
    EXPECT_LE(difference(by_form, slope), 1e-11 * norm(slope));
  }
}

TEST(SplineVolume, BothFormsAgree) {
  RandomEngine random(31);
  for (const SplineModel& model : closed_splines()) {
    const Parameters parameters = shapes::perturbed(model, 0.15, random);
    std::vector<double> gradient(parameters.size(), 0.0), by_form(parameters.size(), 0.0);
    const double volume = SplineVolume(model).value_and_gradient(parameters, gradient);
    const double exact = SplineVolumeForm(model).value_and_gradient(parameters, by_form);
    EXPECT_NEAR(volume, exact, 1e-8 * std::abs(exact)) << model.name();
    EXPECT_LE(difference(gradient, by_form), 1e-7 * norm(by_form)) << model.name();
    std::vector<double> finer(parameters.size(), 0.0);
    EXPECT_NEAR(SplineVolume(model, 8).value_and_gradient(parameters, finer), exact, 1e-11 * std::abs(exact));
    EXPECT_LE(difference(finer, by_form), 1e-10 * norm(by_form)) << model.name();
    EXPECT_EQ(SplineVolume(model).value(parameters), volume);
  }
}

TEST(SplineVolume, GradientIsTheDerivativeAndAdds) {
  RandomEngine random(32);
  for (const SplineModel& model : closed_splines()) {
    const Parameters parameters = shapes::perturbed(model, 0.15, random);
    const SplineVolume volume(model, 10);
    std::vector<double> gradient(parameters.size(), 1.0);
    volume.value_and_gradient(parameters, gradient);
    for (std::size_t p = 0; p < parameters.size(); p += 5) {
      Parameters low = parameters, high = parameters;
      low[p] -= 1e-4;
      high[p] += 1e-4;  // a cubic: the error is 1e-8 times the third derivative, which is zero for one scalar
      EXPECT_NEAR(gradient[p] - 1.0, (volume.value(high) - volume.value(low)) / 2e-4, 1e-9) << model.name();
    }
  }
}

TEST(SplineVolume, KnownShapes) {
  Mat3 A;
  A << 2, 0.3, -0.4, 0.1, 1.2, 0.5, -0.2, 0.3, 0.7;
  const SplineModel sphere = shapes::spline_sphere(4, 2);
  const double ball = 4 * kPi / 3 * A.determinant();
  EXPECT_NEAR(SplineVolume(sphere, 10).value(affine_image(sphere, Vec3(10, 20, 30), A)), ball, 1e-11 * 1e4);
  EXPECT_NEAR(SplineVolume(sphere).value(affine_image(sphere, Vec3::Zero(), A)), ball, 1e-4 * ball);
  const SplineModel torus({.topology = SplineTopology::torus, .m1 = 6, .m2 = 4, .reference_ratio = 0.3});
  EXPECT_NEAR(SplineVolume(torus, 10).value(torus.reference()), 2 * kPi * kPi * 0.09, 1e-12);
}

TEST(SplineVolume, DenseMeshesConvergeToItAtSecondOrder) {
  RandomEngine random(33);
  for (const SplineModel& model : closed_splines()) {
    const Parameters parameters = shapes::perturbed(model, 0.1, random);
    const double volume = SplineVolume(model, 8).value(parameters);
    double previous = 0;
    for (const int level : {3, 4}) {
      const double error = std::abs(shapes::flat_volume(tessellate({model, parameters}, level)) - volume);
      if (previous > 0) {
        EXPECT_NEAR(std::log2(previous / error), 2.0, 0.25) << model.name();
      }
      previous = error;
    }
    EXPECT_LE(previous, 0.02 * volume);
  }
}

TEST(SplineVolume, FollowsTheDeterminantAndIgnoresPlace) {
  RandomEngine random(34);
  for (const SplineModel& model : closed_splines()) {
    Parameters parameters = shapes::perturbed(model, 0.15, random);
    const SplineVolume volume(model, 8);
    const double before = volume.value(parameters);
    const std::vector<BlockKind> kinds = model.blocks();
    for (std::size_t b = 0; b < kinds.size(); ++b) {
      for (int axis = 0; axis < 3; ++axis) {
        parameters[3 * b + axis] *= axis == 0 ? -2.0 : 3.0;
        if (kinds[b] == BlockKind::point) parameters[3 * b + axis] += 5.0;
      }
    }
    EXPECT_NEAR(volume.value(parameters), -18 * before, 1e-7) << "a reflection turns it inside out";
  }
}

TEST(SplineVolume, RefusesOpenSurfaces) {
  EXPECT_THROW(SplineVolume{start_spline(SplineTopology::cylinder)}, UsageError);
  EXPECT_THROW(SplineVolumeForm{start_spline(SplineTopology::rectangle)}, UsageError);
  EXPECT_THROW(SplineVolume(start_spline(SplineTopology::sphere)).value(Parameters(3)), BadData);
}

}  // namespace
}  // namespace pellicle
