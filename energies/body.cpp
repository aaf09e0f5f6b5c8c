#include "pellicle/energies/body.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <span>
#include <utility>

namespace pellicle {

namespace {

constexpr int kSide = 10;  // profile points on each side
constexpr int kPoints = 2 * kSide + 1;
constexpr std::array<double, 4> kDepths{0.25, 0.45, 0.65, 0.8};  // of the way from the centroid
constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

/// One profile, cut where the territory or the image ends.
struct Profile {
  std::array<float, kPoints> value{};
  int first = 0, end = 0;  ///< known points
  bool limited_by_territory = false;
};

// Lower quartile of the known points from `from` on; NaN when there are none.
double lower_quartile(const Profile& p, int from) {
  std::array<float, kPoints> v{};
  int n = 0;
  for (int k = std::max(from, p.first); k < p.end; ++k)
    v[static_cast<std::size_t>(n++)] = p.value[static_cast<std::size_t>(k)];
  if (n == 0) return kUnknown;
  std::sort(v.begin(), v.begin() + n);
  const double position = 0.25 * (n - 1);
  const auto low = static_cast<std::size_t>(position);
  const double below = static_cast<double>(v[low]), part = position - static_cast<double>(low);
  return part > 0.0 ? below + part * (static_cast<double>(v[low + 1]) - below) : below;
}

double mean_between(const Profile& p, int from, int to) {
  double sum = 0.0;
  int n = 0;
  for (int k = std::max(from, p.first); k <= std::min(to, p.end - 1); ++k, ++n)
    sum += static_cast<double>(p.value[static_cast<std::size_t>(k)]);
  return n > 0 ? sum / n : kUnknown;
}

// Where the score is highest, in steps from the surface; refined by the parabola through the neighbours, which is exact
// where the profile is linear.
double best_cut(const Profile& p, double a, double b, double pull) {
  const double middle = 0.5 * (a + b), scale = 1.0 / ((a - b) * kSide);
  std::array<double, kPoints> score{};
  double sum = 0.0;
  const auto excess = [&](int k) {
    return (static_cast<double>(p.value[static_cast<std::size_t>(k)]) - middle) * scale;
  };
  int best = -1;
  for (int k = p.first; k < p.end; ++k) {
    if (k > p.first) sum += 0.5 * (excess(k - 1) + excess(k));
    const double t = static_cast<double>(k - kSide) / kSide;
    score[static_cast<std::size_t>(k)] = sum - pull * t * t;
    if (best < 0 || score[static_cast<std::size_t>(k)] > score[static_cast<std::size_t>(best)]) best = k;
  }
  if (best < 0) return 0.0;
  double cut = best - kSide;
  if (best > p.first && best + 1 < p.end) {
    const auto k = static_cast<std::size_t>(best);
    const double bend = score[k - 1] - 2.0 * score[k] + score[k + 1];
    if (bend < 0.0) cut += std::clamp(0.5 * (score[k - 1] - score[k + 1]) / bend, -0.5, 0.5);
  }
  return cut;
}

Vec3 centroid_of(std::span<const Vec3> x, std::span<const double> area) {
  Vec3 sum = Vec3::Zero();
  double total = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    sum += area[i] * x[i];
    total += area[i];
  }
  return sum / total;
}

double rms_distance(std::span<const Vec3> x, std::span<const double> area, const Vec3& centre) {
  double sum = 0.0, total = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    sum += area[i] * (x[i] - centre).squaredNorm();
    total += area[i];
  }
  return std::sqrt(sum / total);
}

class Reader {
 public:
  Reader(const TrilinearField& image, const BodySearch& search, double radius)
      : image_(image), search_(search), radius_(radius), step_(search.half_width * radius / kSide) {
    if (search.territory != nullptr) territory_.emplace(*search.territory);
  }
  double step() const { return step_; }

