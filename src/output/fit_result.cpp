#include "pellicle/output/fit_result.h"

#include <fmt/format.h>

#include <algorithm>

namespace pellicle {

int GeometryFitResult::exit_code() const {
  const auto is_ok = [](const FittedSurface& fitted) { return fitted.status == SizeStatus::ok; };
  const std::vector<FittedSurface>& tried = fit.sizes.tried;
  const bool ok = settings.ladder.empty() ? is_ok(fit.sizes.best()) : std::all_of(tried.begin(), tried.end(), is_ok);
  return ok ? 0 : 3;
}

std::string heading_of_fits() {
  return fmt::format("{:>12} {:>6} {:>10} {:>8} {:>10} {:>8} {:>5} {:>6}  {:<16} {:>8}", "size", "points", "rms_mm",
                     "rms_%", "max_mm", "max_%", "genus", "cuts", "status", "seconds");
}

std::string line_of(const FittedSurface& fitted, double diameter) {
  const PointFitSummary& s = fitted.fit.summary;
  return fmt::format("{:>12} {:>6} {:>10.4g} {:>8.4f} {:>10.4g} {:>8.4f} {:>5} {:>6}  {:<16} {:>8.2f}", fitted.name,
                     s.control_points, s.to_surface.rms, 100.0 * s.to_surface.rms / diameter, s.to_surface.max,
                     100.0 * s.to_surface.max / diameter, s.genus, s.self_intersections, to_string(fitted.status),
                     s.seconds);
}

}  // namespace pellicle
