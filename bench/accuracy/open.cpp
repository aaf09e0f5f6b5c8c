// Open surfaces from scattered points whose rim is known: half of a blob, a cap with a wavy rim, a bent tube.

#include <fmt/format.h>

#include <cmath>
#include <cstdio>
#include <functional>
#include <numbers>

#include "pellicle/base/atomic_file.h"
#include "pellicle/base/random.h"
#include "pellicle/mesh/measure.h"
#include "pellicle/mesh/points/point_tree.h"
#include "pellicle/mesh/points/rim.h"
#include "pellicle/output/fit_files.h"
#include "sections.h"

namespace pellicle::bench {

namespace {

constexpr double kPi = std::numbers::pi;
constexpr int kAround = 400, kAlong = 200;

/// x(s, a) for s in [0, 1] along and a in [0, 2 pi) around; s = 1 is a rim, s = 0 another one or a pole.
struct OpenShape {
  const char* name;
  int points, rims;
  std::function<Vec3(double, double)> at;
};

Vec3 direction(double polar, double a) {
  return {std::sin(polar) * std::cos(a), std::sin(polar) * std::sin(a), std::cos(polar)};
}

std::vector<OpenShape> shapes() {
  const auto half_blob = [](double s, double a) -> Vec3 {
    const Vec3 n = direction(0.5 * kPi * s, a);
    return 10.0 * (1.0 + 0.2 * n.x() * n.y() + 0.15 * n.x() * n.x() + 0.1 * n.y() * n.z()) * n;
  };
  const auto wavy_cap = [](double s, double a) -> Vec3 {
    return 10.0 * direction(s * std::acos(0.25 * std::sin(3.0 * a)), a);
  };
  const auto tube = [](double s, double a) -> Vec3 {
    const double r = 12.0 + 4.0 * std::cos(a);
    return {r * std::cos(kPi * s), r * std::sin(kPi * s), 4.0 * std::sin(a)};
  };
  return {{"half blob", 1500, 1, half_blob}, {"wavy cap", 1500, 1, wavy_cap}, {"bent tube", 2000, 2, tube}};
}

std::vector<Vec3> rim_at(const OpenShape& shape, double s) {
  std::vector<Vec3> rim;
  for (int k = 0; k < 2000; ++k) rim.push_back(shape.at(s, 2.0 * kPi * k / 2000));
  return rim;
}

/// Points at random, evenly over the area: the largest piece of area accepts all.
std::vector<Vec3> strewn(const OpenShape& shape, double noise, RandomEngine& random) {
  const auto area = [&](double s, double a) {
    constexpr double kStep = 1e-5;
    return ((shape.at(s + kStep, a) - shape.at(s, a)) / kStep)
        .cross((shape.at(s, a + kStep) - shape.at(s, a)) / kStep)
        .norm();
  };
  double largest = 0.0;
  for (int i = 0; i < kAlong; ++i) {
    for (int j = 0; j < kAround; ++j) largest = std::max(largest, area((i + 0.5) / kAlong, 2.0 * kPi * j / kAround));
  }
  std::vector<Vec3> points;
  while (static_cast<int>(points.size()) < shape.points) {
    const double s = random.uniform(0.0, 1.0), a = random.uniform(0.0, 2.0 * kPi);
    if (random.uniform(0.0, largest) > area(s, a)) continue;
    points.push_back(shape.at(s, a) + noise * Vec3(random.normal(), random.normal(), random.normal()));
  }
  return points;
}

/// Sum of the angles by which a closed polyline turns, over 2 pi: 1 for a plane convex curve; waves add to it.
double turning_of(const std::vector<Vec3>& loop) {
  constexpr std::size_t kSides = 200;
  const std::vector<Vec3> corner = evenly_along(loop, kSides);
  double sum = 0.0;
  for (std::size_t k = 0; k < kSides; ++k) {
    const Vec3 before = corner[(k + 1) % kSides] - corner[k],
               after = corner[(k + 2) % kSides] - corner[(k + 1) % kSides];
    sum += std::atan2(before.cross(after).norm(), before.dot(after));
  }
  return sum / (2.0 * kPi);
}

}  // namespace

void open_table(const Options& options) {
  fmt::print(
      "\n## Open surfaces (rms, max: points to surface; rim: the border from the true rim, rms and max; % of the "
      "diameter; turning: sum of the border's angles over that of the true rim)\n\n"
      "| shape | noise % | draw | control points | rms | max | rim rms | rim max | turning | borders found / true | "
      "cuts "
      "| status | s |\n|---|---|---|---|---|---|---|---|---|---|---|---|---|\n");
  for (const OpenShape& shape : shapes()) {
    if (std::string(shape.name).find(options.only) != 0) continue;
    std::vector<Vec3> rim = rim_at(shape, 1.0);
    double true_turning = turning_of(rim);
    if (shape.rims == 2) {
      const std::vector<Vec3> other = rim_at(shape, 0.0);
      true_turning += turning_of(other);
      rim.insert(rim.end(), other.begin(), other.end());
    }
    const PointTree true_rim(rim);
    for (const double noise : {0.0, 0.002, 0.005}) {
      for (int draw = 0; draw < options.seeds; ++draw) {
        RandomEngine random(static_cast<std::uint64_t>(draw + 1));
        const double size = diameter_of(rim);
        std::string text;
        for (const Vec3& x : strewn(shape, noise * size, random)) {
          text += fmt::format("{:.9g} {:.9g} {:.9g}\n", x.x(), x.y(), x.z());
        }
        GeometryFitSettings settings;
        settings.model.kind = ModelKind::catmull_clark;
        settings.open = true;
        settings.input = (options.scratch / fmt::format("open-{}-{}.xyz", 1000.0 * noise, draw + 1)).string();
        settings.output = options.scratch;
        settings.overwrite = true;
        settings.write = {"report"};
        write_text_file(settings.input, text);
        const std::string row = fmt::format("| {} | {:.1f} | {} |", shape.name, 100.0 * noise, draw + 1);
        try {
          const GeometryFitResult result = fit_to_files(settings, {}, {});
          const FittedSurface& fitted = result.fit.sizes.best();
          const PointFitSummary& s = fitted.fit.summary;
          const double percent = 100.0 / result.input.data.diameter;
          double squares = 0.0, furthest = 0.0, count = 0.0, turning = 0.0;
          for (const std::vector<int>& border : border_loops(result.fit.mesh.triangles)) {
            std::vector<Vec3> loop;
            for (const int v : border) loop.push_back(result.fit.mesh.vertices[static_cast<std::size_t>(v)]);
            turning += turning_of(loop);
            for (const Vec3& x : loop) {
              const double d = true_rim.nearest(x, 1).front().distance;
              squares += d * d;
              furthest = std::max(furthest, d);
              count += 1.0;
            }
          }
          fmt::print("{} {} | {:.3f} | {:.2f} | {:.2f} | {:.2f} | {:.3f} | {} / {} | {} | {} | {:.1f} |\n", row,
                     s.control_points, percent * s.to_surface.rms, percent * s.to_surface.max,
                     percent * std::sqrt(squares / count), percent * furthest, turning / true_turning, s.border_loops,
                     shape.rims, s.self_intersections, to_string(fitted.status), s.seconds);
        } catch (const std::exception& fault) {
          fmt::print("{} fails: {} | | | | | | | | | |\n", row, fault.what());
        }
        std::fflush(stdout);
      }
    }
  }
}

}  // namespace pellicle::bench