  Profile profile(const Vec3& x, const Vec3& normal) const {
    Profile p;
    image_.along_line(x - kSide * step_ * normal, step_ * normal, kPoints, p.value.data());
    if (search_.sign < 0.0) {
      for (float& v : p.value) v = -v;
    }
    const auto known = [&](int k) { return !std::isnan(p.value[static_cast<std::size_t>(k)]); };
    if (!known(kSide)) return p;  // the sample itself lies outside the image
    p.first = kSide;
    while (p.first > 0 && known(p.first - 1)) --p.first;
    p.end = kSide + 1;
    while (p.end < kPoints && known(p.end)) ++p.end;
    if (!territory_) return p;
    // What lies well inside is the object's whatever the territory says there.
    const int from = std::max(p.first, kSide - static_cast<int>(0.3 * radius_ / step_));
    std::array<float, kPoints> own{};
    territory_->along_line(x + (from - kSide) * step_ * normal, step_ * normal, p.end - from, own.data());
    for (int k = from; k < p.end; ++k) {
      if (own[static_cast<std::size_t>(k - from)] < 0.5F) {
        p.end = std::max(k, p.first + 1);
        p.limited_by_territory = true;
        break;
      }
    }
    return p;
  }

 private:
  const TrilinearField& image_;
  const BodySearch& search_;
  double radius_, step_;
  std::optional<TrilinearField> territory_;
};

/// Tails of one profile on both sides of its cut, in steps times the contrast; none where too little is known.
std::optional<double> tails_of(const Profile& p, double cut, double a, double b, int width) {
  const int at = kSide + static_cast<int>(std::lround(cut));
  if (at - width < p.first || at + width >= p.end) return std::nullopt;
  double sum = 0.0;
  for (int k = at - width; k <= at + width; ++k) {
    const double value = (static_cast<double>(p.value[static_cast<std::size_t>(k)]) - b) / (a - b);
    const double beyond = k - kSide - cut;
    // The step lies between two points: taking it linearly between them keeps the sum free of jumps.
    const double step = std::clamp(0.5 - beyond, 0.0, 1.0);
    sum += beyond < 0.0 ? step - value : value - step;
  }
  return sum;
}

/// Levels on the ways from the centroid to the samples: all of them, and the mean of each sample's outer two.
struct Inside {
  double median = 0.0;
  std::vector<double> own;
};

Inside inside_of(const TrilinearField& image, std::span<const Vec3> x, const Vec3& centroid, double sign) {
  Inside inside{0.0, std::vector<double>(x.size())};
  std::vector<double> all;
  all.reserve(kDepths.size() * x.size());
  for (std::size_t i = 0; i < x.size(); ++i) {
    std::array<double, kDepths.size()> here{};
    for (std::size_t d = 0; d < kDepths.size(); ++d) {
      here[d] = sign * static_cast<double>(image.at(centroid + kDepths[d] * (x[i] - centroid)));
      all.push_back(here[d]);
    }
    inside.own[i] = std::isnan(here[3]) ? here[2] : 0.5 * (here[2] + here[3]);
  }
  inside.median = median_of(std::move(all));
  return inside;
}

}  // namespace

