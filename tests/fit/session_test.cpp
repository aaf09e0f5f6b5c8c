// A fit that is held: corrected by a point and run on.

#include "pellicle/fit/surface_fit.h"

#include <gtest/gtest.h>

#include <limits>

#include "fit_cases.h"
#include "pellicle/fit/refinement.h"
#include "pellicle/mesh/distance.h"

namespace pellicle {
namespace {

using test::small_phantom;

double distance_at(const Surface& surface, const Vec3& x) {
  return ClosestPoint(tessellate(surface, 4)).query(x).distance;
}

class Session : public testing::Test {
 protected:
  Session()
      : phantom_(make_phantom(small_phantom("blob"))),
        points_{.points = sample_surface(phantom_.truth_surface, 20)},
        fit_(phantom_.image, points_, options()),
        attempt_(fit_.propose(SeedSphere{phantom_.natural_center, 8.0}).front()) {
    fit_.try_out(attempt_);
    refine_by_prediction(fit_, attempt_);
  }
  static FitOptions options() {
    FitOptions options;
    options.polarity = Polarity::bright;
    options.boundary = Boundary::step;
    options.detail = 2;
    return options;
  }
  /// The last stage again, after `points` are given.
  Surface run_on(const ExpertPoints& points, bool continued) {
    fit_.set_points(points);
    Candidate candidate = attempt_.now;
    StageRequest request = attempt_.last;
    request.continued = continued;
    fit_.advance(candidate, request);
    EXPECT_EQ(candidate.status, FitStatus::ok);
    return candidate.surface;
  }

  Phantom phantom_;
  ExpertPoints points_;
  SurfaceFit fit_;
  Attempt attempt_;
};

TEST_F(Session, AMovedPointPullsTheSurfaceAfterIt) {
  ExpertPoints moved = points_;
  const Vec3 outward = (moved.points.front() - phantom_.natural_center).normalized();
  moved.points.front() += 1.5 * outward;
  moved.weights.assign(moved.points.size(), 1.0);
  moved.weights.front() = 50.0;
  const double before = distance_at(attempt_.now.surface, moved.points.front());
  const Surface after = run_on(moved, true);
  EXPECT_LT(distance_at(after, moved.points.front()), 0.7 * before);
}

TEST_F(Session, RunningOnEndsWhereTheWholeStageEnds) {
  ExpertPoints moved = points_;
  moved.points.front() += Vec3(0.5, 0.0, 0.0);
  const Surface whole = run_on(moved, false), quick = run_on(moved, true);
  EXPECT_LT(test::assd(quick, tessellate(whole, 4)), 0.03);
}

TEST_F(Session, TheSamePointsLeaveTheSurfaceWhereItIs) {
  EXPECT_LT(test::assd(run_on(points_, true), tessellate(attempt_.now.surface, 4)), 0.03);
}

TEST_F(Session, PointsThatBreakARuleAreRefusedAndTheOldOnesKept) {
  const Surface before = run_on(points_, true);
  EXPECT_THROW(fit_.set_points({.points = {Vec3::Constant(std::numeric_limits<double>::quiet_NaN())}}), SettingError);
  Candidate candidate = attempt_.now;
  StageRequest request = attempt_.last;
  request.continued = true;
  fit_.advance(candidate, request);
  EXPECT_EQ(candidate.surface.parameters, before.parameters);
}

TEST(SessionObserver, OneRunIsStoppedByItsHost) {
  const Phantom phantom = make_phantom(small_phantom());
  const Observer stop{.stopped = [] { return true; }};
  EXPECT_THROW(fit_surface({phantom.image, {SeedSphere{phantom.natural_center, 8.0}}}, {}, stop), Interrupted);
  EXPECT_NO_THROW(fit_surface({phantom.image, {SeedSphere{phantom.natural_center, 8.0}}}, {}));
}

}  // namespace
}  // namespace pellicle
