#include "pellicle/synthetic/degrade.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "pellicle/base/parallel.h"
#include "pellicle/base/random.h"

namespace pellicle {
namespace {

/// Calls body(engine, row) for each row of voxels along x, each with an engine of its own.
template <class Body>
void for_each_row(Image<float>& image, std::uint64_t seed, const Body& body) {
  const auto width = static_cast<std::size_t>(image.grid.size[0]);
  parallel_for(width == 0 ? 0 : image.voxels.size() / width, 64, [&](std::size_t begin, std::size_t end) {
    for (std::size_t row = begin; row < end; ++row) {
      // Hashed twice: engines whose states differ by a small number of steps would repeat one another.
      RandomEngine mixer(seed ^ RandomEngine(row).next());
      RandomEngine engine(mixer.next());
      body(engine, image.voxels.data() + row * width, width);
    }
  });
}

class BiasField {
 public:
  BiasField(const ImageGrid& grid, std::uint64_t seed) : diagonal_(grid.extent().norm()) {
    RandomEngine random(seed ^ 0xb1a5ULL);
    for (Wave& wave : waves_) {
      const Vec3 direction = Vec3(random.normal(), random.normal(), random.normal()).normalized();
      wave.frequency = direction * (2.0 * std::numbers::pi / random.uniform(1.0, 2.0));
      wave.phase = random.uniform(0.0, 2.0 * std::numbers::pi);
      wave.height = random.uniform(0.5, 1.0);
    }
    constexpr int kSteps = 24;  // dense enough for waves longer than the volume
    double low = 1e300, high = -1e300;
    for (int k = 0; k <= kSteps; ++k) {
      for (int j = 0; j <= kSteps; ++j) {
        for (int i = 0; i <= kSteps; ++i) {
          const Vec3 last(grid.size[0] - 1, grid.size[1] - 1, grid.size[2] - 1);
          const double value = raw(grid.world_from_index(Vec3(i, j, k).cwiseProduct(last) / kSteps));
          low = std::min(low, value);
          high = std::max(high, value);
        }
      }
    }
    middle_ = 0.5 * (low + high);
    scale_ = high > low ? 2.0 / (high - low) : 0.0;
  }
  double operator()(const Vec3& x_in_world) const {
    return std::clamp((raw(x_in_world) - middle_) * scale_, -1.0, 1.0);
  }

 private:
  struct Wave {
    Vec3 frequency;
    double phase, height;
  };
  double raw(const Vec3& x_in_world) const {
    double sum = 0.0;
    for (const Wave& wave : waves_)
      sum += wave.height * std::sin(wave.frequency.dot(x_in_world) / diagonal_ + wave.phase);
    return sum;
  }
  double diagonal_, middle_ = 0.0, scale_ = 1.0;
  std::array<Wave, 3> waves_;
};

}  // namespace

void apply_bias(Image<float>& image, double amplitude, std::uint64_t seed) {
  if (amplitude <= 0.0) return;
  const BiasField field(image.grid, seed);
  const Index3& size = image.grid.size;
  parallel_for(static_cast<std::size_t>(size[2]), 1, [&](std::size_t begin, std::size_t end) {
    for (int k = static_cast<int>(begin); k < static_cast<int>(end); ++k) {
      for (int j = 0; j < size[1]; ++j) {
        for (int i = 0; i < size[0]; ++i) {
          float& value = image.at(i, j, k);
          value = static_cast<float>(value * (1.0 + amplitude * field(image.grid.world_from_index(Vec3(i, j, k)))));
        }
      }
    }
  });
}

void apply_noise(Image<float>& image, PhantomNoise noise, double sd, double reference, std::uint64_t seed) {
  switch (noise) {
    case PhantomNoise::none:
      return;
    case PhantomNoise::gaussian:
      for_each_row(image, seed, [sd](RandomEngine& random, float* row, std::size_t width) {
        for (std::size_t i = 0; i < width; ++i) row[i] = static_cast<float>(row[i] + sd * random.normal());
      });
      return;
    case PhantomNoise::rician:
      for_each_row(image, seed, [sd](RandomEngine& random, float* row, std::size_t width) {
        for (std::size_t i = 0; i < width; ++i) {
          const double real = row[i] + sd * random.normal(), imaginary = sd * random.normal();
          row[i] = static_cast<float>(std::sqrt(real * real + imaginary * imaginary));
        }
      });
      return;
    case PhantomNoise::poisson: {
      const double gain = sd * sd / reference;  // intensity of one count: variance = gain * mean
      for_each_row(image, seed, [gain](RandomEngine& random, float* row, std::size_t width) {
        for (std::size_t i = 0; i < width; ++i) {
          row[i] = static_cast<float>(gain * static_cast<double>(random.poisson(row[i] / gain)));
        }
      });
      return;
    }
  }
}

}  // namespace pellicle
