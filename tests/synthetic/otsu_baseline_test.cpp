#include "otsu_baseline.h"

#include <gtest/gtest.h>

#include <cmath>

#include "pellicle/base/errors.h"
#include "pellicle/synthetic/phantom.h"

namespace pellicle {
namespace {

double dice(const Image<std::uint8_t>& a, const Image<std::uint8_t>& b) {
  double both = 0.0, sum = 0.0;
  for (std::size_t n = 0; n < a.voxels.size(); ++n) {
    both += a.voxels[n] & b.voxels[n];
    sum += a.voxels[n] + b.voxels[n];
  }
  return 2.0 * both / sum;
}

PhantomSettings ball() {
  PhantomSettings settings;
  settings.size = {64, 64, 64};
  settings.radius = {18.0};
  settings.snr = 8.0;
  return settings;
}

TEST(Otsu, ThresholdLiesBetweenTwoLevels) {
  Image<float> image(ImageGrid{{10, 10, 10}, Vec3(1, 1, 1), Vec3::Zero(), Mat3::Identity()}, 3.0F);
  for (std::size_t n = 0; n < 200; ++n) image.voxels[n] = 11.0F;
  EXPECT_NEAR(bench::otsu_threshold(image), 7.0, 0.05);
}

TEST(Otsu, FindsBrightAndDarkObjectsAlike) {
  PhantomSettings settings = ball();
  const Phantom bright = make_phantom(settings);
  std::swap(settings.inside, settings.outside);
  const Phantom dark = make_phantom(settings);
  for (const Phantom* phantom : {&bright, &dark}) {
    const auto mask = bench::otsu_baseline(phantom->image, phantom->seeds[0].center, bench::OtsuObject::solid);
    EXPECT_GE(dice(mask, phantom->truth), 0.97);
  }
}

TEST(Otsu, FillsAMembrane) {
  PhantomSettings settings = ball();
  settings.fill = PhantomFill::shell;
  settings.noise = PhantomNoise::none;
  const Phantom phantom = make_phantom(settings);
  const auto mask = bench::otsu_baseline(phantom.image, phantom.natural_center, bench::OtsuObject::shell);
  EXPECT_EQ(mask.at(32, 32, 32), 1);
  EXPECT_EQ(mask.at(0, 0, 0), 0);
  EXPECT_GE(dice(mask, phantom.truth), 0.85);
}

TEST(Otsu, RefusesASeedOutside) {
  const Phantom phantom = make_phantom(ball());
  EXPECT_THROW(bench::otsu_baseline(phantom.image, Vec3(500, 0, 0), bench::OtsuObject::solid), BadData);
}

}  // namespace
}  // namespace pellicle
