#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <utility>

#include "pellicle/base/errors.h"
#include "pellicle/settings/settings.h"

namespace pellicle {

namespace {

template <class E>
using Names = std::vector<std::pair<E, std::string>>;

template <class E>
const Names<E>& names();
template <>
const Names<Coords>& names() {
  static const Names<Coords> all{{Coords::lps, "lps"}, {Coords::ras, "ras"}, {Coords::ijk, "ijk"}};
  return all;
}
template <>
const Names<Objects>& names() {
  static const Names<Objects> all{{Objects::one, "one"}, {Objects::many, "many"}};
  return all;
}
template <>
const Names<PointsPull>& names() {
  static const Names<PointsPull> all{{PointsPull::normal, "normal"}, {PointsPull::point, "point"}};
  return all;
}
template <>
const Names<Polarity>& names() {
  static const Names<Polarity> all{
      {Polarity::automatic, "auto"}, {Polarity::bright, "bright"}, {Polarity::dark, "dark"}};
  return all;
}
template <>
const Names<Boundary>& names() {
  static const Names<Boundary> all{{Boundary::automatic, "auto"}, {Boundary::step, "step"}, {Boundary::ridge, "ridge"}};
  return all;
}
template <>
const Names<StartRule>& names() {
  static const Names<StartRule> all{{StartRule::automatic, "auto"},
                                    {StartRule::sphere, "sphere"},
                                    {StartRule::rays, "rays"},
                                    {StartRule::head, "head"}};
  return all;
}
template <>
const Names<Solver>& names() {
  static const Names<Solver> all{{Solver::least_squares, "least-squares"},
                                 {Solver::levenberg_marquardt, "levenberg-marquardt"},
                                 {Solver::gradient, "gradient"},
                                 {Solver::dynamic, "dynamic"}};
  return all;
}
template <>
const Names<SubdivisionRule>& names() {
  static const Names<SubdivisionRule> all{{SubdivisionRule::smooth, "smooth"},
                                          {SubdivisionRule::published, "published"},
                                          {SubdivisionRule::balanced, "balanced"}};
  return all;
}
template <>
const Names<StartSolid>& names() {
  static const Names<StartSolid> all{{StartSolid::tetrahedron, "tetrahedron"},
                                     {StartSolid::octahedron, "octahedron"},
                                     {StartSolid::icosahedron, "icosahedron"}};
  return all;
}
template <>
const Names<ModelKind>& names() {
  static const Names<ModelKind> all{{ModelKind::normal, "normal"},
                                    {ModelKind::spline, "spline"},
                                    {ModelKind::spline_torus, "spline-torus"},
                                    {ModelKind::spline_cylinder, "spline-cylinder"},
                                    {ModelKind::spline_rectangle, "spline-rectangle"},
                                    {ModelKind::catmull_clark, "catmull-clark"},
                                    {ModelKind::slime, "slime"}};
  return all;
}
template <>
const Names<MeshFormat>& names() {
  static const Names<MeshFormat> all{{MeshFormat::ply, "ply"},
                                     {MeshFormat::stl, "stl"},
                                     {MeshFormat::obj, "obj"},
                                     {MeshFormat::vtp, "vtp"},
                                     {MeshFormat::gii, "gii"}};
  return all;
}

template <class E>
std::string find_name(E value) {
  for (const auto& [candidate, word] : names<E>()) {
    if (candidate == value) return word;
  }
  return "unknown";
}

}  // namespace

std::string name_of(Coords value) {
  return find_name(value);
}
std::string name_of(Objects value) {
  return find_name(value);
}
std::string name_of(PointsPull value) {
  return find_name(value);
}
std::string name_of(Polarity value) {
  return find_name(value);
}
std::string name_of(Boundary value) {
  return find_name(value);
}
std::string name_of(StartRule value) {
  return find_name(value);
}
std::string name_of(Solver value) {
  return find_name(value);
}
std::string name_of(SubdivisionRule value) {
  return find_name(value);
}
std::string name_of(StartSolid value) {
  return find_name(value);
}
std::string name_of(ModelKind value) {
  return find_name(value);
}
std::string name_of(MeshFormat value) {
  return find_name(value);
}

template <class E>
E value_of(const std::string& word, const std::string& where) {
  std::string choices;
  for (const auto& [value, name] : names<E>()) {
    if (name == word) return value;
    choices += (choices.empty() ? "" : ", ") + name;
  }
  throw UsageError(fmt::format("bad value ({}): '{}' is no choice; use one of {}", where, word, choices));
}
template Coords value_of(const std::string&, const std::string&);
template Objects value_of(const std::string&, const std::string&);
template Polarity value_of(const std::string&, const std::string&);
template Boundary value_of(const std::string&, const std::string&);
template StartRule value_of(const std::string&, const std::string&);
template PointsPull value_of(const std::string&, const std::string&);
template Solver value_of(const std::string&, const std::string&);
template SubdivisionRule value_of(const std::string&, const std::string&);
template StartSolid value_of(const std::string&, const std::string&);
template ModelKind value_of(const std::string&, const std::string&);
template MeshFormat value_of(const std::string&, const std::string&);

std::optional<double> number_in(const std::string& word) {
  const char* begin = word.data();
  const char* end = begin + word.size();
  if (begin != end && *begin == '+') ++begin;
  double value = 0.0;
  const auto [rest, fault] = std::from_chars(begin, end, value);
  if (fault != std::errc() || rest != end || !std::isfinite(value)) return std::nullopt;
  return value;
}

std::optional<int> integer_in(const std::string& word) {
  int value = 0;
  const auto [rest, fault] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (fault != std::errc() || rest != word.data() + word.size()) return std::nullopt;
  return value;
}

double number_of(const std::string& word, const std::string& where) {
  const auto value = number_in(word);
  if (!value) throw UsageError(fmt::format("bad value ({}): '{}' is not a finite number; write it like 12.5", where, word));
  return *value;
}

int integer_of(const std::string& word, const std::string& where) {
  const auto value = integer_in(word);
  if (!value) throw UsageError(fmt::format("bad value ({}): '{}' is not a whole number; write it like 12", where, word));
  return *value;
}

namespace {

std::vector<std::string> split(const std::string& text, char separator) {
  std::vector<std::string> parts(1);
  for (const char c : text) {
    if (c == separator) {
      parts.emplace_back();
    } else if (c != ' ' && c != '\t') {
      parts.back() += c;
    }
  }
  return parts;
}

}  // namespace

std::vector<std::string> split_commas(const std::string& text) {
  return split(text, ',');
}

std::vector<std::string> SettingKey::choices() const {
  if (kind != SettingKind::text || placeholder.find('|') == std::string::npos) return {};
  return split(placeholder, '|');
}

}  // namespace pellicle
