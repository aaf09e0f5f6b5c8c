#pragma once
/// Gauss-Legendre quadrature on [0, 1].

#include <vector>

namespace pellicle {

struct Quadrature {
  std::vector<double> at, weight;
};

/// Exact for polynomials of degree 2 n - 1; nodes ascending.
/// \param n 1 and above.
Quadrature gauss_legendre(int n);

}  // namespace pellicle
