#pragma once
/// The table of energies: what `--energy list`, settings files, reports and documentation know of each.

#include <span>
#include <string>
#include <string_view>

#include "pellicle/energies/energy_kind.h"

namespace pellicle {

std::span<const EnergyKind> energy_kinds();

/// The row of that name; null: there is none.
const EnergyKind* find_energy(std::string_view name);

/// Rows that the program's own stages are made of.
namespace energy {
extern const EnergyKind &region, &body, &edge, &crossing, &bending, &tension, &spacing, &springs, &flux, &volume,
    &inflation;
}  // namespace energy

}  // namespace pellicle
