#pragma once
/// Rules that several settings of a fit share. Each is thrown as a SettingError.

#include <string>

#include "pellicle/base/errors.h"
#include "pellicle/energies/energy_kind.h"
#include "pellicle/solve/solver.h"

namespace pellicle {

inline void require(bool rule, const std::string& subject, const std::string& key, const std::string& why) {
  if (!rule) throw SettingError(subject, key, why);
}

/// \param key of the setting, or the stage, that holds the weights.
void validate_energies(const EnergyWeights& energies, const std::string& key);
void validate_motion(const Motion& motion, const std::string& key);

}  // namespace pellicle
