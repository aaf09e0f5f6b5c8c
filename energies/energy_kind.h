#pragma once
/// What the program knows of an energy, and weights of energies.

#include <functional>
#include <initializer_list>
#include <string_view>
#include <vector>

namespace pellicle {

struct SampleLayout;
struct StepView;
struct TermOutput;
struct VectorRows;

/// See term.h.
using EnergyTerm = std::function<TermOutput(const StepView&)>;

/// What a fit has to know of an energy to choose stages and densities. Fit asks for these, never for a name.
struct EnergyTraits {
  /// Measures where the boundary is: wants densely sampled surfaces; its targets are weighed against outliers, kept
  /// within search limits and can be held out.
  bool localises = false;
  bool searches = false;  ///< far, for an object that is not near yet
  bool smooths = false;   ///< its weight is the smoothness that a fit chooses
  bool for_many = false;  ///< made for one of many small objects
  bool needs_points = false;
  bool needs_target_volume = false;
};

/// One way to take part in a stage.
struct EnergyForm {
  int turn = 0;                    ///< terms are asked in this order: first those that learn intensities
  EnergyTerm (*make)() = nullptr;  ///< a new term for a stage
};

/// A row of the table energy_kinds() (energy_kinds.h), or one of one's own. Weights refer to it: it must outlive them.
struct EnergyKind {
  std::string_view name;
  std::string_view kind;  ///< "residual" or "scalar"
  std::string_view formula, text;
  EnergyForm form = {};         ///< none: `constant`
  EnergyForm as_integral = {};  ///< in stages with Solver::gradient; none: as in the others
  /// Rows that depend on the layout alone: made once per control mesh and density, not asked at each step.
  VectorRows (*constant)(const SampleLayout&) = nullptr;
  bool coarse = false;          ///< `constant` is asked for the coarser samples: enough for what is smooth anyway
  double least_weight = 0.0;    ///< weights below are refused
  double least_reach_mm = 0.0;  ///< how far a stage with this energy looks at least
  EnergyTraits traits = {};
};

/// A term that begins as a default one.
template <class Term>
EnergyTerm make_term() {
  return Term{};
}

/// Weights of energies, in the order of their names.
class EnergyWeights {
 public:
  struct Entry {
    const EnergyKind* kind;
    double weight;
    bool operator==(const Entry&) const = default;
  };
  struct Pair {
    const EnergyKind& kind;
    double weight;
  };
  using Trait = bool EnergyTraits::*;

  EnergyWeights() = default;
  EnergyWeights(std::initializer_list<Pair> weights);
  /// 0 where there is none.
  double of(const EnergyKind& kind) const;
  bool contains(const EnergyKind& kind) const;
  /// The weight, 0 if it is new.
  double& operator[](const EnergyKind& kind);
  void erase(const EnergyKind& kind);
  bool empty() const { return entries_.empty(); }
  auto begin() const { return entries_.begin(); }
  auto end() const { return entries_.end(); }
  bool operator==(const EnergyWeights&) const = default;

  /// The first energy with a trait, whatever its weight; null: there is none.
  const EnergyKind* with(Trait trait) const;
  /// Whether an energy with a trait has a weight above 0.
  bool uses(Trait trait) const;

 private:
  std::vector<Entry> entries_;
};

}  // namespace pellicle
