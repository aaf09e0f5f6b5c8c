#include "pellicle/settings/settings.h"

namespace pellicle {

template <>
const Words<Coords>& words_of() {
  static const Words<Coords> all{{Coords::lps, "lps"}, {Coords::ras, "ras"}, {Coords::ijk, "ijk"}};
  return all;
}
template <>
const Words<Objects>& words_of() {
  static const Words<Objects> all{{Objects::one, "one"}, {Objects::many, "many"}};
  return all;
}
template <>
const Words<PointsPull>& words_of() {
  static const Words<PointsPull> all{{PointsPull::normal, "normal"}, {PointsPull::point, "point"}};
  return all;
}
template <>
const Words<Polarity>& words_of() {
  static const Words<Polarity> all{
      {Polarity::automatic, "auto"}, {Polarity::bright, "bright"}, {Polarity::dark, "dark"}};
  return all;
}
template <>
const Words<Boundary>& words_of() {
  static const Words<Boundary> all{{Boundary::automatic, "auto"}, {Boundary::step, "step"}, {Boundary::ridge, "ridge"}};
  return all;
}
template <>
const Words<StartRule>& words_of() {
  static const Words<StartRule> all{{StartRule::automatic, "auto"},
                                    {StartRule::sphere, "sphere"},
                                    {StartRule::rays, "rays"},
                                    {StartRule::head, "head"}};
  return all;
}
template <>
const Words<Solver>& words_of() {
  static const Words<Solver> all{{Solver::least_squares, "least-squares"},
                                 {Solver::levenberg_marquardt, "levenberg-marquardt"},
                                 {Solver::gradient, "gradient"},
                                 {Solver::dynamic, "dynamic"}};
  return all;
}
template <>
const Words<SubdivisionRule>& words_of() {
  static const Words<SubdivisionRule> all{{SubdivisionRule::smooth, "smooth"},
                                          {SubdivisionRule::published, "published"},
                                          {SubdivisionRule::balanced, "balanced"}};
  return all;
}
template <>
const Words<StartSolid>& words_of() {
  static const Words<StartSolid> all{{StartSolid::tetrahedron, "tetrahedron"},
                                     {StartSolid::octahedron, "octahedron"},
                                     {StartSolid::icosahedron, "icosahedron"}};
  return all;
}
template <>
const Words<ModelKind>& words_of() {
  static const Words<ModelKind> all{{ModelKind::normal, "normal"},
                                    {ModelKind::spline, "spline"},
                                    {ModelKind::spline_torus, "spline-torus"},
                                    {ModelKind::spline_cylinder, "spline-cylinder"},
                                    {ModelKind::spline_rectangle, "spline-rectangle"},
                                    {ModelKind::catmull_clark, "catmull-clark"},
                                    {ModelKind::slime, "slime"}};
  return all;
}
template <>
const Words<MeshFormat>& words_of() {
  static const Words<MeshFormat> all{{MeshFormat::ply, "ply"},
                                     {MeshFormat::stl, "stl"},
                                     {MeshFormat::obj, "obj"},
                                     {MeshFormat::vtp, "vtp"},
                                     {MeshFormat::gii, "gii"}};
  return all;
}

}  // namespace pellicle
