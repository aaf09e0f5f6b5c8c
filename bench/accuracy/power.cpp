// Fitting power: how well a spline sphere of so many control points can follow a shape at all, without any image.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "pellicle/fit/geometry/point_fit.h"
#include "pellicle/mesh/sphere/sphere_map.h"
#include "pellicle/surface/icosphere.h"
#include "sections.h"

namespace pellicle::bench {

namespace {

/// A star-shaped solid about the origin: f < 0 inside.
struct Target {
  std::string name;
  double diameter = 1.0;
  std::function<double(const Vec3&)> f;
};

double zonal(int degree, double t) {
  if (degree == 2) return 1.5 * t * t - 0.5;
  if (degree == 3) return 2.5 * t * t * t - 1.5 * t;
  return (35.0 * t * t * t * t - 30.0 * t * t + 3.0) / 8.0;
}

double blob_radius(const Vec3& direction) {
  struct Term {
    int degree;
    Vec3 axis;
    double weight;
  };
  // One draw of random zonal harmonics up to degree 4: radius 0.57 to 1.33.
  static const std::vector<Term> terms{
      {2, {0.27298068055600483, -0.75481445484455556, -0.59643665782788458}, -0.29297608591678265},
      {2, {0.83423896576176815, 0.53036830482140329, -0.15084697294147595}, 0.092856790407319367},
      {2, {0.24279883932747676, -0.4781736837139563, 0.8440371151937901}, -0.037266785599098302},
      {3, {-0.33868636122765367, -0.81590571372665632, 0.46860368652686346}, -0.011903766206086554},
      {3, {0.66024120513230267, -0.73518671477153585, 0.15356446681729788}, -0.10707288521157483},
      {3, {0.91125201225825159, 0.20362980874138309, 0.35798697063892565}, 0.049260469556431541},
      {4, {-0.41736100119299996, 0.32339033310802667, 0.84925172189136977}, -0.13762917027178409},
      {4, {-0.70819050736133493, -0.61622542854496543, 0.34457571954197352}, 0.01081211522782175},
      {4, {0.82006920123001192, 0.54940182822716299, 0.16013786664815183}, 0.023859204201031149}};
  double r = 1.0;
  for (const Term& term : terms) r += term.weight * zonal(term.degree, direction.dot(term.axis));
  return r;
}

std::vector<Target> targets() {
  return {{"ellipsoid", 4.0, [](const Vec3& x) { return Vec3(x[0], x[1] / 1.5, x[2] / 2.0).norm() - 1.0; }},
          {"bean", 3.05,
           [](const Vec3& p) {  // a Cassini peanut, bent
             const double x = p[0], y = p[1] - 0.25 * x * x + 0.2, z = p[2];
             const double a = (x - 1) * (x - 1) + y * y + z * z, b = (x + 1) * (x + 1) + y * y + z * z;
             return std::pow(a * b, 0.25) - 1.15;
           }},
          {"blob", 2.6, [](const Vec3& x) { return x.norm() - blob_radius(x.normalized()); }}};
}

TriangleMesh mesh_of(const Target& target, int level) {
  const Icosphere sphere = icosphere(level);
  TriangleMesh mesh;
  mesh.triangles = sphere.triangles;
  for (const Vec3& d : sphere.directions) {
    double low = 1e-3, high = 4.0;
    for (int i = 0; i < 60; ++i) {
      const double middle = 0.5 * (low + high);
      (target.f(middle * d) < 0.0 ? low : high) = middle;
    }
    mesh.vertices.push_back(low * d);
  }
  return mesh;
}

struct Size {
  int m1, m2;
  double reference[3];  ///< rms in % of the diameter, of an independent implementation, best of several starts; -1: not
                        ///< known
};

}  // namespace

void power_table(const Options&) {
  constexpr double kInf = 1e300;
  const std::vector<Size> sizes{
      {4, 2, {0.003, 1.396, 0.775}}, {4, 4, {0.001, 1.458, 0.532}},  {6, 3, {0.001, 0.489, 0.363}},
      {6, 4, {0.001, 0.357, 0.240}}, {8, 4, {0.001, 0.144, 0.166}},  {8, 6, {0.000, 0.120, 0.087}},
      {8, 8, {0.000, 0.111, 0.043}}, {12, 8, {0.000, 0.040, 0.032}}, {12, 12, {-1.0, -1.0, -1.0}}};
  fmt::print(
      "\n## Fitting power of the spline sphere\n\nRms distance (both ways) in % of the diameter; beside it that of an "
      "independent implementation (best of several starts).\n\n| control net | control points | degrees of freedom | "
      "ellipsoid 1:1.5:2 | bean | blob |\n|---|---|---|---|---|---|\n");
  const std::vector<Target> shapes = targets();
  for (const Size& size : sizes) {
    std::string cells;
    const SplineModel model({.topology = SplineTopology::sphere, .m1 = size.m1, .m2 = size.m2});
    for (std::size_t t = 0; t < shapes.size(); ++t) {
      GeometryData data;
      data.surface = mesh_of(shapes[t], 5);
      data.points = data.surface->vertices;
      data.diameter = shapes[t].diameter;
      data.robust = false;
      const PointFitSettings settings{.max_steps = 60, .smoothness = 1e-3, .improvement = 1e-3};
      double best = kInf;
      const auto keep_best = [&](PointFit fit) {
        measure_fit(data, fit);
        const double a = fit.summary.to_surface.rms, b = fit.summary.to_data.rms;
        best = std::min(best, 100.0 * std::sqrt(0.5 * (a * a + b * b)) / data.diameter);
      };
      // As `pellicle fit` does it: laid out over the mesh, the poles where this model follows it best.
      keep_best(fit_to_map(model, data, choose_axis(map_to_sphere(*data.surface), model), settings, false));
      // Small nets have many minima: from balls with the poles along each axis, too.
      for (int axis = 0; axis < 3 && control_point_count(model) < 30; ++axis) {
        Mat3 turn;
        turn << Vec3::Unit((axis + 1) % 3), Vec3::Unit((axis + 2) % 3), Vec3::Unit(axis);
        keep_best(
            fit_from({model, affine_image(model, Vec3::Zero(), 0.35 * data.diameter * turn)}, data, settings, false));
      }
      const std::string beside = size.reference[t] < 0.0 ? "-" : fmt::format("{:.3f}", size.reference[t]);
      cells += fmt::format(" {:.3f} ({}) |", best, beside);
    }
    fmt::print("| {}x{} | {} | {} |{}\n", size.m1, size.m2, control_point_count(model), model.degrees_of_freedom(),
               cells);
    std::fflush(stdout);
  }
}

}  // namespace pellicle::bench
