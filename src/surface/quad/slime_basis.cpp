#include "pellicle/surface/quad/slime_basis.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <map>
#include <numbers>

#include "pellicle/base/errors.h"
#include "pellicle/surface/internal/gauss_legendre.h"

namespace pellicle {
namespace {

using Row = Eigen::RowVectorXd;
using Label = std::vector<int>;
using Net = std::map<Label, Row>;  ///< Bezier points of an S-patch as combinations of the Sabin net

constexpr int kDepth = 5;

double binomial(int n, int k) {
  double result = 1;
  for (int i = 0; i < k; ++i) result = result * (n - i) / (i + 1);
  return result;
}

void append_labels(Label& label, std::size_t at, int left, std::vector<Label>& out) {
  if (at + 1 == label.size()) {
    label[at] = left;
    out.push_back(label);
    return;
  }
  for (int i = left; i >= 0; --i) {
    label[at] = i;
    append_labels(label, at + 1, left - i, out);
  }
}

std::vector<Label> labels_of(int n, int depth) {
  std::vector<Label> result;
  Label label(static_cast<std::size_t>(n), 0);
  append_labels(label, 0, depth, result);
  return result;
}

Eigen::Vector2d polygon_corner(int n, int i) {
  const double radius = 0.5 / std::sin(std::numbers::pi / n), angle = 2 * std::numbers::pi * i / n;
  return {radius * std::cos(angle), radius * std::sin(angle)};
}

/// The Sabin net itself: unit rows, indices cyclic.
struct Sabin {
  int n;
  Row unit(int k) const { return Row::Unit(2 * n + 1, k); }
  Row v() const { return unit(0); }
  Row e(int i) const { return unit(1 + (i + n) % n); }
  Row f(int i) const { return unit(1 + n + (i + n) % n); }
};

/// Depth 2: corners f_i, sides e_{i+1}, v for every pair that is not adjacent.
Net biquadratic(const Sabin& sabin) {
  const int n = sabin.n;
  Net net;
  for (const Label& label : labels_of(n, 2)) {
    std::vector<int> used;
    for (int i = 0; i < n; ++i) {
      if (label[static_cast<std::size_t>(i)] > 0) used.push_back(i);
    }
    if (used.size() == 1) {
      net[label] = sabin.f(used[0]);
    } else if (used[0] + 1 == used[1]) {
      net[label] = sabin.e(used[1]);
    } else {
      net[label] = used[0] == 0 && used[1] == n - 1 ? sabin.e(0) : sabin.v();
    }
  }
  return net;
}

Net elevated(const Net& net, int n, int depth) {
  Net result;
  for (Label& label : labels_of(n, depth + 1)) {
    Row sum = Row::Zero(2 * n + 1);
    for (int i = 0; i < n; ++i) {
      int& exponent = label[static_cast<std::size_t>(i)];
      if (exponent == 0) continue;
      const double part = exponent / (depth + 1.0);
      --exponent;
      sum += part * net.at(label);
      ++exponent;
    }
    result.emplace(label, sum);
  }
  return result;
}

/// Degree 5 form of a quadratic curve.
std::array<Row, kDepth + 1> elevated_curve(const std::array<Row, 3>& curve) {
  std::vector<Row> points(curve.begin(), curve.end());
  for (int degree = 2; degree < kDepth; ++degree) {
    std::vector<Row> next(points.size() + 1);
    for (int i = 0; i <= degree + 1; ++i) {
      const double part = i / (degree + 1.0);
      const auto at = static_cast<std::size_t>(i);
      next[at] = Row::Zero(curve[0].size());
      if (i > 0) next[at] += part * points[at - 1];
      if (i <= degree) next[at] += (1 - part) * points[at];
    }
    points = std::move(next);
  }
  std::array<Row, kDepth + 1> result;
  std::move(points.begin(), points.end(), result.begin());
  return result;
}

/// Bezier points of leg(t) = 2/5 [c t C'(t) + (1 + 2 c t (1 - t)) (R(t) - C(t))], c = -cos(2 pi/n), degree 4.
std::array<Row, kDepth> legs_of(int n, const std::array<Row, 3>& curve, const std::array<Row, 3>& inner) {
  const double c = -std::cos(2 * std::numbers::pi / n);
  std::array<Row, kDepth> leg;
  leg.fill(Row::Zero(curve[0].size()));
  for (int j = 0; j < 2; ++j) {  // 2 c t C'/2, the factor t raised to degree 3
    const Row step = curve[static_cast<std::size_t>(j) + 1] - curve[static_cast<std::size_t>(j)];
    const std::array<double, 3> raise{1, 2, 1};
    for (int r = 0; r < 3; ++r) {
      leg[static_cast<std::size_t>(j + 1 + r)] += 2 * c * raise[static_cast<std::size_t>(r)] * binomial(1, j) * step;
    }
  }
  for (int j = 0; j < 3; ++j) {
    const Row across = inner[static_cast<std::size_t>(j)] - curve[static_cast<std::size_t>(j)];
    const std::array<double, 3> weight{1, 2 + 2 * c, 1};
    for (int r = 0; r < 3; ++r) {
      leg[static_cast<std::size_t>(j + r)] += weight[static_cast<std::size_t>(r)] * binomial(2, j) * across;
    }
  }
  for (int k = 0; k < kDepth; ++k) leg[static_cast<std::size_t>(k)] *= 0.4 / binomial(4, k);
  return leg;
}

/// The panels along side a: each is an affine image of the domain.
void set_panels(const Sabin& sabin, int a, Net& net) {
  const int n = sabin.n, b = (a + 1) % n;
  const std::array<Row, 3> curve{sabin.f(a), sabin.e(b), sabin.f(b)};
  const std::array<Row, 3> inner{sabin.e(a), sabin.v(), sabin.e(b + 1)};
  const auto border = elevated_curve(curve);
  const auto leg = legs_of(n, curve, inner);
  Eigen::Matrix2d frame;
  frame << polygon_corner(n, b) - polygon_corner(n, a), polygon_corner(n, a - 1) - polygon_corner(n, a);
  const Eigen::Matrix2d into_frame = frame.inverse();
  for (int j = 0; j < kDepth; ++j) {
    for (int k = 0; k < n; ++k) {
      const Eigen::Vector2d at = into_frame * (polygon_corner(n, k) - polygon_corner(n, a));
      Label label(static_cast<std::size_t>(n), 0);
      label[static_cast<std::size_t>(a)] += kDepth - 1 - j;
      label[static_cast<std::size_t>(b)] += j;
      label[static_cast<std::size_t>(k)] += 1;
      const auto i = static_cast<std::size_t>(j);
      net[label] = border[i] + at.x() * (border[i + 1] - border[i]) + at.y() * leg[i];
    }
  }
}

/// Coordinates l_i of a domain point (they sum to one) with first and second derivatives.
struct Coordinates {
  Eigen::VectorXd l;
  Eigen::MatrixX2d first;
  Eigen::MatrixX3d second;  ///< uu, uv, vv
};

Coordinates coordinates_of(int n, const Eigen::Vector2d& point) {
  Eigen::VectorXd distance(n);
  Eigen::MatrixX2d normal(n, 2);
  const double scale = 0.5 / std::tan(std::numbers::pi / n);  // inner radius: numbers of order one
  for (int j = 0; j < n; ++j) {
    const Eigen::Vector2d from = polygon_corner(n, j), along = polygon_corner(n, j + 1) - from;
    normal.row(j) << -along.y() / scale, along.x() / scale;
    distance[j] = normal.row(j).dot(point - from);
  }
  Eigen::VectorXd product(n);
  Eigen::MatrixX2d first = Eigen::MatrixX2d::Zero(n, 2);
  Eigen::MatrixX3d second = Eigen::MatrixX3d::Zero(n, 3);
  const auto product_without = [&](int i, int j, int k) {
    double result = 1;
    for (int m = 0; m < n; ++m) {
      if (m != i && (m + 1) % n != i && m != j && m != k) result *= distance[m];
    }
    return result;
  };
  for (int i = 0; i < n; ++i) {
    product[i] = product_without(i, -1, -1);
    for (int j = 0; j < n; ++j) {
      if (j == i || (j + 1) % n == i) continue;
      first.row(i) += product_without(i, j, -1) * normal.row(j);
      for (int k = 0; k < n; ++k) {
        if (k == i || (k + 1) % n == i || k == j) continue;
        const double w = product_without(i, j, k);
        second.row(i) += w * Eigen::RowVector3d(normal(j, 0) * normal(k, 0), normal(j, 0) * normal(k, 1),
                                                normal(j, 1) * normal(k, 1));
      }
    }
  }
  const double sum = product.sum();
  const Eigen::RowVector2d sum_first = first.colwise().sum();
  const Eigen::RowVector3d sum_second = second.colwise().sum();
  Coordinates result{product / sum, Eigen::MatrixX2d(n, 2), Eigen::MatrixX3d(n, 3)};
  for (int i = 0; i < n; ++i) {
    const double l = result.l[i];
    const Eigen::RowVector2d d = (first.row(i) - l * sum_first) / sum;
    const Eigen::RowVector3d mixed(2 * d[0] * sum_first[0], d[0] * sum_first[1] + d[1] * sum_first[0],
                                   2 * d[1] * sum_first[1]);
    result.first.row(i) = d;
    result.second.row(i) = (second.row(i) - mixed - l * sum_second) / sum;
  }
  return result;
}

/// Value and derivatives of prod l_i^s_i.
void add_monomial(const Label& label, const Coordinates& c, double factor, Eigen::Index at, std::array<Row, 6>& basis) {
  std::array<Eigen::Index, kDepth> used{};
  std::size_t count = 0;
  for (std::size_t i = 0; i < label.size(); ++i) {
    if (label[i] > 0) used[count++] = static_cast<Eigen::Index>(i);
  }
  const auto exponent = [&](std::size_t k) { return label[static_cast<std::size_t>(used[k])]; };
  const auto power = [&](std::size_t k, int lower) {
    double result = 1;
    for (int p = lower; p < exponent(k); ++p) result *= c.l[used[k]];
    return result;
  };
  const auto rest = [&](std::size_t a, std::size_t b) {
    double result = factor;
    for (std::size_t k = 0; k < count; ++k) {
      if (k != a && k != b) result *= power(k, 0);
    }
    return result;
  };
  basis[0][at] = rest(kDepth, kDepth);
  for (std::size_t a = 0; a < count; ++a) {
    const double slope = rest(a, a) * exponent(a) * power(a, 1);
    const auto i = used[a];
    basis[1][at] += slope * c.first(i, 0);
    basis[2][at] += slope * c.first(i, 1);
    for (Eigen::Index k = 0; k < 3; ++k) basis[static_cast<std::size_t>(3 + k)][at] += slope * c.second(i, k);
    for (std::size_t b = 0; b < count; ++b) {
      const auto j = used[b];
      const double bend = a == b ? rest(a, a) * exponent(a) * (exponent(a) - 1) * power(a, 2)
                                 : rest(a, b) * exponent(a) * power(a, 1) * exponent(b) * power(b, 1);
      basis[3][at] += bend * c.first(i, 0) * c.first(j, 0);
      basis[4][at] += bend * c.first(i, 0) * c.first(j, 1);
      basis[5][at] += bend * c.first(i, 1) * c.first(j, 1);
    }
  }
}

/// The permutation of the net that a turn of the polygon by `turns` corners makes.
Eigen::Index turned(Eigen::Index point, int turns, int n) {
  if (point == 0) return 0;
  const Eigen::Index first = point <= n ? 1 : 1 + n;
  return first + (point - first + turns) % n;
}

}  // namespace

SlimeBasis::SlimeBasis(int valence) : valence_(valence) {
  if (valence < 3 || valence > highest_valence) {
    throw BadData(fmt::format("slime patch (valence {}): only valences 3 to {} have one", valence, highest_valence));
  }
  const Sabin sabin{valence};
  Net net = biquadratic(sabin);
  for (int depth = 2; depth < kDepth; ++depth) net = elevated(net, valence, depth);
  for (int side = 0; side < valence; ++side) set_panels(sabin, side, net);
  control_.resize(static_cast<Eigen::Index>(net.size()), 2 * valence + 1);
  labels_.reserve(net.size());
  multinomial_.reserve(net.size());
  for (const auto& [label, point] : net) {
    double ways = 120;  // 5!
    for (const int s : label) ways /= std::tgamma(s + 1.0);
    control_.row(static_cast<Eigen::Index>(labels_.size())) = point;
    labels_.push_back(label);
    multinomial_.push_back(ways);
  }
}

Eigen::Vector2d SlimeBasis::corner(int i) const {
  return polygon_corner(valence_, i);
}

SlimeWeights SlimeBasis::at(const std::vector<Eigen::Vector2d>& points, bool second_derivatives) const {
  const auto count = static_cast<Eigen::Index>(points.size());
  const Eigen::Index net = control_.cols(), labels = control_.rows();
  SlimeWeights result;
  std::array<Eigen::MatrixXd*, 6> out{&result.x, &result.u, &result.v, &result.uu, &result.uv, &result.vv};
  const std::size_t wanted = second_derivatives ? 6 : 3;
  for (std::size_t k = 0; k < wanted; ++k) out[k]->resize(count, net);
  std::array<Row, 6> basis;
  for (Eigen::Index p = 0; p < count; ++p) {
    const Coordinates c = coordinates_of(valence_, points[static_cast<std::size_t>(p)]);
    for (Row& row : basis) row.setZero(labels);
    for (Eigen::Index at = 0; at < labels; ++at) {
      const auto i = static_cast<std::size_t>(at);
      add_monomial(labels_[i], c, multinomial_[i], at, basis);
    }
    for (std::size_t k = 0; k < wanted; ++k) out[k]->row(p) = basis[k] * control_;
  }
  return result;
}

Eigen::MatrixXd SlimeBasis::stiffness() const {
  const int n = valence_;
  // The coordinates are rational: more points the closer their poles come to the polygon.
  const Quadrature gauss = gauss_legendre(n <= 4 ? 16 : 4 * n + 6);
  const Eigen::Vector2d a = corner(0), b = corner(1);
  const double twice_area = a.x() * b.y() - a.y() * b.x();
  std::vector<Eigen::Vector2d> points;
  std::vector<double> weights;
  points.reserve(gauss.at.size() * gauss.at.size());
  weights.reserve(points.capacity());
  for (std::size_t i = 0; i < gauss.at.size(); ++i) {
    for (std::size_t j = 0; j < gauss.at.size(); ++j) {
      const double r = gauss.at[i], s = gauss.at[j];
      points.emplace_back(r * ((1 - s) * a + s * b));
      weights.push_back(gauss.weight[i] * gauss.weight[j] * r * twice_area);
    }
  }
  const SlimeWeights w = at(points, true);
  const Eigen::Map<const Eigen::VectorXd> weight(weights.data(), static_cast<Eigen::Index>(weights.size()));
  const Eigen::MatrixXd sector = w.uu.transpose() * weight.asDiagonal() * w.uu +
                                 2 * w.uv.transpose() * weight.asDiagonal() * w.uv +
                                 w.vv.transpose() * weight.asDiagonal() * w.vv;
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(sector.rows(), sector.cols());
  for (int turns = 0; turns < n; ++turns) {
    for (Eigen::Index i = 0; i < sector.rows(); ++i) {
      for (Eigen::Index j = 0; j < sector.cols(); ++j) sum(turned(i, turns, n), turned(j, turns, n)) += sector(i, j);
    }
  }
  return sum;
}

}  // namespace pellicle
