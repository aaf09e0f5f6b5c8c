#include "pellicle/surface/internal/gauss_legendre.h"

#include <cmath>
#include <numbers>

namespace pellicle {

Quadrature gauss_legendre(int n) {
  Quadrature result;
  for (int i = n; i >= 1; --i) {
    double x = std::cos(std::numbers::pi * (i - 0.25) / (n + 0.5)), slope = 1.0;
    for (int newton = 0; newton < 8; ++newton) {  // quadratic from within 1e-2: at rounding after five
      double p = 1.0, previous = 0.0;
      for (int k = 1; k <= n; ++k) {
        const double next = ((2.0 * k - 1.0) * x * p - (k - 1.0) * previous) / k;
        previous = p;
        p = next;
      }
      slope = n * (x * p - previous) / (x * x - 1.0);
      x -= p / slope;
    }
    result.at.push_back(0.5 * (1.0 + x));
    result.weight.push_back(1.0 / ((1.0 - x * x) * slope * slope));
  }
  return result;
}

}  // namespace pellicle
