#include "pellicle/energies/energy_kind.h"

#include <algorithm>

namespace pellicle {

namespace {

template <class Entries>
auto place_of(Entries& entries, const EnergyKind& kind) {
  return std::find_if(entries.begin(), entries.end(), [&](const auto& e) { return e.kind == &kind; });
}

}  // namespace

EnergyWeights::EnergyWeights(std::initializer_list<Pair> weights) {
  for (const Pair& pair : weights) (*this)[pair.kind] = pair.weight;
}

double EnergyWeights::of(const EnergyKind& kind) const {
  const auto at = place_of(entries_, kind);
  return at == entries_.end() ? 0.0 : at->weight;
}

bool EnergyWeights::contains(const EnergyKind& kind) const {
  return place_of(entries_, kind) != entries_.end();
}

double& EnergyWeights::operator[](const EnergyKind& kind) {
  const auto at = place_of(entries_, kind);
  if (at != entries_.end()) return at->weight;
  const auto after =
      std::find_if(entries_.begin(), entries_.end(), [&](const Entry& e) { return e.kind->name > kind.name; });
  return entries_.insert(after, {&kind, 0.0})->weight;
}

void EnergyWeights::erase(const EnergyKind& kind) {
  std::erase_if(entries_, [&](const Entry& e) { return e.kind == &kind; });
}

const EnergyKind* EnergyWeights::with(Trait trait) const {
  const auto at = std::find_if(entries_.begin(), entries_.end(), [&](const Entry& e) { return e.kind->traits.*trait; });
  return at == entries_.end() ? nullptr : at->kind;
}

bool EnergyWeights::uses(Trait trait) const {
  return std::any_of(entries_.begin(), entries_.end(),
                     [&](const Entry& e) { return e.kind->traits.*trait && e.weight > 0.0; });
}

}  // namespace pellicle
