#pragma once
/// The table of energies: what `--energy list`, settings files, reports and documentation know of each.

#include <span>
#include <string>
#include <string_view>

#include "pellicle/energies/energy_kind.h"

namespace pellicle {

std::span<const EnergyKind> energy_kinds();

/// \param where of the setting that names it, for the message.
/// \throws UsageError for a name that is not in the table.
const EnergyKind& energy_named(std::string_view name, const std::string& where);

/// Rows that the program's own stages are made of.
namespace energy {
extern const EnergyKind &region, &body, &edge, &crossing, &bending, &tension, &spacing, &springs, &flux, &volume,
    &inflation;
}  // namespace energy

}  // namespace pellicle
