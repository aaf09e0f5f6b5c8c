#include <pellicle/fit/fit.h>
#include <pellicle/synthetic/phantom.h>
#include <iostream>

int main() {
  const pellicle::Phantom phantom = pellicle::make_phantom({.shape = "bean", .size = {64, 64, 64}, .radius = {16.0}});
  const auto fit = pellicle::fit_surface({phantom.image, {pellicle::SeedSphere{phantom.natural_center, 8.0}}}, {});
  std::cout << to_string(fit.summary.status) << ", " << fit.summary.stages.size() << " stages\n";
  return fit.summary.status == pellicle::FitStatus::ok ? 0 : 1;
}
