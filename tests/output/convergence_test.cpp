#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "pellicle/output/convergence_picture.h"

namespace pellicle {
namespace {

TEST(Convergence, CurvesAreTheEnergiesAndBreakBetweenStages) {
  StageSummary first, none, second;
  first.name = "coarse";
  first.history = {{0.5, {{"edge", 4.0}, {"bending", 1.0}}}, {0.2, {{"edge", 2.0}, {"bending", 0.5}}}};
  second.name = "fine";
  second.history = {{0.1, {{"edge", 9.0}}}};
  FitSummary fit;
  fit.stages = {first, none, second};
  const LinePlot plot = convergence_of(fit, "it");
  ASSERT_EQ(plot.spans.size(), 2U);
  EXPECT_EQ(plot.spans[0].to, plot.spans[1].from);
  EXPECT_EQ(plot.spans[1].to - plot.spans[1].from, 1.0);
  ASSERT_EQ(plot.curves.size(), 3U);
  std::map<std::string, std::map<double, double>> drawn;
  for (const auto& curve : plot.curves) {
    double last_step = 0.0;
    for (const auto& p : curve.points) {
      if (std::isfinite(p.y())) drawn[curve.name][p.x()] = p.y();
      if (std::isfinite(p.y()) && p.x() == 3.0) {
        EXPECT_EQ(last_step, 2.5);  // a gap at the stage's start
      }
      last_step = p.x();
    }
  }
  EXPECT_EQ(drawn["edge"], (std::map<double, double>{{1, 4}, {2, 2}, {3, 9}}));
  EXPECT_EQ(drawn["bending"], (std::map<double, double>{{1, 1}, {2, 0.5}}));
  EXPECT_EQ(drawn["sum"], (std::map<double, double>{{1, 5}, {2, 2.5}, {3, 9}}));
}

}  // namespace
}  // namespace pellicle