BodyReading read_body(const TrilinearField& image, const SampleView& surface, const BodySearch& search) {
  const std::span<const Vec3> x = surface.x, normal = surface.normal;
  const std::span<const double> area = surface.area;
  const std::size_t n = x.size();
  BodyReading r{.targets = {std::vector<double>(n, 0.0), std::vector<double>(n, 0.0)},
                .drop = std::vector<double>(n, 0.0),
                .support = std::vector<double>(n, 0.0),
                .limited = std::vector<std::uint8_t>(n, 0),
                .outside = std::vector<std::uint8_t>(n, 0),
                .reach = std::vector<double>(n, 0.0)};
  r.centroid = centroid_of(x, area);
  r.radius = std::max(search.least_radius, rms_distance(x, area, r.centroid));
  const Reader reader(image, search, r.radius);
  const Inside inside = inside_of(image, x, r.centroid, search.sign);
  std::vector<Profile> profiles(n);
  std::vector<double> ground(n), cuts(n, 0.0);
  const int clear = kSide + static_cast<int>(std::ceil(0.15 * r.radius / reader.step()));
  for (std::size_t i = 0; i < n; ++i) {
    profiles[i] = reader.profile(x[i], normal[i]);
    ground[i] = lower_quartile(profiles[i], clear);
  }
  const double a_all = inside.median, b_all = median_of(ground);
  r.inside = search.sign * a_all;
  r.beyond = search.sign * b_all;
  std::vector<double> tails;
  const int quarter = std::max(1, static_cast<int>(std::lround(0.25 * r.radius / reader.step())));
  for (std::size_t i = 0; i < n; ++i) {
    const Profile& p = profiles[i];
    r.reach[i] = (x[i] - r.centroid).norm();
    r.outside[i] = p.end == 0 ? 1 : 0;
    if (p.end == 0 || std::isnan(a_all)) continue;
    const double own = std::isnan(inside.own[i]) ? a_all : inside.own[i];
    const double a = 0.5 * (a_all + own);
    const double far = std::isnan(b_all) ? static_cast<double>(p.value[static_cast<std::size_t>(p.end - 1)]) : b_all;
    const double b = std::isnan(ground[i]) ? far : 0.5 * (ground[i] + far);
    // Where there is no contrast nothing is known, and nothing pulls.
    double cut = 0.0;
    if (a - b > 1e-12 * std::abs(a)) {
      cut = best_cut(p, a, b, search.pull);
      const int at = kSide + static_cast<int>(std::lround(cut));
      const double in = mean_between(p, at - quarter, at - 1), out = mean_between(p, at + 1, at + quarter);
      r.drop[i] = std::isnan(in) || std::isnan(out) ? 0.0 : in - out;
      r.support[i] = a_all > b ? std::clamp(r.drop[i] / (a_all - b), 0.0, 1.0) : 0.0;
      if (const auto t = tails_of(p, cut, a, b, quarter)) tails.push_back(*t);
      r.limited[i] = p.limited_by_territory && p.end <= at + quarter ? 1 : 0;
    }
    cuts[i] = cut * reader.step();
  }
  if (!tails.empty()) {
    const double s = median_of(tails) * reader.step() * std::sqrt(0.5 * std::numbers::pi);
    r.blur = std::clamp(s, 0.0, 0.25 * r.radius);
  }
  const double outward = search.unblur ? r.blur * r.blur / r.radius : 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    if (r.outside[i] != 0 || std::isnan(a_all)) continue;
    const double cap = search.cap != nullptr      ? (*search.cap)[i]
                       : search.most_radius > 0.0 ? search.most_radius
                                                  : std::numeric_limits<double>::infinity();
    const double low = -search.inward * r.reach[i];
    r.targets.offset[i] = std::clamp(cuts[i] + (r.limited[i] != 0 ? 0.0 : outward), low,
                                     std::max(low, std::min(search.outward * r.radius, cap - r.reach[i])));
    r.targets.weight[i] = r.limited[i] != 0 ? 0.5 : 0.15 + 0.85 * r.support[i];
  }
  return r;
}

TermOutput BodyTerm::operator()(const StepView& step) const {
  const OneOfMany& kin = step.one_of_many;
  const double done = step.steps > 1 ? static_cast<double>(step.step) / (step.steps - 1) : 1.0;
  std::vector<double> cap;
  BodySearch search{.sign = step.hypothesis.sign,
                    .half_width = 0.6 + done * (0.35 - 0.6),
                    .least_radius = 0.3 * kin.radius,
                    .most_radius = 2.2 * kin.radius,
                    .unblur = true,
                    .territory = kin.territory};
  const bool typical = kin.typical != nullptr && kin.typical->size() == step.surface.size();
  if (typical) {
    for (const double r : *kin.typical) cap.push_back(1.6 * r);
    search.cap = &cap;
  }
  const BodyReading reading = read_body(TrilinearField(*step.image), step.surface, search);
  TermOutput out;
  out.found.levels = step.levels;
  out.found.levels->inside = reading.inside;
  out.found.levels->outside = reading.beyond;
  ScalarRows rows = offset_rows(step.surface, reading.targets, step.weight);
  if (typical) {
    NormalTargets shape{std::vector<double>(step.surface.size()), std::vector<double>(step.surface.size(), 0.05)};
    for (std::size_t i = 0; i < shape.offset.size(); ++i) shape.offset[i] = (*kin.typical)[i] - reading.reach[i];
    const ScalarRows more = offset_rows(step.surface, shape, step.weight);
    for (std::size_t row = 0; row < more.size(); ++row) {
      rows.add(more.sample[row], more.coefficient[row]);
      rows.close(more.target[row]);
    }
  }
  out.pull = std::move(rows);
  return out;
}

}  // namespace pellicle
